"""Kluft: how fractured rock deforms in three dimensions.

    import gmsh, kluft
    mesh = kluft.Mesh.from_gmsh()
    run = kluft.Scene.read("scene.toml").solve(mesh)
    run.fractures["fault"].aperture

Values are in SI units; tension is positive, and the normal of a fracture points from minus to plus.
"""

from . import keys
from .errors import Defect, InputError, NotConverged, Stopped
from .grid import Grid
from .keys import *  # noqa: F403
from .mesh import Mesh, Survey
from .networks import Network, network
from .prepared import PreparedRun
from .run import FractureResult, Run, Step, read
from .scene import Scene
from .studying import Setting, Study, study

__all__ = [
    "Defect",
    "FractureResult",
    "Grid",
    "InputError",
    "Mesh",
    "Network",
    "NotConverged",
    "PreparedRun",
    "Run",
    "Scene",
    "Setting",
    "Step",
    "Stopped",
    "Study",
    "Survey",
    "network",
    "read",
    "study",
    *keys.__all__,
]
