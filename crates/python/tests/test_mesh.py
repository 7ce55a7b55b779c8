"""Meshes of every origin are the same mesh."""

import os
import pathlib
import shutil
import subprocess

import numpy as np
import pytest
from conftest import PRESSURE, block, closed_aperture

import kluft

GEOMETRIES = pathlib.Path(__file__).parents[3] / "geometries"


def test_a_survey_names_area_dip_and_blocks(mesh):
    survey = mesh.survey()
    assert [row["fracture"] for row in survey.fractures] == ["joint"]
    joint = survey.fractures[0]
    assert joint["area"] == pytest.approx(1.0) and joint["dip"] == pytest.approx(0.0)
    assert joint["trace_length"] == pytest.approx(4.0) and joint["tip_length"] == 0.0
    assert [block["volume"] for block in survey.blocks] == pytest.approx([0.5, 0.5])
    assert survey.worst_quality == pytest.approx(1.0)
    assert "joint" in survey._repr_html_()
    assert mesh.survey(fractures=[]).fractures == []


def test_elements_that_refer_to_no_node_are_refused():
    points, volumes, surfaces = block()
    surfaces["joint"]["quad"] = surfaces["joint"]["quad"].copy()
    surfaces["joint"]["quad"][0, 0] = -1
    with pytest.raises(kluft.InputError, match="not there"):
        kluft.Mesh.from_arrays(points, volumes, surfaces)


@pytest.mark.parametrize("of, known", [("volumes", "tetra, tetra10"), ("surfaces", "triangle, ")])
def test_an_unknown_type_of_elements_is_refused_with_those_that_are_known(of, known):
    points, volumes, surfaces = block()
    given = {"volumes": volumes, "surfaces": surfaces}
    given[of] = {"odd": {"tet": [[0, 1, 2, 3]]}}
    with pytest.raises(kluft.InputError, match="`tet`") as caught:
        kluft.Mesh.from_arrays(points, **given)
    defect = caught.value.defects[0]
    assert "odd" in defect.place and known in defect.remedy


def test_elements_may_belong_to_several_groups(scene):
    points, volumes, surfaces = block()
    surfaces[("joint", "all")] = surfaces.pop("joint")
    mesh = kluft.Mesh.from_arrays(points, volumes, surfaces)
    assert {group["name"] for group in mesh.groups} >= {"joint", "all"}
    aperture = scene.solve(mesh).fractures["joint"].aperture
    np.testing.assert_allclose(aperture, closed_aperture(PRESSURE), rtol=1e-9)


def test_second_order_elements_have_the_order_of_vtk():
    """A tetrahedron whose last two middles were exchanged would fold."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    middles = [(corners[a] + corners[b]) / 2 for a, b in edges]
    points = np.concatenate([corners, middles])
    mesh = kluft.Mesh.from_arrays(
        points,
        {"rock": {"tetra10": [np.arange(10)]}},
        {"base": {"triangle6": [[0, 1, 2, 4, 5, 6]]}, "side": {"triangle6": [[1, 2, 3, 5, 9, 8]]}},
    )
    boundary = {
        "base": kluft.Boundary(displacement={"x": 0, "y": 0, "z": 0}),
        "side": kluft.Boundary(pressure="1 MPa"),
    }
    rock = {"rock": kluft.Rock(young_modulus="50 GPa", poisson_ratio=0.25)}
    run = kluft.Scene(rock=rock, boundary=boundary).solve(mesh)
    rock = run.rock
    connectivity, _, types = rock.cells
    assert types.tolist() == [24]
    np.testing.assert_array_equal(rock.points[connectivity.astype(int)], points)


def test_meshio_hands_over_sets_and_tags(mesh, scene):
    meshio = pytest.importorskip("meshio")
    points, volumes, surfaces = block()
    cells = [("hexahedron", volumes["rock"]["hexahedron"])]
    cells += [("quad", elements["quad"]) for elements in surfaces.values()]
    names = ["rock", *surfaces]
    sets = {
        name: [np.arange(len(cells[i][1])) if i == j else None for i in range(len(cells))]
        for j, name in enumerate(names)
    }
    of_sets = kluft.Mesh.from_meshio(meshio.Mesh(points, cells, cell_sets=sets))
    tags = [np.full(len(nodes), i + 1) for i, (_, nodes) in enumerate(cells)]
    field_data = {name: np.array([i + 1, 3 if i == 0 else 2]) for i, name in enumerate(names)}
    tagged = meshio.Mesh(
        points, cells, cell_data={"gmsh:physical": tags}, field_data=field_data
    )
    of_tags = kluft.Mesh.from_meshio(tagged)
    expected = scene.solve(mesh).fractures["joint"].aperture
    for found in (of_sets, of_tags):
        assert {group["name"] for group in found.groups} == set(names)
        np.testing.assert_allclose(scene.solve(found).fractures["joint"].aperture, expected)


def test_what_meshio_notes_of_boundaries_is_no_group():
    """It holds tags of surfaces, which may be larger than the number of elements."""
    meshio = pytest.importorskip("meshio")
    points, volumes, _ = block(1)
    cells = [("hexahedron", volumes["rock"]["hexahedron"])]
    sets = {"rock": [np.arange(2)], "gmsh:bounding_entities": [np.array([-7, 12])]}
    mesh = kluft.Mesh.from_meshio(meshio.Mesh(points, cells, cell_sets=sets))
    assert [group["name"] for group in mesh.groups] == ["rock"]


COARSE = """
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {0, 1, 0}; Point(4) = {0, 0, 1};
Line(11) = {1, 2}; Line(12) = {2, 3}; Line(13) = {3, 1};
Line(14) = {1, 4}; Line(15) = {2, 4}; Line(16) = {3, 4};
Curve Loop(21) = {11, 12, 13}; Curve Loop(22) = {11, 15, -14};
Curve Loop(23) = {12, 16, -15}; Curve Loop(24) = {13, 14, -16};
Plane Surface(21) = {21}; Plane Surface(22) = {22};
Plane Surface(23) = {23}; Plane Surface(24) = {24};
Surface Loop(31) = {21:24}; Volume(31) = {31};
Transfinite Curve {11:16} = 2;
Physical Volume("rock") = {31}; Physical Surface("base") = {21};
"""


@pytest.mark.skipif(shutil.which("gmsh") is None, reason="gmsh is not installed")
def test_files_of_gmsh_come_by_way_of_meshio_and_pyvista_as_the_guide_says(tmp_path):
    """Surfaces of few elements with large tags, which make PyVista's reader fail."""
    meshio, pyvista = pytest.importorskip("meshio"), pytest.importorskip("pyvista")
    geometry, file = tmp_path / "a.geo", tmp_path / "a.msh"
    geometry.write_text(COARSE)
    command = ["gmsh", "-3", "-format", "msh41", str(geometry), "-o", str(file)]
    subprocess.run(command, check=True, capture_output=True)
    with pytest.raises(IndexError):
        pyvista.read(file)
    mesh = meshio.read(file)
    named = {(group["name"], group["elements"]) for group in kluft.Mesh.from_file(file).groups}
    assert {(g["name"], g["elements"]) for g in kluft.Mesh.from_meshio(mesh).groups} == named
    mesh.cell_sets = {}
    names = {int(tag): name for name, (tag, _) in mesh.field_data.items()}
    of_grid = kluft.Mesh.from_pyvista(pyvista.from_meshio(mesh), names)
    assert {(group["name"], group["elements"]) for group in of_grid.groups} == named


def test_pyvista_hands_over_numbers(scene):
    pyvista = pytest.importorskip("pyvista")
    points, volumes, surfaces = block()
    names = {1: "rock", **{i + 2: name for i, name in enumerate(surfaces)}}
    hexahedra = volumes["rock"]["hexahedron"]
    quads = np.concatenate([elements["quad"] for elements in surfaces.values()])
    grid = pyvista.UnstructuredGrid({12: hexahedra, 9: quads}, points)
    sizes = [len(elements["quad"]) for elements in surfaces.values()]
    of_quads = np.repeat(np.arange(2, 2 + len(sizes)), sizes)
    tags = np.zeros(grid.n_cells, int)
    tags[grid.celltypes == 12] = 1
    tags[grid.celltypes == 9] = of_quads
    grid.cell_data["gmsh:physical"] = tags
    run = scene.solve(kluft.Mesh.from_pyvista(grid, names))
    aperture = run.fractures["joint"].aperture
    np.testing.assert_allclose(aperture, closed_aperture(PRESSURE), rtol=1e-9)
    drawn = run.last.fracture_grid.to_pyvista()
    assert drawn.n_cells == 4 and drawn.area == pytest.approx(1.0)


def test_a_grid_without_numbers_of_groups_is_told_to_name_them():
    pyvista = pytest.importorskip("pyvista")
    points, volumes, _ = block()
    grid = pyvista.UnstructuredGrid({12: volumes["rock"]["hexahedron"]}, points)
    grid.cell_data["material"] = np.ones(grid.n_cells, int)
    with pytest.raises(kluft.InputError, match="gmsh:physical.*material") as caught:
        kluft.Mesh.from_pyvista(grid)
    assert "groups=" in caught.value.defects[0].remedy
    named = kluft.Mesh.from_pyvista(grid, {1: "rock"}, groups="material")
    assert [group["name"] for group in named.groups] == ["rock"]


def test_gmsh_hands_over_its_model():
    gmsh = pytest.importorskip("gmsh", exc_type=ImportError)
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        _two_boxes(gmsh)
        mesh = kluft.Mesh.from_gmsh()
    finally:
        gmsh.finalize()
    joint = mesh.survey().fractures[0]
    assert joint["fracture"] == "joint" and joint["area"] == pytest.approx(1.0)


def _two_boxes(gmsh):
    lower = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 0.5)
    upper = gmsh.model.occ.addBox(0, 0, 0.5, 1, 1, 0.5)
    gmsh.model.occ.fragment([(3, lower)], [(3, upper)])
    gmsh.model.occ.synchronize()
    between = gmsh.model.getEntitiesInBoundingBox(-0.1, -0.1, 0.4, 1.1, 1.1, 0.6, dim=2)
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in between], name="joint")
    gmsh.model.addPhysicalGroup(3, [lower, upper], name="rock")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.3)
    gmsh.model.mesh.generate(3)


@pytest.mark.skipif(shutil.which("gmsh") is None, reason="gmsh is not installed")
def test_a_file_of_gmsh_gives_what_the_command_gives(tmp_path):
    """The shipped joint in a block, meshed by gmsh, with the closed form of its head."""
    geometry = GEOMETRIES / "inclined-joint" / "inclined-joint.geo"
    file = tmp_path / "joint.msh"
    command = ["gmsh", "-3", "-format", "msh41", "-setnumber", "h", "0.3"]
    subprocess.run([*command, str(geometry), "-o", str(file)], check=True, capture_output=True)
    mesh = kluft.Mesh.from_file(file)
    scene = kluft.Scene.read(GEOMETRIES / "inclined-joint" / "scene.toml")
    aperture = scene.solve(mesh).fractures["joint"].aperture
    np.testing.assert_allclose(aperture, 1.987915035e-6, rtol=1e-8)
    assert os.path.exists(file)


def test_a_file_that_is_no_mesh_is_refused(tmp_path):
    file = tmp_path / "a.msh"
    file.write_text("no mesh\n")
    with pytest.raises(kluft.InputError):
        kluft.Mesh.from_file(file)
