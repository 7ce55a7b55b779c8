"""Whole runs from the geometry to the grids: meshed, with the mesh kept, and by refinement, beside a former version.

    python3 benches/pipelines.py [--rounds 3] [--before CHECKOUT] [NAME...]

All scenes of geometries/ (or those named) run in turn, as often as there are rounds; CHECKOUT is a former version with
its release build and its own geometries. Writes docs/performance/pipelines.md and pipelines.csv beside it.
"""

import argparse
import csv
import json
import os
import shutil
import statistics
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/performance/pipelines.md"
WORK = ROOT / "target/pipelines"
MESHED, KEPT, BEFORE = "meshed", "mesh kept", "before"


def run(checkout, scene, way):
    """Seconds of a run, its summary's cells and seconds in gmsh; None if it failed."""
    out = WORK / "out"
    shutil.rmtree(out, ignore_errors=True)
    command = [checkout / "target/release/kluft", "run", scene, "--out", out, "--quiet"]
    if way == MESHED:
        command.append("--remesh")
    environment = {**os.environ, "KLUFT_CACHE": str(WORK / "cache")}
    start = time.perf_counter()
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - start
    if done.returncode:
        print(scene, way, done.stderr.strip(), flush=True)
        return None
    summary = json.loads((out / "summary.json").read_text())
    return seconds, summary["mesh"]["cells"], summary["seconds"]["mesh"]


def measure(arguments):
    """The runs of each scene and way."""
    names = arguments.names or sorted(path.parent.name for path in (ROOT / "geometries").glob("*/scene.toml"))
    ways = [(MESHED, ROOT), (KEPT, ROOT)]
    if arguments.before:
        ways.insert(0, (BEFORE, arguments.before.resolve()))
    found = {}
    for _ in range(arguments.rounds):
        for name in names:
            for way, checkout in ways:
                scene = checkout / "geometries" / name / "scene.toml"
                measured = run(checkout, scene, way) if scene.exists() else None
                if measured:
                    found.setdefault((name, way), []).append(measured)
                print(name, way, measured, flush=True)
    return names, found


def write(names, found):
    """The page, and all numbers."""
    with PAGE.with_suffix(".csv").open("w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["scene", "way", "seconds", "cells", "seconds_in_gmsh"])
        for (name, way), runs in found.items():
            for seconds, cells, gmsh in runs:
                out.writerow([name, way, f"{seconds:.3f}", cells, f"{gmsh:.3f}"])
    text = PAGE.read_text()
    begin, end = "<!-- begin of the table -->\n", "<!-- end of the table -->"
    before, rest = text.split(begin)
    PAGE.write_text(before + begin + "\n" + table(names, found) + "\n" + end + rest.split(end)[1])


def table(names, found):
    """A line for each scene: medians, and how much faster than before."""
    lines = ["| scene | cells | before | meshed | mesh kept |", "|---|---|---|---|---|"]
    for name in names:
        if (name, MESHED) not in found:
            continue
        cells = found[name, MESHED][0][1]
        median = {way: statistics.median(row[0] for row in found[name, way]) for way in (BEFORE, MESHED, KEPT) if (name, way) in found}
        shown = [f"{median[BEFORE]:.2f} s" if BEFORE in median else ""]
        for way in (MESHED, KEPT):
            times = f", {median[BEFORE] / median[way]:.1f} times faster" if BEFORE in median else ""
            shown.append(f"{median[way]:.2f} s{times}" if way in median else "")
        lines.append(f"| {name} | {cells} | " + " | ".join(shown) + " |")
    return "\n".join(lines) + "\n"


def main():
    """Measures and writes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--before", type=Path, help="checkout of a former version")
    parser.add_argument("names", nargs="*", metavar="NAME")
    arguments = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    write(*measure(arguments))


if __name__ == "__main__":
    main()
