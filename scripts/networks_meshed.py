#!/usr/bin/env python3
"""Measures which share of random networks gmsh meshes, in every form that a geometry offers.

usage: scripts/networks_meshed.py [--program kluft] [--seeds 10] [--counts 100,300,1000]
                                  [--forms 0,1,2] [--algorithms 6,5] [--cell 2] [--limit 120]

The networks are those of `geometries/network-100` with other seeds, in cubes that keep their
density, and cells that are coarse for them. Writes docs/performance/network-meshing.md.
"""
import argparse
import pathlib
import re
import statistics
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/performance/network-meshing.md"
FORMS = {0: "whole", 1: "split", 2: "OpenCASCADE"}


def description(count, seed, cell):
    text = (ROOT / "geometries/network-100/network.toml").read_text()
    side = 20 * (count / 100) ** (1 / 3)
    steep = round(0.35 * count)
    for old, new in [
        ("seed = 4", f"seed = {seed}"),
        ("high = [20, 20, 20]", f"high = [{side:.6f}, {side:.6f}, {side:.6f}]"),
        ("h = 0.42", f"h = {2 * cell}"),
        ("h_fracture = 0.22", f"h_fracture = {cell}"),
        ("h_intersection = 0.2", f"h_intersection = {cell}"),
        ("count = 35", f"count = {steep}"),
        ("count = 30", f"count = {count - 2 * steep}"),
    ]:
        assert old in text, old
        text = text.replace(old, new)
    return text


def make(options, count, seed, folder):
    """Seconds from the description to the geometry."""
    (folder / "network.toml").write_text(description(count, seed, options.cell))
    start = time.perf_counter()
    subprocess.run(
        [options.program, "network", folder / "network.toml", "-o", folder / "made", "-q"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return time.perf_counter() - start


def mesh(folder, form, algorithm, limit):
    """Seconds to the mesh and None, or what went wrong."""
    out = folder / "out.msh"
    out.unlink(missing_ok=True)
    numbers = ["-setnumber", "form", str(form), "-setnumber", "Mesh.Algorithm", str(algorithm)]
    start = time.perf_counter()
    try:
        done = subprocess.run(
            ["gmsh", "-3", folder / "made/network.geo", *numbers, "-format", "msh41", "-bin", "-o", out],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=limit,
        )
    except subprocess.TimeoutExpired:
        return None, "time"
    seconds = time.perf_counter() - start
    if done.returncode < 0:
        return None, "crash"
    if re.search(r"^Error", done.stdout + done.stderr, re.M) or not out.exists():
        return None, "refused"
    return seconds, None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default=ROOT / "target/release/kluft")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--limit", type=float, default=120, help="seconds for gmsh")
    parser.add_argument("--cell", type=float, default=2.0, help="size on fractures, m")
    numbers = lambda text: [int(part) for part in text.split(",")]
    parser.add_argument("--counts", type=numbers, default=[100, 300, 1000])
    parser.add_argument("--forms", type=numbers, default=[0, 1, 2])
    parser.add_argument("--algorithms", type=numbers, default=[6, 5])
    options = parser.parse_args()
    rows = []
    for count in options.counts:
        outcomes, made, ever = {}, [], set()
        for seed in range(1, options.seeds + 1):
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                made.append(make(options, count, seed, folder))
                for form in options.forms:
                    for algorithm in options.algorithms:
                        seconds, wrong = mesh(folder, form, algorithm, options.limit)
                        outcomes.setdefault((form, algorithm), []).append((seconds, wrong))
                        if wrong is None:
                            ever.add(seed)
                        print(count, seed, FORMS[form], algorithm, wrong or f"{seconds:.1f} s", flush=True)
        for (form, algorithm), all_ in outcomes.items():
            good = [seconds for seconds, _ in all_ if seconds is not None]
            wrong = [wrong for _, wrong in all_ if wrong]
            told = ", ".join(f"{wrong.count(kind)} {kind}" for kind in sorted(set(wrong)))
            median = f"{statistics.median(good):.1f}" if good else "-"
            rows.append(
                f"| {count} | {statistics.median(made):.2f} | {FORMS[form]} | {algorithm} "
                f"| {len(good)} of {len(all_)} | {median} | {told or '-'} |"
            )
        rows.append(f"| {count} | | any of these | | {len(ever)} of {options.seeds} | | |")
    write(options, rows)


def write(options, rows):
    seeds = f"{options.seeds} seeds each" if options.seeds > 1 else "one seed"
    text = f"""# Meshing of random networks

Written by `scripts/networks_meshed.py`: networks as `geometries/network-100` in cubes that keep
its density, cells of {options.cell} m on fractures, {seeds}, at most {options.limit:.0f} s for gmsh. "To
the geometry" is `kluft network` from the description to the written file; "to the mesh" is gmsh
alone, from the geometry to the written mesh; both are medians. A network counts as meshed when
gmsh reports no error.

| fractures | to the geometry (s) | form | 2D algorithm | meshed | to the mesh (s) | what went wrong |
| ---: | ---: | --- | ---: | ---: | ---: | --- |
"""
    PAGE.write_text(text + "\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
