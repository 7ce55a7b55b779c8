"""Runs on many ranks: weak scaling by count, and two ranks, or one of two threads, beside two threads.

    python3 benches/ranks.py [--rounds 3] [--only weak|pair]

Weak scaling counts iterations, messages and bytes on 1, 2, 4 and 8 ranks with about as many unknowns each; more ranks
than cores are allowed, since no time is taken. Ranks and threads run in turn on one mesh, which wants an idle machine.
Both write their table in docs/performance/many-machines.md.
"""

import argparse
import json
import re
import shutil
import statistics
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/performance/many-machines.md"
WORK = ROOT / "target/ranks"
SERIAL = ROOT / "target/release/kluft"
RANKS = ROOT / "target/mpi/release/kluft-mpi"
LAUNCH = ["mpiexec", "--oversubscribe", "--allow-run-as-root", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]
COUNTS = (1, 2, 4, 8)
# Cell sizes of `network-20` that give one rank some 60 thousand unknowns.
SIZES = {"h": 0.66, "h_fracture": 0.33, "h_intersection": 0.26}
TOLD = re.compile(r"takes ([\d.]+) reductions and ([\d.]+) halo exchanges over (\d+) levels; a rank sends ([\d.]+) messages of ([\d.]+) kB")
LARGEST = re.compile(r"the largest rank has ([\d.]+) times")


def number(value):
    """A number with its thousands apart."""
    return f"{value:_}".replace("_", " ")


def scene_of(name, parameters, folder):
    """A scene of `geometries/` with other cell sizes, in a folder of its own."""
    folder.mkdir(parents=True)
    for file in (ROOT / "geometries" / name).iterdir():
        if file.is_file():
            shutil.copy(file, folder)
    scene = folder / "scene.toml"
    given = ", ".join(f"{key} = {value:.4g}" for key, value in parameters.items())
    scene.write_text(re.sub(r"^parameters = .*", f"parameters = {{ {given} }}", scene.read_text(), flags=re.M))
    return scene


def on_ranks(scene, out, ranks, threads=1):
    """Seconds, summary and words of a run on ranks of so many threads."""
    command = [*LAUNCH, "-n", str(ranks), RANKS, "run", scene, "--out", out, "--no-report", "-v", "--threads", str(threads)]
    start = time.perf_counter()
    words = subprocess.run(command, capture_output=True, check=True, text=True).stdout
    return time.perf_counter() - start, json.loads((out / "summary.json").read_text()), " ".join(words.split())


def serial(scene, out):
    """Seconds and summary of a run with two threads."""
    command = [SERIAL, "run", scene, "--out", out, "--no-report", "--quiet", "--threads", "2"]
    start = time.perf_counter()
    subprocess.run(command, capture_output=True, check=True)
    return time.perf_counter() - start, json.loads((out / "summary.json").read_text())


def iterations(summary):
    """Newton and linear iterations of a run."""
    return [sum(step[key] for step in summary["steps"]) for key in ("newton_iterations", "linear_iterations")]


def weak():
    """The table of weak scaling."""
    lines = [
        "| ranks | unknowns | linear iterations, with `kluft run` | levels | reductions | halo exchanges | messages of a rank | their mean size | largest rank against the mean |",
        "|---:|---:|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for ranks in COUNTS:
        folder = WORK / f"weak-{ranks}"
        shutil.rmtree(folder, ignore_errors=True)
        sizes = {key: value * ranks ** (-1 / 3) for key, value in SIZES.items()}
        scene = scene_of("network-20", sizes, folder)
        _, alone = serial(scene, folder / "serial")
        _, found, words = on_ranks(scene, folder / "ranks", ranks)
        told = TOLD.search(words)
        reductions, exchanges, levels, messages, size = told.groups()
        if ranks == 1:
            messages, size, exchanges = "-", "-", "-"
        row = [
            ranks,
            number(found["unknowns"]["total"]),
            f"{iterations(found)[1]}, {iterations(alone)[1]}",
            levels,
            reductions,
            exchanges,
            messages,
            size if size == "-" else f"{size} kB",
            LARGEST.search(words).group(1),
        ]
        lines.append("| " + " | ".join(map(str, row)) + " |")
        print(lines[-1], flush=True)
    return "\n".join(lines)


def pair(rounds):
    """The table of two ranks, and one of two threads, beside two threads."""
    folder = WORK / "pair"
    shutil.rmtree(folder, ignore_errors=True)
    sizes = {"h": 0.42, "h_fracture": 0.22, "h_intersection": 0.2}
    scene = scene_of("network-100", sizes, folder)
    serial(scene, folder / "first")
    found = {"2 threads": [], "2 ranks": [], "1 rank of 2 threads": []}
    for _ in range(rounds):
        found["2 threads"].append(serial(scene, folder / "serial"))
        found["2 ranks"].append(on_ranks(scene, folder / "ranks", 2)[:2])
        found["1 rank of 2 threads"].append(on_ranks(scene, folder / "rank", 1, 2)[:2])
        print(*(f"{name} {runs[-1][0]:.1f} s" for name, runs in found.items()), flush=True)
    lines = ["| | unknowns | whole run | set-up of the solver | linear solves | iterations | memory of all |", "|---|---:|---:|---:|---:|---:|---:|"]
    medians = {}
    for name, runs in found.items():
        last = runs[-1][1]
        memory = (last.get("ranks") or {}).get("sum_of_peak_memory_bytes") or last["peak_memory_bytes"]
        stages = [lambda s, _: s, lambda _, t: t["seconds"]["factorise"], lambda _, t: t["seconds"]["solve"]]
        seconds = [statistics.median(stage(*one) for one in runs) for stage in stages]
        medians[name] = [*seconds, memory]
        row = [name, number(last["unknowns"]["total"]), *(f"{one:.1f} s" for one in seconds), iterations(last)[1], f"{memory / 1e9:.2f} GB"]
        lines.append("| " + " | ".join(map(str, row)) + " |")
    alone = medians.pop("2 threads")
    lines.append("")
    for name, own in medians.items():
        ratios = [ranks / threads for ranks, threads in zip(own, alone)]
        told = "{}: the whole {:.2f} times that of 2 threads, set-up {:.2f}, solves {:.2f}, memory {:.2f}."
        lines.append(told.format(name[0].upper() + name[1:], *ratios))
    return "\n".join(lines)


def write(name, table):
    """Puts a table where it belongs on the page."""
    marks = [f"<!-- {mark} of {name} -->" for mark in ("begin", "end")]
    before, rest = PAGE.read_text().split(marks[0])
    after = rest.split(marks[1])[1]
    PAGE.write_text(f"{before}{marks[0]}\n\n{table}\n\n{marks[1]}{after}")


def main():
    """Runs what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", choices=("weak", "pair"))
    chosen = parser.parse_args()
    if chosen.only != "pair":
        write("weak", weak())
    if chosen.only != "weak":
        write("pair", pair(chosen.rounds))


if __name__ == "__main__":
    main()
