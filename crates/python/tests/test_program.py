"""Studies and networks: what the program makes, as tables."""

import pathlib
import shutil

import pytest

import kluft
from kluft import program

pandas = pytest.importorskip("pandas")

GEOMETRIES = pathlib.Path(__file__).parents[3] / "geometries"


@pytest.fixture(autouse=True)
def needs_the_program_and_gmsh():
    try:
        program.find()
    except FileNotFoundError as error:
        pytest.skip(str(error))
    if not shutil.which("gmsh"):
        pytest.skip("no gmsh")


@pytest.fixture(scope="module")
def studied():
    scene = kluft.Scene.read(GEOMETRIES / "penny" / "scene.toml")
    meshes = [dict(h=h, h_disc=0.6) for h in (0.45, 0.3)]
    return kluft.study(scene, meshes=meshes, orders=[1, 2], quarter_points=[False], threads=1)


def test_a_study_is_a_table_with_a_row_for_each_setting(studied):
    table = studied.table
    assert len(table) == 4 and set(table["order"]) == {"order 1", "order 2"}
    assert (table["seconds"] > 0).all() and (table["error"] > 0).all()
    # The closed form: order 2 on the same mesh is nearer to it.
    for _, of_mesh in table.groupby("mesh"):
        errors = of_mesh.set_index("order")["error"]
        assert errors["order 2"] < errors["order 1"]
    assert "penny" in studied.page.read_text("utf-8").lower()
    assert "<table>" in studied._repr_html_()


def test_the_cheapest_setting_has_the_error_asked_for(studied):
    table = studied.table
    best = table.loc[table["error"].idxmin()]
    found = studied.cheapest(float(best["error"]))
    assert found.row["folder"] == best["folder"]
    loose = studied.cheapest("99 %")
    assert loose.seconds == table["seconds"].min()
    tables = found.scene.tables
    assert tables["mesh"]["parameters"]["h"] in (0.45, 0.3)
    with pytest.raises(LookupError, match="no setting"):
        studied.cheapest("0.0001 %")


def test_a_study_is_drawn(studied):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = studied.plot()
    assert len(axes.lines) == 2 and axes.get_xscale() == "log"


def test_a_wrong_study_names_its_defect():
    scene = kluft.Scene.read(GEOMETRIES / "penny" / "scene.toml")
    with pytest.raises(kluft.InputError) as caught:
        kluft.study(scene, measure="nothing_of_the_kind", meshes=[dict(h=0.5)], orders=[7])
    assert any("orders" in defect.place + defect.problem for defect in caught.value.defects)


def test_a_study_needs_a_geometry(scene):
    with pytest.raises(ValueError, match="geometry"):
        kluft.study(scene, orders=[1])


LIST = [
    dict(name="flat", shape="disc", x=5, y=5, z=5, dip=0, dip_direction=0, radius=2),
    dict(name="steep", shape="rectangle", x=5, y=5, z=5, dip=80, dip_direction=90, length=4, width=3),
]


@pytest.mark.parametrize("kind", [list, pandas.DataFrame])
def test_a_table_becomes_a_network(kind, tmp_path):
    made = kluft.network(kind(LIST), domain=[0, 0, 0, 10, 10, 10], h=2.0, out=tmp_path)
    found = made.fractures.set_index("name")
    assert list(found.index) == ["flat", "steep"]
    assert found.loc["steep", "area_given"] == pytest.approx(12.0)
    assert found.loc["steep", "dip"] == pytest.approx(80.0)
    assert (tmp_path / "network.geo").is_file()
    assert made.scene.tables["mesh"]["geometry"] == "network.geo"


def test_random_sets_become_a_network():
    given = {
        "seed": 3,
        "domain": {"low": [0, 0, 0], "high": [10, 10, 10]},
        "mesh": {"h": 2.0},
        "fracture_set": {
            "steep": {
                "count": 5,
                "orientation": {"dip": 70, "dip_direction": 135, "kappa": 20},
                "size": {"law": "constant", "radius": 2.0},
                "aperture": 1e-3,
                "normal_stiffness": 2e10,
                "shear_stiffness": 1e10,
            }
        },
    }
    made = kluft.network(given)
    again = kluft.network(given)
    drawn = [list(one.fractures["area_given"]) for one in (made, again)]
    assert drawn[0] == drawn[1], "the seed decides"
    assert len(made.sets) == 1 and len(made.fractures) <= 5
    assert "<table>" in made._repr_html_()


def test_a_wrong_list_names_its_line():
    with pytest.raises(kluft.InputError) as caught:
        kluft.network([{**LIST[0], "dip": 95}])
    assert "dip" in caught.value.defects[0].place
