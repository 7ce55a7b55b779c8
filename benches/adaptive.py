"""Adaptive runs from the geometry to a tolerance: meshed anew by gmsh, and bisected here.

    python3 benches/adaptive.py [--rounds 3]

Each scene runs in both ways in turn, with an empty cache of meshes, as often as there are rounds. Writes the table in
docs/performance/pipelines.md.
"""

import argparse
import json
import os
import shutil
import statistics
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/performance/pipelines.md"
WORK = ROOT / "target/adaptive"
SCENES = [("penny", 0.02), ("sphere", 0.003), ("small-cube-adaptive", 0.05), ("small-cube-adaptive", 0.025), ("small-cube-adaptive", 0.0125)]
WAYS = {"meshed anew": "", "bisected": ', by = "bisection"'}


def scene_of(name, tolerance, way):
    """The scene of geometries/ that finds its mesh in a way."""
    folder = WORK / name
    folder.mkdir(parents=True, exist_ok=True)
    text = (ROOT / "geometries" / name / "scene.toml").read_text()
    lines = [line for line in text.splitlines() if not line.startswith("adapt = ")]
    lines.insert(lines.index("[mesh]") + 1, f"adapt = {{ tolerance = {tolerance}{WAYS[way]} }}")
    text = "\n".join(lines).replace('"../', f'"{ROOT}/geometries/')
    scene = folder / f"{way.split()[0]}.toml"
    geometry = ROOT / "geometries" / name / f"{name}.geo"
    if geometry.exists():
        shutil.copy(geometry, folder)
    scene.write_text(text + "\n")
    return scene


def run(scene):
    """Seconds of a run, and its summary."""
    out = WORK / "out"
    shutil.rmtree(out, ignore_errors=True)
    command = [ROOT / "target/release/kluft", "run", scene, "--out", out, "--no-report", "--quiet"]
    start = time.perf_counter()
    subprocess.run(command, env={**os.environ, "KLUFT_CACHE": ""}, capture_output=True, check=True)
    seconds = time.perf_counter() - start
    return seconds, json.loads((out / "summary.json").read_text())


def measure(rounds):
    """The runs of each scene and way."""
    found = {}
    for _ in range(rounds):
        for name, tolerance in SCENES:
            for way in WAYS:
                measured = run(scene_of(name, tolerance, way))
                found.setdefault((name, tolerance, way), []).append(measured)
                print(name, tolerance, way, f"{measured[0]:.2f} s", flush=True)
    return found


def table(found):
    """A line for each scene and way."""
    head = ["scene", "tolerance", "way", "seconds", "of them gmsh", "unknowns of each mesh", "estimated error"]
    lines = ["| " + " | ".join(head) + " |", "|---|---:|---|---:|---:|---|---:|"]
    for (name, tolerance, way), runs in found.items():
        seconds = statistics.median(seconds for seconds, _ in runs)
        summary = runs[0][1]
        gmsh = statistics.median(summary["seconds"]["mesh"] for _, summary in runs)
        meshes = summary["meshes"]
        unknowns = ", ".join(f"{mesh['unknowns']:_}".replace("_", " ") for mesh in meshes)
        row = [name, tolerance, way, f"{seconds:.2f}", f"{gmsh:.2f}", unknowns, f"{meshes[-1]['error']:.4f}"]
        lines.append("| " + " | ".join(map(str, row)) + " |")
    return "\n".join(lines) + "\n"


def main():
    """Measures and writes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    found = measure(parser.parse_args().rounds)
    text = PAGE.read_text()
    begin, end = "<!-- begin of adaptive runs -->\n", "<!-- end of adaptive runs -->"
    before, rest = text.split(begin)
    PAGE.write_text(before + begin + "\n" + table(found) + "\n" + end + rest.split(end)[1])


if __name__ == "__main__":
    main()
