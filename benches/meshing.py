"""Ways to mesh beside one another: time in gmsh, cells, their quality, failures.

    python3 benches/meshing.py [--rounds 3] [--limit 600] [--gmsh PROGRAM]... [NAME...]

All geometries of geometries/ (or those named) with all ways, in turn, as often as there are rounds. Needs
target/release/kluft, which tells the quality. Writes docs/performance/meshing.md and meshing.csv beside it.
"""

import argparse
import csv
import json
import os
import statistics
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/performance/meshing.md"
WORK = ROOT / "target/meshing"
WAYS = {
    "Delaunay": {"Mesh.Algorithm3D": 1},
    "HXT": {"Mesh.Algorithm3D": 10},
    "Delaunay, not optimised": {"Mesh.Algorithm3D": 1, "Mesh.Optimize": 0},
    "HXT, not optimised": {"Mesh.Algorithm3D": 10, "Mesh.Optimize": 0},
    "HXT, two threads": {"Mesh.Algorithm3D": 10, "General.NumThreads": 2},
    "Delaunay, facets by MeshAdapt": {"Mesh.Algorithm3D": 1, "Mesh.Algorithm": 1},
    "HXT, facets by Delaunay": {"Mesh.Algorithm3D": 10, "Mesh.Algorithm": 5},
}
"""Options of gmsh."""


def mesh(gmsh, geometry, way, limit):
    """Seconds that gmsh takes, or why it failed, and the mesh file."""
    made = WORK / "made.msh"
    made.unlink(missing_ok=True)
    command = [gmsh, geometry, "-3", "-format", "msh41", "-bin", "-nopopup", "-v", "2", "-o", made]
    for option, value in WAYS[way].items():
        command += ["-setnumber", option, str(value)]
    start = time.perf_counter()
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        return None, f"not ended after {limit} s", made
    seconds = time.perf_counter() - start
    said = [line.split(":", 1)[1].strip() for line in (done.stdout + done.stderr).splitlines() if line.startswith("Error")]
    if done.returncode or said or not made.exists():
        return None, (said or [f"exit code {done.returncode}"])[0], made
    return seconds, None, made


def quality(path):
    """Cells, the mean and the worst quality, as `kluft inspect` tells them; or why it refuses the mesh."""
    command = [ROOT / "target/release/kluft", "inspect", path, "--json", "--out", WORK / "inspect"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        return None, done.stderr.strip().splitlines()[0]
    told = json.loads(done.stdout)
    worst = told["cells"]["worst"]
    return (told["mesh"]["cells"], told["cells"]["mean_quality"], worst[0]["quality"]), None


def measure(arguments):
    """A row for each geometry, program and way: seconds of all rounds, or the failure."""
    rows = {}
    names = arguments.names or sorted(path.stem for path in (ROOT / "geometries").glob("*/*.geo"))
    for number in range(arguments.rounds):
        for name in names:
            for gmsh in arguments.gmsh:
                for way in WAYS:
                    row = rows.setdefault((name, gmsh, way), {"seconds": [], "failure": None, "quality": None})
                    if row["failure"]:
                        continue
                    geometry = ROOT / "geometries" / name / f"{name}.geo"
                    seconds, row["failure"], made = mesh(gmsh, geometry, way, arguments.limit)
                    if seconds is not None:
                        row["seconds"].append(seconds)
                        if number == 0:
                            row["quality"], row["failure"] = quality(made)
                    print(name, gmsh, way, seconds or row["failure"], flush=True)
    return rows


def version(gmsh):
    """What gmsh says of itself."""
    done = subprocess.run([gmsh, "--version"], capture_output=True, text=True, check=True)
    return (done.stdout + done.stderr).strip()


def write(rows, arguments):
    """The page, and all numbers."""
    versions = {gmsh: version(gmsh) for gmsh in arguments.gmsh}
    with PAGE.with_suffix(".csv").open("w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["geometry", "gmsh", "way", "seconds", "cells", "mean_quality", "worst_quality", "failure"])
        for (name, gmsh, way), row in rows.items():
            seconds = " ".join(f"{value:.3f}" for value in row["seconds"])
            out.writerow([name, versions[gmsh], way, seconds, *(row["quality"] or ("", "", "")), row["failure"] or ""])
    text = PAGE.read_text()
    begin, end = "<!-- begin of the table -->\n", "<!-- end of the table -->"
    before, rest = text.split(begin)
    PAGE.write_text(before + begin + "\n" + table(rows, versions) + "\n" + end + rest.split(end)[1])


def table(rows, versions):
    """A line for each geometry and version, with the ways side by side."""
    lines = ["| geometry | gmsh | " + " | ".join(WAYS) + " |", "|---|---|" + "---|" * len(WAYS)]
    for name, gmsh in dict.fromkeys((name, gmsh) for name, gmsh, _ in rows):
        cells = (cell(rows[name, gmsh, way]) for way in WAYS)
        lines.append(f"| {name} | {versions[gmsh]} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def cell(row):
    """Median of the seconds, thousands of cells, and the worst quality."""
    if row["failure"]:
        return "fails"
    count, _, worst = row["quality"]
    return f"{statistics.median(row['seconds']):.2f} s, {count / 1e3:.1f}, {worst:.2f}"


def main():
    """Measures and writes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--limit", type=float, default=600, help="seconds a mesh may take")
    parser.add_argument("--gmsh", action="append", help="a program; may be given several times")
    parser.add_argument("names", nargs="*", metavar="NAME")
    arguments = parser.parse_args()
    arguments.gmsh = arguments.gmsh or [os.environ.get("KLUFT_GMSH") or "gmsh"]
    WORK.mkdir(parents=True, exist_ok=True)
    write(measure(arguments), arguments)


if __name__ == "__main__":
    main()
