"""The line on the error stream that follows a run."""

import pytest
from conftest import scene_of

import kluft
from kluft import solving


def refused_by_the_mesh():
    """A scene whose mesh is refused once stages have begun."""
    return scene_of(boundary={"tpo": kluft.Boundary(pressure="1 MPa")})


@pytest.mark.parametrize("call", ["solve", "prepare"])
def test_the_line_is_ended_where_the_input_is_refused(mesh, capfd, call):
    with pytest.raises(kluft.InputError):
        getattr(refused_by_the_mesh(), call)(mesh, progress=True)
    said = capfd.readouterr().err
    assert said.strip() and said.endswith("\n")


@pytest.mark.parametrize(
    "seconds, left",
    [(0.1, ""), (3, "(about 9 s left)"), (120, "(about 6 min left)"), (7200, "(about 6.0 h left)")],
)
def test_the_line_says_how_long_the_steps_that_are_left_take(monkeypatch, capsys, seconds, left):
    """One step of four has taken `seconds`, three are left."""
    clock = [100.0]
    monkeypatch.setattr(solving.time, "monotonic", lambda: clock[0])
    with solving.followed(True) as told:
        for step in (1, 2):
            told({"event": "step begins", "step": step, "steps": 4, "what": ""})
            told({"event": "iteration", "iteration": 1, "force_residual": 0.1})
            clock[0] += seconds
    first, second = [line.strip() for line in capsys.readouterr().err.split("\r") if line]
    assert first == "step 1 of 4, iteration 1, residual 1.0e-01"
    assert second == f"step 2 of 4 {left}".strip() + ", iteration 1, residual 1.0e-01"


def test_an_estimate_begins_anew_with_the_first_step_of_another_mesh(monkeypatch, capsys):
    clock = [100.0]
    monkeypatch.setattr(solving.time, "monotonic", lambda: clock[0])
    with solving.followed(True) as told:
        for step, taken in [(1, 1000.0), (2, 1000.0), (1, 10.0), (2, 0.0)]:
            told({"event": "step begins", "step": step, "steps": 2, "what": ""})
            told({"event": "stage begins", "stage": "factorising"})
            clock[0] += taken
    last = capsys.readouterr().err.split("\r")[-1]
    assert last.strip() == "step 2 of 2 (about 10 s left) factorising"


def test_the_line_follows_the_steps_of_a_run(mesh, capfd):
    scene_of(load=kluft.Load(steps=[0.5, 1.0])).solve(mesh, progress=True)
    said = capfd.readouterr().err
    assert said.index("step 1 of 2, iteration 1") < said.index("step 2 of 2, iteration 1")
    assert said.endswith("\n") and "Traceback" not in said
