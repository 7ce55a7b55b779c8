"""A block of 1 m that a horizontal joint cuts at half its height, in hexahedra."""

import numpy as np
import pytest

import kluft

YOUNG, POISSON = 50e9, 0.25
APERTURE, STIFFNESS, SHEAR = 1e-4, 1e11, 1e10
PRESSURE = 20e6


def block(n=2):
    """The mesh: ``2 n`` cells high, faces `top`, `bottom`, `left`, `front` and the `joint`."""
    axis = np.linspace(0.0, 1.0, n + 1)
    heights = np.linspace(0.0, 1.0, 2 * n + 1)
    z, y, x = np.meshgrid(heights, axis, axis, indexing="ij")
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(2 * n + 1, n + 1, n + 1)
    low, high = number[:-1], number[1:]

    def ring(layer):
        return [layer[:, :-1, :-1], layer[:, :-1, 1:], layer[:, 1:, 1:], layer[:, 1:, :-1]]

    cells = np.stack([*ring(low), *ring(high)], axis=-1).reshape(-1, 8)

    def quads(plane):
        corners = [plane[:-1, :-1], plane[:-1, 1:], plane[1:, 1:], plane[1:, :-1]]
        return {"quad": np.stack(corners, axis=-1).reshape(-1, 4)}

    surfaces = {
        "joint": quads(number[n]),
        "top": quads(number[-1]),
        "bottom": quads(number[0]),
        "left": quads(number[:, :, 0]),
        "front": quads(number[:, 0, :]),
    }
    return points, {"rock": {"hexahedron": cells}}, surfaces


@pytest.fixture(scope="session")
def mesh():
    return kluft.Mesh.from_arrays(*block())


def scene_of(**sections):
    """The block under pressure, its joint logarithmic."""
    given = dict(
        title="a joint",
        rock={"rock": kluft.Rock(young_modulus="50 GPa", poisson_ratio=POISSON)},
        fracture={
            "joint": kluft.Fracture(
                aperture="0.1 mm",
                normal_stiffness=STIFFNESS,
                shear_stiffness=SHEAR,
                closure="logarithmic",
            )
        },
        boundary={
            "top": kluft.Boundary(pressure="20 MPa"),
            "bottom": kluft.Boundary(symmetry=True),
            "left": kluft.Boundary(symmetry=True),
            "front": kluft.Boundary(symmetry=True),
        },
    )
    return kluft.Scene(**{**given, **sections})


@pytest.fixture
def scene():
    return scene_of()


def closed_aperture(pressure, stiffness=STIFFNESS):
    """Aperture (m) of a logarithmic joint (Nagel 2017), found by halving: with ``x = b / b0``,
    ``p = K_n0 b0 (1 + ln(x)^2) (1 - x)``."""
    low, high = 0.0, 1.0
    for _ in range(200):
        x = 0.5 * (low + high)
        carried = stiffness * APERTURE * (1.0 + np.log(x) ** 2) * (1.0 - x)
        low, high = (x, high) if carried > pressure else (low, x)
    return APERTURE * x
