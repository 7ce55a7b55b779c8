"""The penny-shaped crack: its meshes, the input of both programs, and the openings they find.

The crack is free of traction, and top and bottom of the cube are pulled by the pressure: the openings are those of
the pressurised crack, because both differ by a uniform stress. OpenGeoSys knows no pressure inside a fracture.
"""

import subprocess

import numpy as np

import opengeosys
import vtu
from meshes import Mesh, boundary_edges

YOUNG_MODULUS, POISSON_RATIO = 25e9, 0.25
"""Pa, and Poisson's ratio."""
PRESSURE = 2e6
"""Tension on top and bottom (Pa)."""
HALF = 10.0
"""Half the side of the cube (m); the radius of the crack is 1 m."""
APERTURE = 1e-5
"""Initial aperture (m); nothing closes."""
RELATIVE_STIFFNESS = 1e-9
"""Stiffness of the crack in OpenGeoSys, as a share of Young's modulus over the radius: it knows no free crack."""
CUTOFF = 1e-8
"""Aperture (m) below which the law of OpenGeoSys goes on linearly; never reached."""

CORNERS = (((-HALF, -HALF, -HALF), (0, 1, 2)), ((HALF, -HALF, -HALF), (1, 2)), ((-HALF, HALF, -HALF), (2,)))
"""Corners of the cube, and the components of displacement held there: without them the cube floats."""

PLACES = {2: "triangle", 4: "tetrahedron", 9: "triangle", 11: "tetrahedron"}
"""Types of elements in gmsh's MSH format that are read."""

SCENE = """title = "penny"

[mesh]
{mesh}

[rock.rock]
young_modulus = {young!r}
poisson_ratio = {poisson!r}

[fracture.penny]
aperture = {aperture!r}
normal_stiffness = 0.0
shear_stiffness = 0.0
closure = "linear"
{loads}
[oracle.penny]
form = "penny"
centre = [0.0, 0.0, 0.0]
radius = 1.0
pressure = {load!r}
"""


PULLED = """
[boundary.top]
traction = [0.0, 0.0, {load!r}]

[boundary.bottom]
traction = [0.0, 0.0, -{load!r}]
"""

PRESSURISED = "fluid_pressure = {load!r}\n"


def gmsh(*arguments):
    """Runs gmsh quietly."""
    subprocess.run(["gmsh", "-v", "1", "-nt", "1", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def make_mesh(geometry, size, order, folder):
    """Meshes with cells of `size` (m) at the rim: `mesh.msh` for Kluft, and the same nodes and cells as a table."""
    options = ["-setnumber", "h", size, "-setnumber", "half", HALF, "-order", order]
    gmsh("-3", *options, "-format", "msh41", "-bin", "-o", folder / "mesh.msh", geometry)
    gmsh("-save", "-format", "msh22", "-o", folder / "table.msh", folder / "mesh.msh")
    mesh = read_table(folder / "table.msh")
    (folder / "table.msh").unlink()
    return mesh


def read_table(path):
    """The mesh of an MSH 2.2 file, without nodes that no cell has."""
    lines = path.read_text().split("\n")
    start = lines.index("$PhysicalNames")
    words = [line.split() for line in lines[start + 2 : start + 2 + int(lines[start + 1])]]
    names = {(dimension, tag): name.strip('"') for dimension, tag, name in words}
    start = lines.index("$Nodes")
    nodes = np.array([line.split() for line in lines[start + 2 : start + 2 + int(lines[start + 1])]], dtype=float)
    start = lines.index("$Elements")
    groups = {}
    for line in lines[start + 2 : start + 2 + int(lines[start + 1])]:
        row = line.split()
        shape = PLACES.get(int(row[1]))
        if shape:
            dimension = "2" if shape == "triangle" else "3"
            groups.setdefault(names[dimension, row[3]], []).append(row[3 + int(row[2]) :])
    groups = {name: np.array(rows, dtype=int) for name, rows in groups.items()}
    return numbered(nodes, groups)


def numbered(nodes, groups):
    """The mesh with its nodes numbered from zero; in 10-node tetrahedra VTK has the last two in the other order."""
    used = np.unique(groups["rock"])
    groups = {name: np.searchsorted(used, rows) for name, rows in groups.items()}
    points = nodes[np.searchsorted(nodes[:, 0].astype(int), used), 1:]
    cells, facets = groups["rock"], groups["penny"]
    if cells.shape[1] == 10:
        cells = cells[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]
    mesh = Mesh(points, cells, facets, {name: groups[name] for name in ("top", "bottom")})
    mesh.patches["tip"] = tip_nodes(facets)[:, None]
    for number, (corner, _) in enumerate(CORNERS):
        distance = np.linalg.norm(points - corner, axis=1)
        mesh.patches[f"corner{number}"] = np.array([[distance.argmin()]])
    return mesh


def tip_nodes(facets):
    """Nodes on the rim, those between corners included."""
    corners = boundary_edges(facets[:, :3])
    if facets.shape[1] == 3:
        return np.unique(corners)
    ends = np.sort(np.stack([facets[:, :3], np.roll(facets[:, :3], -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    on_rim = (ends[:, None] == np.sort(corners, axis=1)[None]).all(axis=2).any(axis=1)
    return np.unique(np.concatenate([corners.ravel(), facets[:, 3:].ravel()[on_rim]]))


EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
"""Ends of the edges of a tetrahedron, in VTK's order of the nodes between them."""


def with_quarter_points(mesh):
    """The mesh of second order with the middles of edges that leave the rim at a quarter of their length.

    Kluft does this by itself; for OpenGeoSys it is done here, by hand.
    """
    on_rim = np.zeros(len(mesh.points), dtype=bool)
    on_rim[mesh.patches["tip"]] = True
    points = mesh.points.copy()
    for ends, middle in zip(EDGES, mesh.cells[:, 4:].T):
        for front, other in (ends, ends[::-1]):
            front, other = mesh.cells[:, front], mesh.cells[:, other]
            leaves = on_rim[front] & ~on_rim[other]
            a, b, m = front[leaves], other[leaves], middle[leaves]
            points[m] = 0.375 * mesh.points[a] - 0.125 * mesh.points[b] + 0.75 * mesh.points[m]
    return Mesh(points, mesh.cells, mesh.facets, mesh.patches)


def write_scene(path, mesh, loads=PULLED):
    """Writes Kluft's scene; `mesh` are the lines of its section of the mesh."""
    values = {"young": YOUNG_MODULUS, "poisson": POISSON_RATIO, "aperture": APERTURE, "load": PRESSURE}
    text = SCENE.format(mesh=mesh, loads=loads.format(load=PRESSURE), **values)
    for corner, components in CORNERS:
        held = ", ".join(f"{'xyz'[component]} = 0.0" for component in components)
        text += f"\n[[fixed_point]]\nat = {list(corner)}\ndisplacement = {{ {held} }}\n"
    path.write_text(text)


def write_project(folder, mesh, order, integration_order):
    """Writes the project of OpenGeoSys and its meshes. The tip is closed by conditions: the program leaves it open."""
    blocks = [(3, mesh.cells), (2, mesh.facets)]
    material = np.repeat([0, 1], [len(mesh.cells), len(mesh.facets)]).astype(np.int32)
    vtu.write(folder / "bulk.vtu", mesh.points, blocks, {}, {"MaterialIDs": material})
    for name, elements in mesh.patches.items():
        opengeosys.write_patch(mesh, elements, folder / f"{name}.vtu")
    values = {"E": YOUNG_MODULUS, "nu": POISSON_RATIO, "K": RELATIVE_STIFFNESS * YOUNG_MODULUS}
    values |= {"aperture0": APERTURE, "pull_top": PRESSURE, "pull_bottom": -PRESSURE, "zero": 0.0}
    held = [(f"corner{number}", component) for number, (_, some) in enumerate(CORNERS) for component in some]
    condition = opengeosys.CONDITION.format
    displacement = [condition(name, "Dirichlet", component, "zero") for name, component in held]
    displacement += [condition(name, "Neumann", 2, f"pull_{name}") for name in ("top", "bottom")]
    text = opengeosys.PROJECT.format(
        meshes="\n".join(f"        <mesh>{name}.vtu</mesh>" for name in mesh.patches),
        cutoff=CUTOFF,
        order=order,
        integration_order=integration_order,
        parameters="\n".join(opengeosys.PARAMETER.format(*item) for item in values.items()),
        displacement="\n".join(displacement),
        jump="\n".join(condition("tip", "Dirichlet", component, "zero") for component in range(3)),
    )
    (folder / "penny.prj").write_text(text)


def opengeosys_openings(folder):
    """Coordinates (m) and openings (m) of the nodes of every facet, from OpenGeoSys."""
    points, (offsets, nodes), data, cells = vtu.read(folder / "out/result_1.vtu")
    on = np.flatnonzero(cells["MaterialIDs"] == 1)
    facets = np.array([nodes[offsets[cell] : offsets[cell + 1]] for cell in on])
    openings = data["displacement_jump1"][facets][:, :, 2]
    return points[facets], openings * np.sign(openings.sum())


def kluft_openings(folder):
    """Coordinates (m) and openings (m) of the nodes of every facet, from Kluft."""
    points, (offsets, nodes), data, _ = vtu.read(sorted((folder / "out").glob("fractures*.vtu"))[-1])
    facets = nodes.reshape(len(offsets) - 1, -1)
    return points[facets], data["opening"].ravel()[facets]
