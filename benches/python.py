"""The package for Python beside the command: steps on prepared rock, and memory.

    python benches/python.py advance [--fields 100]
    python benches/python.py memory [--refine 2]

Needs the package (a wheel that is installed, or `PYTHONPATH=crates/python/python` with a release build
of the extension) and gmsh; best with the machine to itself. Both print a table for
docs/performance/python.md.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from unittest import mock

import numpy as np

import kluft

SCENE = Path(__file__).resolve().parent.parent / "geometries/closing-blocks/scene.toml"
COMMAND = [sys.executable, "-m", "kluft", "run", "--quiet", "--no-report"]
ON_FOLDER = "import sys, kluft; kluft.Scene.read(sys.argv[1]).solve(out=sys.argv[2], keep=False)"
IN_MEMORY = "import sys, kluft; kluft.Scene.read(sys.argv[1]).solve()"


def pressures(points, count):
    """So many pressure fields (Pa) on points: a front that goes from one end of x to the other."""
    places = (points[:, 0] - points[:, 0].min()) / max(np.ptp(points[:, 0]), 1e-12)
    for front in np.linspace(0.0, 1.0, count):
        yield 3e6 * np.exp(-(((places - front) / 0.3) ** 2))


def timed_run(scene):
    """A run, and its seconds."""
    start = time.perf_counter()
    run = scene.solve()
    return run, time.perf_counter() - start


def advance(count):
    """Times one run, meshed and with its mesh kept, then steps under pressure fields on rock that is
    prepared once."""
    scene = kluft.Scene.read(SCENE)
    with mock.patch.dict(os.environ, KLUFT_CACHE=""):
        _, meshed = timed_run(scene)
    scene.solve()
    fresh, one = timed_run(scene)
    start = time.perf_counter()
    with scene.prepare() as run:
        prepared = time.perf_counter() - start
        names = list(fresh.fractures)
        fields = zip(*(pressures(run.points(name), count) for name in names))
        for field in fields:
            run.advance(fluid_pressure=dict(zip(names, field)))
    all_steps = time.perf_counter() - start
    apertures = [step.fractures["bedding"].numbers["aperture"]["mean"] for step in run.steps]
    assert len(apertures) == count and np.ptp(apertures) > 0.0
    unknowns = fresh.summary["unknowns"]["total"]
    print("| unknowns | fields | to prepare | all fields | one run | of its mesh on |")
    print("|---|---|---|---|---|---|")
    print(
        f"| {unknowns} | {count} | {prepared:.2f} s | {all_steps:.2f} s | "
        f"{meshed:.2f} s: {all_steps / meshed:.1f} times | {one:.2f} s: {all_steps / one:.1f} times |"
    )


def peak(command):
    """Largest memory (bytes) of a process of its own."""
    child = subprocess.Popen(command, cwd=tempfile.gettempdir())
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise SystemExit(f"{command} ended with the code {child.returncode}")
    return 1024 * used.ru_maxrss


def memory(refine, program):
    """Largest memory of a run by the command and through Python."""
    command = [Path(program).resolve(), *COMMAND[3:]] if program else COMMAND
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        geometry = f'geometry = "{SCENE.parent}/'
        text = SCENE.read_text("utf-8").replace('geometry = "', geometry)
        scene.write_text(text.replace("[mesh]", f"[mesh]\nrefine = {refine}"), "utf-8")
        out = os.path.join(folder, "out")
        ways = {
            "the command": [*command, str(scene), "--out", out],
            "Python, results in a folder": [sys.executable, "-c", ON_FOLDER, str(scene), out],
            "Python, results in memory": [sys.executable, "-c", IN_MEMORY, str(scene)],
        }
        peaks = {}
        for name, words in ways.items():
            peaks[name] = peak(words)
            print(name, f"{peaks[name] / 1e6:.0f} MB", file=sys.stderr, flush=True)
        unknowns = kluft.read(out).summary["unknowns"]["total"]
    print(f"{unknowns} unknowns\n\n| way | largest memory | of the command's |\n|---|---|---|")
    for name, most in peaks.items():
        print(f"| {name} | {most / 1e6:.0f} MB | {100 * most / peaks['the command']:.1f} % |")


def main():
    """Measures what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["advance", "memory"])
    parser.add_argument("--fields", type=int, default=100)
    parser.add_argument("--refine", type=int, default=2)
    parser.add_argument("--program", help="the program, instead of that of the package")
    asked = parser.parse_args()
    if asked.what == "advance":
        advance(asked.fields)
    else:
        memory(asked.refine, asked.program)


if __name__ == "__main__":
    main()
