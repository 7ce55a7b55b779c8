"""The meshes of the comparison: one table of nodes and elements for all programs.

Lengths are in metres. Two problems: `cut`, a box of 1 x 1 x 2 m that a plane dipping 50 degrees cuts in two, of
structured hexahedra or tetrahedra, and `disc`, a unit cube with a disc of radius 0.25 m dipping 50 degrees, of
tetrahedra that gmsh makes.
"""

import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

DIP = np.radians(50.0)
"""Dip of both fractures (radians); they rise with x."""

EPSILON = 1e-9
"""How near to a plane a node lies on it (m)."""

TET_FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
HEX_FACES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])

KUHN = np.array([[0, 1, 2, 6], [0, 5, 1, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 4, 5, 6], [0, 7, 4, 6]])
"""The six tetrahedra of a hexahedron, around its diagonal from node 0 to node 6."""


@dataclass
class Mesh:
    """Nodes and elements, before any copy of a node: rock and fracture share theirs."""

    points: np.ndarray
    """Coordinates (m), one row a node."""
    cells: np.ndarray
    """Nodes of the cells: 4 (tetrahedra) or 8 (hexahedra) a row."""
    facets: np.ndarray
    """Nodes of the fracture's facets: 3 or 4 a row."""
    patches: dict = field(default_factory=dict)
    """Nodes of the elements of every outer face, and of every line of nodes, by name."""

    def unknowns(self):
        """Components of displacement at all nodes and of jump at the fracture's nodes, held ones included."""
        return 3 * (len(self.points) + len(np.unique(self.facets)))


def cut(shape, count):
    """The cut box of `count` x `count` x `2 count` hexahedra or six times as many tetrahedra."""
    planes = np.linspace(0.0, 1.0, count + 1)
    layers = np.linspace(0.0, 2.0, 2 * count + 1)
    z, y, x = (axis.ravel() for axis in np.meshgrid(layers, planes, planes, indexing="ij"))
    middle = 1.0 + np.tan(DIP) * (x - 0.5)
    on_plane = np.repeat(np.arange(2 * count + 1) == count, (count + 1) ** 2)
    z = np.where(z <= 1.0, z * middle, 2.0 - (2.0 - z) * (2.0 - middle))
    z[on_plane] = middle[on_plane]
    hexahedra = grid_hexahedra(count, count, 2 * count)
    cells = hexahedra if shape == "hex" else hexahedra[:, KUHN].reshape(-1, 4)
    every, _ = faces(cells)
    mesh = Mesh(np.column_stack([x, y, z]), cells, every[on_plane[every].all(axis=1)])
    add_outer_faces(mesh)
    bottom, left = mesh.points[:, 2] < EPSILON, mesh.points[:, 0] < EPSILON
    edge = np.flatnonzero(bottom & left)
    mesh.patches["edge"] = np.column_stack([edge[:-1], edge[1:]])
    add_traces(mesh, ["front", "back"])
    return mesh


def grid_hexahedra(nx, ny, nz):
    """Nodes of the hexahedra of a grid whose node numbers run along x first, then y, then z."""
    k, j, i = (axis.ravel() for axis in np.meshgrid(range(nz), range(ny), range(nx), indexing="ij"))
    base = i + (nx + 1) * (j + (ny + 1) * k)
    right, back, up = 1, nx + 1, (nx + 1) * (ny + 1)
    corners = [0, right, right + back, back, up, right + up, right + back + up, back + up]
    return base[:, None] + np.array(corners)


def disc(size, folder):
    """The cube with a disc inside, cells of `size` (m); gmsh makes it in `folder`."""
    geometry = Path(__file__).with_name("disc.geo")
    made = Path(folder) / "gmsh.msh"
    command = [
        "gmsh",
        "-3",
        "-format",
        "msh22",
        "-nt",
        "1",
        "-setnumber",
        "h",
        repr(size),
        str(geometry),
        "-o",
        str(made),
    ]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    points, triangles, tetrahedra = read_msh22(made)
    made.unlink()
    mesh = Mesh(points, tetrahedra, triangles)
    add_outer_faces(mesh)
    mesh.patches["fracture_tip"] = boundary_edges(mesh.facets)
    return mesh


def read_msh22(path):
    """Coordinates (m), triangles and tetrahedra of an MSH 2.2 file, without the nodes that no cell has."""
    lines = Path(path).read_text().split("\n")
    start = lines.index("$Nodes")
    count = int(lines[start + 1])
    nodes = np.array([line.split() for line in lines[start + 2 : start + 2 + count]], dtype=float)
    start = lines.index("$Elements")
    rows = [line.split() for line in lines[start + 2 : start + 2 + int(lines[start + 1])]]
    triangles = np.array([row[-3:] for row in rows if row[1] == "2"], dtype=int)
    tetrahedra = np.array([row[-4:] for row in rows if row[1] == "4"], dtype=int)
    used = np.unique(tetrahedra)
    places = np.searchsorted(nodes[:, 0].astype(int), used)
    return nodes[places, 1:], np.searchsorted(used, triangles), np.searchsorted(used, tetrahedra)


def faces(cells):
    """Every face of the cells once, and whether it belongs to one cell only."""
    table = TET_FACES if cells.shape[1] == 4 else HEX_FACES
    every = cells[:, table].reshape(-1, table.shape[1])
    return unique_rows(every)


def boundary_edges(facets):
    """The edges that belong to one facet only."""
    ends = np.stack([facets, np.roll(facets, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, single = unique_rows(ends)
    return edges[single]


def unique_rows(rows):
    """The rows that differ as sets, and whether they occur once. Three smallest nodes tell four-node faces apart."""
    ordered = np.sort(rows, axis=1)[:, :3]
    key = ordered[:, 0]
    for column in ordered.T[1:]:
        key = key * (rows.max() + 1) + column
    _, first, counts = np.unique(key, return_index=True, return_counts=True)
    return rows[first], counts == 1


def add_outer_faces(mesh):
    """Adds the six faces of the box as patches."""
    every, single = faces(mesh.cells)
    outer = every[single]
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    names = [("left", "right"), ("front", "back"), ("bottom", "top")]
    for axis, pair in enumerate(names):
        for name, at in zip(pair, (low[axis], high[axis])):
            on = np.abs(mesh.points[:, axis] - at) < EPSILON
            mesh.patches[name] = outer[on[outer].all(axis=1)]


def add_traces(mesh, names):
    """Adds the lines along which the fracture meets the faces of these names, as `fracture_NAME`."""
    edges = boundary_edges(mesh.facets)
    for name in names:
        on = np.zeros(len(mesh.points), dtype=bool)
        on[mesh.patches[name]] = True
        mesh.patches["fracture_" + name] = edges[on[edges].all(axis=1)]


def write_msh(mesh, path, names):
    """Writes `mesh` with the patches of `names` as gmsh's MSH 4.1, for Kluft."""
    surfaces = {"fracture": mesh.facets} | {name: mesh.patches[name] for name in names}
    blocks = [(2, tag, elements) for tag, elements in enumerate(surfaces.values(), 1)] + [(3, 1, mesh.cells)]
    box = " ".join(repr(float(x)) for x in (*mesh.points.min(axis=0), *mesh.points.max(axis=0)))
    with open(path, "w", encoding="ascii") as out:
        out.write("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
        out.write(f"$PhysicalNames\n{len(blocks)}\n")
        out.writelines(f'2 {tag} "{name}"\n' for tag, name in enumerate(surfaces, 1))
        out.write('3 1 "rock"\n$EndPhysicalNames\n')
        out.write(f"$Entities\n0 0 {len(surfaces)} 1\n")
        out.writelines(f"{tag} {box} 1 {tag} 0\n" for _, tag, _ in blocks)
        out.write("$EndEntities\n")
        write_msh_nodes(out, mesh.points)
        write_msh_elements(out, blocks)


def write_msh_nodes(out, points):
    """Writes the section of nodes, all in one block."""
    count = len(points)
    out.write(f"$Nodes\n1 {count} 1 {count}\n3 1 0 {count}\n")
    np.savetxt(out, np.arange(1, count + 1), fmt="%d")
    np.savetxt(out, points, fmt="%.17g")
    out.write("$EndNodes\n")


def write_msh_elements(out, blocks):
    """Writes the section of elements; a block is (dimension, entity, nodes of its elements)."""
    types = {(2, 3): 2, (2, 4): 3, (3, 4): 4, (3, 8): 5}
    count = sum(len(elements) for _, _, elements in blocks)
    out.write(f"$Elements\n{len(blocks)} {count} 1 {count}\n")
    first = 1
    for dimension, tag, elements in blocks:
        out.write(f"{dimension} {tag} {types[dimension, elements.shape[1]]} {len(elements)}\n")
        numbers = np.arange(first, first + len(elements))
        np.savetxt(out, np.column_stack([numbers, elements + 1]), fmt="%d")
        first += len(elements)
    out.write("$EndElements\n")
