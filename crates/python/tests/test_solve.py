"""Runs in memory beside closed forms."""

import pathlib
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import PRESSURE, block, closed_aperture, scene_of

import kluft

ROUNDING = 1e-9
"""Share by which a closed form may be missed: what the tests of convergence leave."""


def test_a_joint_closes_as_its_law_says(scene, mesh):
    run = scene.solve(mesh, threads=1)
    joint = run.fractures["joint"]
    np.testing.assert_allclose(joint.aperture, closed_aperture(PRESSURE), rtol=ROUNDING)
    np.testing.assert_allclose(joint.normal_traction, -PRESSURE, rtol=ROUNDING)
    assert joint.points.shape == (len(joint.aperture), 3)
    np.testing.assert_allclose(joint.points[:, 2], 0.5)
    assert joint.numbers["area"] == pytest.approx(1.0)
    # Uniaxial strain: sigma_zz is the pressure, sigma_xx = nu / (1 - nu) sigma_zz.
    stress = run.rock.cell_fields["stress"]
    tensors = stress[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    principal = run.rock.cell_fields["principal_stress"]
    assert principal == pytest.approx(np.linalg.eigvalsh(tensors), abs=1e-6 * PRESSURE)
    np.testing.assert_allclose(stress[:, 2], -PRESSURE, rtol=1e-6)
    assert run.ending == "solved" and len(run.steps) == 1


def test_arrays_own_what_the_run_computed(scene, mesh):
    run = scene.solve(mesh)
    aperture = run.fractures["joint"].aperture
    whole = run.last.fracture_grid.point_fields["aperture"]
    assert np.shares_memory(aperture, whole)
    del run
    np.testing.assert_allclose(aperture, closed_aperture(PRESSURE), rtol=ROUNDING)


def test_the_history_has_every_load_step(mesh):
    pandas = pytest.importorskip("pandas")
    run = scene_of(load=kluft.Load(steps=[0.25, 0.5, 1.0])).solve(mesh)
    history = run.history
    assert isinstance(history, pandas.DataFrame)
    joint = history[history.name == "joint"]
    expected = [closed_aperture(factor * PRESSURE) for factor in (0.25, 0.5, 1.0)]
    np.testing.assert_allclose(joint.aperture_mean, expected, rtol=ROUNDING)
    assert [step.numbers["load"] for step in run.steps] == [0.25, 0.5, 1.0]


def test_what_is_saved_is_what_a_run_writes(scene, mesh, tmp_path):
    run = scene.solve(mesh, out=tmp_path / "written")
    run.save(tmp_path / "saved")
    written = {path.name: path for path in (tmp_path / "written").iterdir()}
    saved = {path.name: path for path in (tmp_path / "saved").iterdir()}
    grids = ["rock_0001.vtu", "fractures_0001.vtu", "rock.pvd", "fractures.pvd", "history.csv"]
    for name in grids:
        assert saved[name].read_bytes() == written[name].read_bytes(), name
    assert set(saved) == set(written)


def test_a_folder_is_read_as_what_was_saved(scene, mesh, tmp_path):
    run = scene.solve(mesh)
    read = kluft.read(run.save(tmp_path / "out"))
    assert read.summary == run.summary and read.history_csv == run.history_csv
    for name, field in run.last.fracture_grid.point_fields.items():
        np.testing.assert_array_equal(read.last.fracture_grid.point_fields[name], field)
    for ours, theirs in zip(run.rock.cells, read.rock.cells):
        np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_array_equal(read.rock.points, run.rock.points)
    assert read.fractures["joint"].numbers == run.fractures["joint"].numbers
    for ours, theirs in zip(run.steps, read.steps):
        known = ["aperture", "normal_traction", "slip_max", "open_area"]
        ours, theirs = (step.fractures["joint"].numbers for step in (ours, theirs))
        assert [theirs[key] for key in known] == [ours[key] for key in known]


def test_results_may_stay_on_the_disk(scene, mesh, tmp_path):
    run = scene.solve(mesh, out=tmp_path / "out", keep=False)
    aperture = run.fractures["joint"].aperture
    np.testing.assert_allclose(aperture, closed_aperture(PRESSURE), rtol=ROUNDING)
    with pytest.raises(ValueError, match="out="):
        scene.solve(mesh, keep=False)


def test_every_defect_comes_with_place_and_remedy(mesh):
    scene = scene_of(
        rock={"rock": kluft.Rock(young_modulus="50 GPa", poisson_ratio=0.5)},
        load={"steps": []},
    )
    with pytest.raises(kluft.InputError) as caught:
        scene.check()
    assert len(caught.value.defects) == 2
    for defect in caught.value.defects:
        assert defect.place.startswith("the scene:") and defect.problem and defect.remedy


def test_a_name_that_the_mesh_does_not_have_is_refused(mesh):
    scene = scene_of(boundary={"tpo": kluft.Boundary(pressure="1 MPa")})
    for refused in (lambda: scene.check(mesh), lambda: scene.solve(mesh)):
        with pytest.raises(kluft.InputError) as caught:
            refused()
        assert "top" in caught.value.defects[0].remedy


def test_a_step_that_does_not_converge_keeps_those_before(mesh, tmp_path):
    # A free block on contact that is pulled away in the second half.
    scene = scene_of(
        fracture={"joint": kluft.Fracture(aperture=0, closure="contact", friction_angle=30)},
        load=kluft.Load(steps=[1.0, -1.0]),
    )
    with pytest.raises(kluft.NotConverged) as caught:
        scene.solve(mesh)
    error = caught.value
    assert error.step == 2 and 0.0 <= error.reached < 1.0
    assert len(error.run.steps) == 1 and error.run.ending == "not converged"
    np.testing.assert_allclose(error.run.fractures["joint"].normal_traction, -PRESSURE, rtol=1e-6)
    folder = error.run.save(tmp_path / "out")
    assert "Not converged: 1 load step," in (folder / "report.html").read_text("utf-8")
    assert kluft.read(folder).ending == "not converged"


def test_a_callback_follows_and_stops_a_run(scene, mesh):
    events = []
    scene.solve(mesh, progress=events.append)
    kinds = {event["event"] for event in events}
    assert {"stage begins", "stage ends", "step begins", "iteration", "note"} <= kinds
    count = sum(event["event"] == "iteration" for event in events)
    assert count > 2
    seen = []

    def stop_at_two(event):
        if event["event"] == "iteration":
            seen.append(event["iteration"])
        return event.get("iteration") != 2

    run = scene.solve(mesh, progress=stop_at_two)
    assert run.ending == "stopped" and run.steps == [] and seen == [1, 2]


def test_what_a_callback_raises_comes_out(scene, mesh):
    def refuse(event):
        if event["event"] == "iteration":
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        scene.solve(mesh, progress=refuse)


def test_interrupts_stop_after_the_iteration(scene, mesh):
    def press_ctrl_c(event):
        if event["event"] == "iteration":
            raise KeyboardInterrupt

    with pytest.raises(kluft.Stopped) as caught:
        scene.solve(mesh, progress=press_ctrl_c)
    assert caught.value.run.ending == "stopped"


def test_two_runs_in_two_threads(mesh):
    stiffnesses = [5e10, 2e11]
    found = [None, None]

    def solve(index):
        fracture = {"joint": {"normal_stiffness": stiffnesses[index]}}
        run = scene_of().replace(fracture=fracture).solve(mesh, threads=index + 1)
        found[index] = run.fractures["joint"].aperture

    threads = [threading.Thread(target=solve, args=(index,)) for index in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for aperture, stiffness in zip(found, stiffnesses):
        expected = closed_aperture(PRESSURE, stiffness)
        np.testing.assert_allclose(aperture, expected, rtol=ROUNDING)


def test_a_notebook_shows_a_run(scene, mesh):
    page = scene.solve(mesh)._repr_html_()
    assert "a joint" in page and "joint" in page and "<table>" in page


def test_one_of_a_thing_is_told_in_the_singular(scene, mesh):
    run = scene.solve(mesh)
    assert ", 1 load step, solved)" in repr(run) and ": 1 load step, solved<" in run._repr_html_()
    assert repr(run.fractures["joint"]) == "FractureResult('joint', 4 facets)"
    two = scene_of(load=kluft.Load(steps=[0.5, 1.0])).solve(mesh)
    assert "2 load steps" in repr(two) and "2 load steps" in two._repr_html_()
    assert repr(mesh.survey()) == "Survey(1 fracture, 2 blocks)"
    assert repr(mesh.survey(fractures=[])) == "Survey(0 fractures, 1 block)"
    assert repr(kluft.Mesh.from_arrays(*block(1))) == "Mesh('arrays', 12 nodes, 2 cells)"


def test_a_field_that_is_not_there_is_refused_with_those_that_are(scene, mesh):
    run = scene.solve(mesh)
    for refused in (lambda: run.plot("nonsense"), lambda: run.fractures["joint"]["nonsense"]):
        with pytest.raises(KeyError, match="nonsense.*aperture.*slip"):
            refused()


def test_a_real_interrupt_ends_a_process_of_its_own(tmp_path):
    """SIGINT reaches the thread that called while the run works."""
    script = tmp_path / "long.py"
    script.write_text(
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "import kluft\n"
        "from conftest import block, scene_of\n"
        "mesh = kluft.Mesh.from_arrays(*block(4))\n"
        "scene = scene_of(load={'steps': [0.5 + 1e-4 * i for i in range(5000)]})\n"
        "print('begun', flush=True)\n"
        "try:\n"
        "    scene.solve(mesh, threads=1)\n"
        "except KeyboardInterrupt as stopped:\n"
        "    print('stopped after', len(stopped.run.steps), flush=True)\n"
    )
    here = str(pathlib.Path(__file__).parent)
    process = subprocess.Popen(
        [sys.executable, str(script), here], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "begun\n"
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert said.startswith("stopped after "), said
    assert 0 < int(said.split()[-1]) < 5000


def test_an_interrupt_ends_gmsh(tmp_path):
    """A geometry that never ends is left at once, and gmsh with it."""
    (tmp_path / "endless.geo").write_text("For(0:1e9)\nEndFor\n")
    script = tmp_path / "endless.py"
    script.write_text(
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from conftest import scene_of\n"
        "print('begun', flush=True)\n"
        "try:\n"
        "    scene_of(mesh={'geometry': sys.argv[2]}).solve()\n"
        "except KeyboardInterrupt:\n"
        "    print('stopped', flush=True)\n"
    )
    here = str(pathlib.Path(__file__).parent)
    process = subprocess.Popen(
        [sys.executable, str(script), here, str(tmp_path / "endless.geo")],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "begun\n"
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=10)
    assert said == "stopped\n"


def test_numbers_do_not_depend_on_threads(scene, mesh):
    one, two = (scene.solve(mesh, threads=count).rock.cell_fields["stress"] for count in (1, 2))
    np.testing.assert_array_equal(one, two)
    assert one.shape[1] == 6


def test_a_scene_with_a_geometry_is_meshed_and_solved(tmp_path):
    """The shipped joint as it stands, with the closed form of its head."""
    geometry = pathlib.Path(__file__).parents[3] / "geometries" / "inclined-joint"
    if shutil.which("gmsh") is None:
        pytest.skip("gmsh is not installed")
    run = kluft.Scene.read(geometry / "scene.toml").solve()
    np.testing.assert_allclose(run.fractures["joint"].aperture, 1.987915035e-6, rtol=1e-8)
    assert list(tmp_path.iterdir()) == []
