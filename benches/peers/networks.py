"""Whole runs on networks of fractures, up to five million unknowns, beside one linear solve of PETSc GAMG.

    sh benches/peers/networks.sh [--up-to THOUSANDS]

gmsh makes the meshes once, into target/networks (the finest of them takes some minutes, and refining the largest network
8 GB); they are not measured. Writes docs/performance/networks.md.
"""

import argparse
import json
import math
import os
import re
import statistics
import subprocess
import sys
from dataclasses import dataclass, replace

from driver import HERE, ROOT, build, linear_commands, run, say
from report import wrapped

WORK = ROOT / "target/networks"
GMSH = os.environ.get("KLUFT_GMSH") or "gmsh"
CUBES = 69
"""Cubes an edge of the linear system: 1.01 million unknowns."""


@dataclass
class Case:
    """A network, its mesh and its load."""

    network: str
    sizes: tuple
    """Sizes h, h_fracture and h_intersection (m); none for those of the scene."""
    pressure: str
    """Pressure on top (Pa)."""
    thousands: int
    """Unknowns."""
    rounds: int
    refined: bool = False

    @property
    def name(self):
        """Name of its files."""
        sizes = "-".join(str(size) for size in self.sizes)
        return "-".join(filter(None, (self.network, sizes, "refined" if self.refined else "")))


CASES = (
    Case("network-20", (0.24, 0.12, 0.1), "50e6", 667, 3),
    Case("network-20", (0.204, 0.102, 0.085), "50e6", 1019, 3),
    Case("network-100", (1.0, 0.5, 0.45), "10e6", 127, 3),
    Case("network-100", (), "10e6", 725, 3),
    Case("network-100", (), "10e6", 5068, 2, refined=True),
)


def mesh(case):
    """The mesh file of a case; gmsh makes it if it is not there."""
    path = WORK / f"{case.name}.msh"
    if path.exists():
        return path
    WORK.mkdir(parents=True, exist_ok=True)
    made = WORK / f"{case.name}-unfinished.msh"
    options = ["-format", "msh41", "-bin", "-o", made]
    if case.refined:
        source = mesh(replace(case, refined=False))
        command = [GMSH, source, "-refine", *options]
    else:
        geometry = ROOT / "geometries" / case.network / f"{case.network}.geo"
        text = (geometry.parent / "scene.toml").read_text()
        given = re.search(r"parameters = \{(.*)\}", text).group(1)
        values = dict(part.strip().split(" = ") for part in given.split(","))
        values |= dict(zip(("h", "h_fracture", "h_intersection"), map(str, case.sizes)))
        numbers = [word for name, value in values.items() for word in ("-setnumber", name, value)]
        command = [GMSH, geometry, "-3", *numbers, *options]
    say(f"meshing {case.name}")
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)
    made.rename(path)
    return path


def scene(case):
    """The scene of a case in a folder of its own."""
    text = (ROOT / "geometries" / case.network / "scene.toml").read_text()
    text = re.sub(r'geometry = .*\nparameters = .*', f'file = "{mesh(case)}"', text)
    text = re.sub(r"(\[boundary.top\]\npressure = ).*", rf"\g<1>{case.pressure}", text)
    folder = WORK / case.name
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "scene.toml"
    path.write_text(text)
    return path


def measure(case):
    """One run: seconds of the whole process, peak memory, and its summary."""
    path = scene(case)
    command = [ROOT / "target/release/kluft", "run", path, "--out", path.parent / "results", "--quiet"]
    printed = run([sys.executable, HERE / "measure.py", path.parent / "log", *command])
    if printed is None:
        raise SystemExit(f"{case.name} failed:\n{(path.parent / 'log').read_text()}")
    summary = json.loads((path.parent / "results/summary.json").read_text())
    return json.loads(printed) | {"summary": summary}


def gamg():
    """Set-up and solution of one linear system of a million unknowns (s)."""
    folder = WORK / f"cube-{CUBES}"
    if not (folder / "coordinates.npy").exists():
        subprocess.run([sys.executable, HERE / "cube.py", str(CUBES), folder], check=True)
    command, threads = linear_commands(folder)["gamg"]
    lines = (run(command, threads=threads) or "").splitlines()
    record = json.loads(next(line for line in lines if line.startswith("{")))
    return record["setup_seconds"], record["solve_seconds"]


def closing(summary):
    """Smallest aperture as a share of the largest, which no load has reached."""
    apertures = [fracture["aperture"] for fracture in summary["fractures"].values()]
    return min(aperture["min"] / aperture["max"] for aperture in apertures)


def row(case, runs):
    """A row of the table."""
    middle = lambda of: statistics.median(of(run) for run in runs)
    summary = runs[-1]["summary"]
    step = summary["steps"][0]
    gigabytes = lambda count: f"{count / 1e9:.2f}"
    name = f"{case.network}, refined" if case.refined else case.network
    return " | ".join(
        (
            f"| {name}",
            f"{summary['unknowns']['total']:,}".replace(",", " "),
            f"{summary['unknowns']['jump']:,}".replace(",", " "),
            f"{closing(summary):.3f}",
            f"{middle(lambda r: r['seconds']):.1f}",
            *(f"{middle(lambda r, key=key: r['summary']['seconds'][key]):.2f}" for key in STAGES),
            f"{step['newton_iterations']} / {step['linear_iterations']}",
            gigabytes(summary["predicted_memory_bytes"]),
            gigabytes(middle(lambda r: r["peak_memory_bytes"])),
            f"{len(runs)} |",
        )
    )


STAGES = ("read", "assemble", "factorise", "solve", "estimate", "write")


def growth(results):
    """Exponents of time and memory from each mesh of network-100 to its finest, or nothing if that was not run."""
    meshes = [runs for case, runs in results if case.network == "network-100"]
    if len(meshes) < 3:
        return ""
    size = lambda runs: runs[-1]["summary"]["unknowns"]["total"]
    middle = lambda runs, key: statistics.median(run[key] for run in runs)
    def exponent(runs, key):
        ratio = math.log(size(meshes[-1]) / size(runs))
        return math.log(middle(meshes[-1], key) / middle(runs, key)) / ratio
    lines = (
        f"From {size(runs):,} to {size(meshes[-1]):,} unknowns of `network-100` the time grows as "
        f"N^{exponent(runs, 'seconds'):.2f} and the memory as N^{exponent(runs, 'peak_memory_bytes'):.2f}."
        for runs in meshes[:-1]
    )
    return "\n".join(lines).replace(",", " ") + "\n"


HEADER = """# Whole runs on networks of fractures

Written by `sh benches/peers/networks.sh`: one load step from the mesh file to the written results,
all fractures with the logarithmic law, two threads. Seconds are medians of the runs; "whole" is the
process from start to end, meshing by gmsh left out. "Closed to" is the smallest aperture as a share
of what it was. Memory is the peak of the process, predicted before the solver was set up and
measured.

| network | unknowns | of them jumps | closed to | whole (s) | read (s) | assemble (s) | set up (s) | solve (s) | estimate errors (s) | write (s) | Newton / linear iterations | predicted (GB) | measured (GB) | runs |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""


def write(results, linear):
    """The page."""
    lines = HEADER + "\n".join(row(case, runs) for case, runs in results) + "\n\n" + growth(results)
    million = [runs for case, runs in results if case.thousands == 1019]
    if linear and million:
        alone = statistics.median(sum(seconds) for seconds in linear)
        whole = statistics.median(run["seconds"] for run in million[0])
        setup, solve = linear[-1]
        lines += (
            f"\nPETSc GAMG on two processes solves one linear system of {3 * CUBES * (CUBES + 1) ** 2:,} unknowns".replace(",", " ")
            + f", to 1e-8, in {alone:.1f} s (median of {len(linear)}, measured in turn with the runs above; last {setup:.1f} s of set-up and "
            f"{solve:.1f} s of solution). The whole nonlinear run with a million unknowns takes {whole / alone:.2f} times that.\n"
        )
    (ROOT / "docs/performance/networks.md").write_text(wrapped(lines))


def main():
    """All cases."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--up-to", type=int, default=10**6, metavar="THOUSANDS", help="largest number of unknowns")
    options = parser.parse_args()
    build()
    results, linear = [], []
    for case in CASES:
        if case.thousands > options.up_to:
            continue
        runs = []
        for number in range(case.rounds):
            if case.thousands == 1019:
                linear.append(gamg())
                say(f"GAMG: {linear[-1][0]:.1f} s + {linear[-1][1]:.1f} s")
            mesh(case)
            runs.append(measure(case))
            say(f"{case.name}, round {number + 1}: {runs[-1]['seconds']:.1f} s")
        results.append((case, runs))
        write(results, linear)
    say("wrote docs/performance/networks.md")


if __name__ == "__main__":
    main()
