"""What is computed on the meshes, in SI units; the same for all programs.

A joint of the logarithmic law closes under one load step from its initial aperture to about a third of it.
"""

from dataclasses import dataclass

import meshes

YOUNG_MODULUS = 50e9
"""Pa."""
POISSON_RATIO = 0.25
STIFFNESS = 1e11
"""Normal stiffness at the initial aperture, and shear stiffness (Pa/m)."""
APERTURE = 1e-4
"""Initial aperture (m)."""
CUTOFF = 1e-6
"""Aperture below which the stiffness goes on linearly (m); never reached here."""
LOAD = 30e6
"""Pressure on the top face (Pa)."""


@dataclass(frozen=True)
class Problem:
    """One problem: supports, and how to make a mesh of about so many thousand unknowns."""

    name: str
    """Name in tables."""
    held: tuple
    """Pairs of a patch and the component of displacement (0, 1, 2) that is zero on it."""
    jumps: tuple
    """Pairs of a line of the fracture and the components of the jump that are zero on it. Programs that constrain
    displacements on both sides of a fracture need no such condition."""
    lines: tuple
    """The patches among `held` that are lines of nodes."""
    fineness: dict
    """By thousands of unknowns: cells along an edge, or the size of a cell (m)."""

    def mesh(self, size, folder):
        """The mesh of about `size` thousand unknowns; `folder` takes what is written meanwhile."""
        if self.name == "disc, tet":
            return meshes.disc(self.fineness[size], folder)
        return meshes.cut(self.name.removeprefix("cut, "), self.fineness[size])

    def surfaces(self):
        """Names of the outer faces with a condition."""
        return [name for name, _ in self.held if name not in self.lines] + ["top"]


SIZES = (20, 55, 146, 414)
"""Thousands of unknowns, roughly."""

CUT_HELD = (("bottom", 2), ("front", 1), ("back", 1), ("edge", 0))
CUT_JUMPS = (("fracture_front", (1,)), ("fracture_back", (1,)))
CUT_CELLS = {20: 14, 55: 20, 146: 28, 414: 40}
DISC_HELD = (("bottom", 2), ("front", 1), ("back", 1), ("left", 0), ("right", 0))
DISC_SIZES = {20: 0.0532, 55: 0.0364, 146: 0.0260, 414: 0.0182}

PROBLEMS = (
    Problem("cut, hex", CUT_HELD, CUT_JUMPS, ("edge",), CUT_CELLS),
    Problem("cut, tet", CUT_HELD, CUT_JUMPS, ("edge",), CUT_CELLS),
    Problem("disc, tet", DISC_HELD, (("fracture_tip", (0, 1, 2)),), (), DISC_SIZES),
)
