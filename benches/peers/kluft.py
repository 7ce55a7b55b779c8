"""Kluft: its scene, its command, its results."""

import io
import json
import shutil
import subprocess

import numpy as np

import meshes
import problems
import vtu

SCENE = """title = "{title}"

[mesh]
file = "mesh.msh"

[rock.rock]
young_modulus = {young!r}
poisson_ratio = {poisson!r}

[fracture.fracture]
aperture = {aperture!r}
normal_stiffness = {stiffness!r}
shear_stiffness = {stiffness!r}
closure = "logarithmic"
cutoff_aperture = {cutoff!r}

[boundary.top]
traction = [0.0, 0.0, {load!r}]
"""

SUPPORT = """
[boundary.{name}]
displacement = {{ {axis} = 0.0 }}
"""

FIXED_POINT = """
[[fixed_point]]
at = {at}
displacement = {{ {axis} = 0.0 }}
"""


def write(problem, mesh, folder):
    """Writes the scene and its mesh. Nothing is chosen that the program can choose itself."""
    meshes.write_msh(mesh, folder / "mesh.msh", problem.surfaces())
    (folder / "closed.toml").write_text(scene(problem, mesh, problems.LOAD))
    (folder / "opened.toml").write_text(scene(problem, mesh, -problems.LOAD))


def scene(problem, mesh, pressure):
    """The text of the scene."""
    text = SCENE.format(
        title=problem.name,
        young=problems.YOUNG_MODULUS,
        poisson=problems.POISSON_RATIO,
        aperture=problems.APERTURE,
        stiffness=problems.STIFFNESS,
        cutoff=problems.CUTOFF,
        load=-pressure,
    )
    for name, component in problem.held:
        axis = "xyz"[component]
        if name not in problem.lines:
            text += SUPPORT.format(name=name, axis=axis)
            continue
        for node in np.unique(mesh.patches[name]):
            text += FIXED_POINT.format(at=mesh.points[node].tolist(), axis=axis)
    return text


def command(root, folder):
    """What to run: the release binary, writing its results into `folder`/out."""
    shutil.rmtree(folder / "out", ignore_errors=True)
    return [root / "target/release/kluft", "run", folder / "closed.toml", "--out", folder / "out", "-v"]


def facets(folder):
    """Centres (m) and mean apertures (m) of all facets after the load step."""
    found = sorted((folder / "out").glob("**/fractures*.vtu"))
    points, (offsets, nodes), data, _ = vtu.read(found[-1])
    count = np.diff(offsets)
    centres = np.add.reduceat(points[nodes], offsets[:-1]) / count[:, None]
    return centres, np.add.reduceat(data["aperture"][nodes].ravel(), offsets[:-1]) / count


def opened_facets(root, folder):
    """The same as `facets` for the opened joint, integrated at Gauss points."""
    bench = ["cargo", "bench", "--quiet", "--locked", "--bench", "gauss_facets", "--"]
    output = subprocess.run([*bench, folder / "opened.toml"], cwd=root, check=True, stdout=subprocess.PIPE).stdout
    rows = np.loadtxt(io.BytesIO(output), ndmin=2)
    return rows[:, :3], rows[:, 3]


def iterations(folder):
    """Newton iterations, and the sum of the iterations of an iterative linear solver (0 with a direct one)."""
    steps = json.loads((folder / "out/summary.json").read_text())["steps"]
    return steps[-1]["newton_iterations"], steps[-1]["linear_iterations"]
