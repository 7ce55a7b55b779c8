"""Load steps on prepared rock beside closed forms and beside fresh runs."""

import numpy as np
import pytest
from conftest import APERTURE, PRESSURE, closed_aperture, scene_of

import kluft

ROUNDING = 1e-9


@pytest.fixture
def run(scene, mesh):
    with scene.prepare(mesh, threads=2) as prepared:
        yield prepared


def test_loads_are_given_with_each_step(run):
    assert set(run.acting) >= {"top", "joint", "gravity"}
    for factor in (0.3, 1.5, 0.7):
        step = run.advance(factors={"top": factor})
        expected = closed_aperture(factor * PRESSURE)
        np.testing.assert_allclose(step.fractures["joint"].aperture, expected, rtol=ROUNDING)
    assert [step.number for step in run.steps] == [1, 2, 3]
    assert run.last.time == 3.0


def test_pressures_push_the_walls_apart(run):
    for pressure in (5e6, 12e6, 0.0):
        step = run.advance(fluid_pressure={"joint": pressure})
        expected = closed_aperture(PRESSURE - pressure)
        np.testing.assert_allclose(step.fractures["joint"].aperture, expected, rtol=ROUNDING)
    array = np.full(len(run.points("joint")), 8e6)
    run.advance(fluid_pressure={"joint": array})
    # The pressure stays until another one is given.
    joint = run.advance(factors={"top": 1.2}).fractures["joint"]
    expected = closed_aperture(1.2 * PRESSURE - 8e6)
    np.testing.assert_allclose(joint.aperture, expected, rtol=ROUNDING)


def test_a_pressure_may_vary_along_a_fracture(run):
    """Forces balance: the mean normal traction is what presses less the mean pressure."""
    x = run.points("joint")[:, 0]
    joint = run.advance(fluid_pressure={"joint": 1e7 * x}).fractures["joint"]
    assert joint.numbers["normal_traction"]["mean"] == pytest.approx(-PRESSURE + 5e6, rel=1e-6)
    left, right = joint.aperture[x == 0.0].mean(), joint.aperture[x == 1.0].mean()
    assert right > left


def test_stiffnesses_change_between_steps(run):
    for stiffness in (5e10, 4e11):
        step = run.advance(fracture={"joint": {"normal_stiffness": stiffness}})
        expected = closed_aperture(PRESSURE, stiffness)
        np.testing.assert_allclose(step.fractures["joint"].aperture, expected, rtol=ROUNDING)
    step = run.advance(fracture={"joint": kluft.Fracture(closure="linear")})
    expected = APERTURE - PRESSURE / 4e11
    np.testing.assert_allclose(step.fractures["joint"].aperture, expected, rtol=ROUNDING)


def test_what_does_not_fit_is_refused_and_changes_nothing(run):
    with pytest.raises(KeyError, match="bottm"):
        run.advance(factors={"bottm": 1.0})
    with pytest.raises(kluft.InputError) as caught:
        run.advance(fracture={"joint": {"normal_stiffness": -1.0}})
    assert "normal_stiffness" in str(caught.value)
    with pytest.raises(kluft.InputError) as caught:
        run.advance(fracture={"joint": {"friction_angle": 30}})
    assert "prepare" in caught.value.defects[0].remedy
    joint = run.advance().fractures["joint"]
    np.testing.assert_allclose(joint.aperture, closed_aperture(PRESSURE), rtol=ROUNDING)


def test_pressures_of_no_fracture_are_refused_with_the_names_of_fractures(run):
    for refused in (lambda: run.advance(fluid_pressure={"foo": 1e6}), lambda: run.points("foo")):
        with pytest.raises(KeyError, match="foo; there are: joint") as caught:
            refused()
        assert "gravity" not in str(caught.value)


def test_pressures_of_another_number_are_refused_with_both_numbers(run):
    count = len(run.points("joint"))
    for pressures in (np.zeros(3), np.zeros((count, 1))):
        with pytest.raises(ValueError, match=rf"{count} points.*points\('joint'\)") as caught:
            run.advance(fluid_pressure={"joint": pressures})
        assert f"'joint': an array of shape {pressures.shape}" in str(caught.value)


def test_pressures_that_do_not_come_about_leave_those_of_the_scene(mesh):
    """What is refused, and what does not converge, changes nothing."""
    law = dict(aperture=0, closure="contact", friction_angle=30)
    contact = {"joint": kluft.Fracture(**law, fluid_pressure=5e6)}
    with scene_of(fracture=contact).prepare(mesh) as run:
        for pressures, error in ((np.zeros(3), ValueError), (3e7, kluft.NotConverged)):
            with pytest.raises(error):
                run.advance(fluid_pressure={"joint": pressures})
            joint = run.advance().fractures["joint"]
            np.testing.assert_allclose(joint.normal_traction, -PRESSURE + 5e6, rtol=1e-6)


def test_friction_remembers_as_in_a_run_of_many_steps(mesh):
    """The same path of loads, asked for step by step and written into a scene."""
    held, moved = {"x": 0, "y": 0, "z": 0}, {"x": 4e-4, "y": 0, "z": -2e-4}
    boundary = {"bottom": {"displacement": held}, "top": {"displacement": moved}}
    fracture = {
        "joint": kluft.Fracture(
            aperture=APERTURE, normal_stiffness=1e11, shear_stiffness=1e11, friction_angle=25
        )
    }
    factors = [0.5, 1.0, 0.6]
    scene = scene_of(boundary=boundary, fracture=fracture)
    whole = scene.replace(load={"steps": factors}).solve(mesh)
    with scene.prepare(mesh) as run:
        for factor in factors:
            run.advance(factor)
        last = run.fractures["joint"]
    slips = whole.fractures["joint"].slip
    assert np.abs(slips).max() > 1e-5 and whole.fractures["joint"].numbers["sliding_area"] == 0
    np.testing.assert_allclose(last.slip, slips, rtol=1e-3, atol=1e-3 * np.abs(slips).max())


def test_a_step_that_fails_leaves_the_run_where_it_was(mesh):
    contact = {"joint": kluft.Fracture(aperture=0, closure="contact", friction_angle=30)}
    with scene_of(fracture=contact).prepare(mesh) as run:
        run.advance()
        with pytest.raises(kluft.NotConverged) as caught:
            run.advance(fluid_pressure={"joint": 3e7})
        assert caught.value.step == 2 and len(run.steps) == 1
        joint = run.advance(fluid_pressure={"joint": 5e6}).fractures["joint"]
    np.testing.assert_allclose(joint.normal_traction, -PRESSURE + 5e6, rtol=1e-6)


def test_rock_is_returned_where_it_is_asked_for(run):
    assert len(run.advance().rock.points) == 0
    rock = run.advance(rock=True).rock
    np.testing.assert_allclose(rock.cell_fields["stress"][:, 2], -PRESSURE, rtol=1e-6)


def test_a_run_that_is_closed_keeps_its_results(scene, mesh, tmp_path):
    run = scene.prepare(mesh)
    run.advance()
    run.close()
    with pytest.raises(RuntimeError, match="closed"):
        run.advance()
    read = kluft.read(run.save(tmp_path / "out"))
    aperture = read.fractures["joint"].aperture
    np.testing.assert_allclose(aperture, closed_aperture(PRESSURE), rtol=ROUNDING)
    assert "joint" in run.history_csv


def test_a_fluid_that_flows_is_not_given_pressures(mesh):
    scene = scene_of(fluid=kluft.Fluid(viscosity=1e-3)).replace(
        boundary={"left": {"fluid_pressure": 1e6}}, fracture={"joint": {"hydraulic_aperture": 1e-4}}
    )
    with pytest.raises(kluft.InputError, match="fluid"):
        scene.prepare(mesh)
