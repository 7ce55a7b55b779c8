"""The line on the error stream that follows a run."""

import pytest
from conftest import scene_of

import kluft


def refused_by_the_mesh():
    """A scene whose mesh is refused once stages have begun."""
    return scene_of(boundary={"tpo": kluft.Boundary(pressure="1 MPa")})


@pytest.mark.parametrize("call", ["solve", "prepare"])
def test_the_line_is_ended_where_the_input_is_refused(mesh, capfd, call):
    with pytest.raises(kluft.InputError):
        getattr(refused_by_the_mesh(), call)(mesh, progress=True)
    said = capfd.readouterr().err
    assert said.strip() and said.endswith("\n")
