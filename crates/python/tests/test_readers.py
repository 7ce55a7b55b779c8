"""What others read of the files of a run: meshio, PyVista, VTK's own readers."""

import pytest
from conftest import PRESSURE, closed_aperture, scene_of

import kluft


@pytest.fixture(scope="module")
def folder(mesh, tmp_path_factory):
    folder = tmp_path_factory.mktemp("readers")
    scene_of(title="a <joint> & more", load=kluft.Load(steps=[0.5, 1.0])).solve(mesh, out=folder)
    return folder


def test_meshio_reads_every_grid(folder):
    meshio = pytest.importorskip("meshio")
    for file in sorted(folder.glob("*.vtu")):
        grid = meshio.read(file)
        assert len(grid.points) > 0 and sum(len(block.data) for block in grid.cells) > 0
    joint = meshio.read(folder / "fractures_0002.vtu")
    assert joint.point_data["aperture"] == pytest.approx(closed_aperture(PRESSURE))
    assert float(joint.field_data["TimeValue"][0]) == 2.0
    assert joint.field_data["fracture joint"][0] == 0
    assert "title a <joint> & more" in joint.field_data


def test_pyvista_reads_grids_series_and_both_together(folder):
    pyvista = pytest.importorskip("pyvista")
    joint = pyvista.read(folder / "fractures_0002.vtu")
    assert joint["aperture"] == pytest.approx(closed_aperture(PRESSURE))
    assert joint.field_data["TimeValue"][0] == 2.0
    series = pyvista.get_reader(str(folder / "rock.pvd"))
    assert series.time_values == [1.0, 2.0]
    both = pyvista.read(folder / "results.vtm")
    assert both.keys() == ["rock", "fractures"]
    assert both["fractures"]["aperture"] == pytest.approx(closed_aperture(PRESSURE))
    assert "node" in both["rock"].point_data or both["rock"].n_points > 0


def test_vtk_reads_them_without_complaints(folder):
    vtk = pytest.importorskip("vtkmodules.vtkIOXML")
    core = pytest.importorskip("vtkmodules.vtkCommonCore")
    said = []
    window = core.vtkOutputWindow.GetInstance()
    for event in ("ErrorEvent", "WarningEvent"):
        window.AddObserver(event, lambda *_: said.append(event))
    reader = vtk.vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(folder / "results.vtm"))
    reader.Update()
    both = reader.GetOutput()
    key = both.NAME() if hasattr(both, "NAME") else None
    names = [both.GetMetaData(i).Get(key) for i in range(both.GetNumberOfBlocks())]
    assert names == ["rock", "fractures"] and not said
    fields = both.GetBlock(1).GetFieldData()
    named = [fields.GetArrayName(i) for i in range(fields.GetNumberOfArrays())]
    for fact in ("TimeValue", "fracture joint", "unit of aperture: m"):
        assert fact in named
    assert any(name.startswith("kluft ") for name in named)
    state = both.GetBlock(1).GetPointData()
    tendency = state.GetArray("slip_tendency")
    assert tendency.GetRange()[1] < 1e-6, "a level joint under a load from above has no shear"
