"""The program that the package holds: its command, and what studies and networks make of it."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys

import pytest

import kluft
from kluft.command import own

pandas = pytest.importorskip("pandas")

GEOMETRIES = pathlib.Path(__file__).parents[3] / "geometries"


@pytest.fixture(autouse=True)
def needs_gmsh():
    if not shutil.which("gmsh"):
        pytest.skip("no gmsh")


def command(*words, **options):
    """The program as it calls itself."""
    interpreter, script, *_ = own()
    given = [interpreter, script, *map(str, words)]
    return subprocess.run(given, capture_output=True, text=True, check=False, **options)


def test_the_package_and_its_own_path_are_the_command():
    said = command("--version")
    assert said.returncode == 0 and said.stdout.startswith("kluft ")
    module = [sys.executable, "-m", "kluft", "--version"]
    as_module = subprocess.run(module, capture_output=True, text=True, check=True)
    assert (as_module.stdout, as_module.stderr) == (said.stdout, "")
    wrong = command("run", "no-such-scene.toml")
    assert wrong.returncode == 2 and "remedy: " in wrong.stderr
    usage = command("run", "--no-such-option")
    assert usage.returncode == 2 and "--no-such-option" in usage.stderr


def test_the_command_runs_a_scene_and_says_how_it_was_called(tmp_path):
    scene = GEOMETRIES / "inclined-joint" / "scene.toml"
    done = command("run", scene, "--out", tmp_path, "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    run = kluft.read(tmp_path)
    assert run.summary["provenance"]["command"] == f"kluft run {scene} --out {tmp_path} --quiet"
    # The closed form that the scene states: 7 kPa on a plane that dips 50 degrees.
    assert run.fractures["joint"].aperture == pytest.approx(1.98791504e-6, rel=1e-5)


def test_a_run_in_python_says_what_python_was_started_with(tmp_path):
    script = tmp_path / "a study.py"
    scene = GEOMETRIES / "inclined-joint" / "scene.toml"
    script.write_text(
        f"import kluft\nrun = kluft.Scene.read({str(scene)!r}).solve()\n"
        "print(run.summary['provenance']['command'])\n"
    )
    words = [sys.executable, str(script), "--fast"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == f"{sys.executable} '{script}' --fast"


PERSONALITY = """#!/bin/sh
test "$1" != --version || exit 1
read flags < /proc/self/personality
echo "Error   : addresses $flags"
exit 1
"""


@pytest.mark.skipif(sys.platform != "linux", reason="gmsh is started by way of the program on Linux")
def test_runs_in_memory_start_gmsh_as_the_program_does(tmp_path, monkeypatch):
    gmsh = tmp_path / "gmsh.sh"
    gmsh.write_text(PERSONALITY)
    gmsh.chmod(0o755)
    monkeypatch.setenv("KLUFT_GMSH", str(gmsh))
    monkeypatch.setenv("KLUFT_CACHE", "")
    with pytest.raises(kluft.InputError) as caught:
        kluft.Scene.read(GEOMETRIES / "inclined-joint" / "scene.toml").solve()
    # personality(2): ADDR_NO_RANDOMIZE.
    assert any("addresses 00040000" in defect.problem for defect in caught.value.defects)


def test_ctrl_c_ends_the_command(tmp_path):
    interpreter, script, *_ = own()
    scene = GEOMETRIES / "network-20" / "scene.toml"
    words = [interpreter, script, "run", str(scene), "--out", str(tmp_path), "-v"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout.readline().startswith("kluft")
        os.kill(running.pid, signal.SIGINT)
        assert running.wait(timeout=20) == -signal.SIGINT


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


@pytest.mark.parametrize("kind", [list, pandas.DataFrame])
def test_a_wrong_list_names_its_rows(kind):
    """Rows are counted from 0, and no file is named that the user has not written."""
    with pytest.raises(kluft.InputError) as caught:
        kluft.network(kind([LIST[0], {**LIST[1], "dip": 95}]), domain=[0, 0, 0, 10, 10, 10])
    assert caught.value.defects[0].place == "row 1, column `dip`"
    with pytest.raises(kluft.InputError) as caught:
        kluft.network(kind([LIST[0], {**LIST[1], "name": "flat"}]))
    assert caught.value.defects[0].place == "row 1" and "row 0" in caught.value.defects[0].problem
    with pytest.raises(kluft.InputError) as caught:
        kluft.network(kind([{**LIST[0], "colour": "red"}]))
    assert caught.value.defects[0].place == "the columns"
    assert "listed.csv" not in str(caught.value)


def test_a_wrong_description_names_no_file_of_ours():
    with pytest.raises(kluft.InputError) as caught:
        kluft.network({"sed": 3})
    assert caught.value.defects[0].place.startswith("the description:")
    assert "kluft-network" not in str(caught.value)


@pytest.mark.parametrize("other", ["azimuth", "dip_dir", "dip_azimuth", "dip_direction"])
def test_two_names_of_the_dip_direction_are_refused_as_such(other):
    rows = [{key: value for key, value in row.items() if key != "dip_direction"} for row in LIST]
    with pytest.raises(kluft.InputError) as caught:
        kluft.network([{**rows[0], "dipdir": 0}, {**rows[1], other: 90}])
    problem = f"columns `dipdir` and `{other}` mean the same: dip_direction"
    assert caught.value.defects[0].problem == problem
