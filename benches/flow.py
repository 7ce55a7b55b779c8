"""Flow in networks of fractures: alone in a thousand, and coupled with the rock around a hundred.

    python3 benches/flow.py [--rounds 3] [--only alone|injection]

An injection of 20 time steps runs in turn with one load step in linear elastic rock on the same mesh, as often as there
are rounds. Both networks are meshed before. Writes the tables in docs/performance/flow.md, from medians.
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
PAGE = ROOT / "docs/performance/flow.md"
WORK = ROOT / "target/flow"
PROGRAM = ROOT / "target/release/kluft"
STEPS = 20
SECONDS = 600
STRESSES = {"right": 7e6, "back": 8e6, "top": 10e6}


def made(name):
    """The folder with the scene of a network, made anew."""
    folder = WORK / name
    shutil.rmtree(folder, ignore_errors=True)
    command = [PROGRAM, "network", ROOT / f"benches/flow/{name}.toml", "-o", folder]
    subprocess.run(command, capture_output=True, check=True)
    return folder


def run(scene, out):
    """Seconds of a run and its summary."""
    command = [PROGRAM, "run", scene, "--out", out, "--no-report", "--quiet"]
    start = time.perf_counter()
    subprocess.run(command, capture_output=True, check=True)
    seconds = time.perf_counter() - start
    return seconds, json.loads((out / "summary.json").read_text())


def alone_scene(folder):
    """A thousand fractures whose facets are divided into sixteen."""
    scene = folder / "scene.toml"
    text = re.sub(r"^dimension = 2.*", "dimension = 2\nrefine = 2", scene.read_text(), flags=re.M)
    scene.write_text(text)
    return scene


def injection_scene(folder):
    """The network under its stress, injected into for ten minutes."""
    constant = f"history = [[0, 1], [{SECONDS}, 1]]"
    text = (folder / "scene.toml").read_text().replace("rate = 1e-3", f"rate = 1e-3\n{constant}")
    for side, pressure in STRESSES.items():
        text += f"\n[boundary.{side}]\npressure = {pressure:.0f}\n{constant}\n"
    stress = dict(zip(("xx", "yy", "zz"), STRESSES.values()))
    lines = "\n".join(f"{name} = {-value:.0f}" for name, value in stress.items())
    times = [SECONDS * (step + 1) / STEPS for step in range(STEPS)]
    text += f"\n[initial_stress]\n{lines}\n\n[load]\ntimes = {times}\n\n[solver]\ntime_accuracy = 1.0\n"
    scene = folder / "injection.toml"
    scene.write_text(text)
    return scene


def elastic_scene(folder):
    """One load step of the same mesh with linear laws and without a fluid."""
    text = (folder / "scene.toml").read_text().replace('closure = "logarithmic"', 'closure = "linear"')
    text = re.sub(r"^(\[fluid\]|\[\[source\]\])\n(?:[^\[\n].*\n)*", "", text, flags=re.M)
    text += f"\n[boundary.top]\npressure = {STRESSES['top']:.0f}\n"
    scene = folder / "elastic.toml"
    scene.write_text(text)
    return scene


def solving(summary):
    """Seconds of a run from the first factor to the last solution."""
    return summary["seconds"]["factorise"] + summary["seconds"]["solve"]


def median_of(runs, measure):
    """The median of a measure of runs."""
    return statistics.median(measure(seconds, summary) for seconds, summary in runs)


def number(value):
    """A number with its thousands apart."""
    return f"{value:_}".replace("_", " ")


def injection(rounds):
    """The table of the injection."""
    folder = made("injection")
    scenes = {"linear elastic, one load step": elastic_scene(folder), f"injection, {STEPS} time steps": injection_scene(folder)}
    found = {name: [] for name in scenes}
    run(elastic_scene(folder), folder / "out-first")
    for _ in range(rounds):
        for name, scene in scenes.items():
            found[name].append(run(scene, folder / f"out-{scene.stem}"))
            print(name, f"{found[name][-1][0]:.1f} s", flush=True)
    lines = ["| | unknowns of the rock | whole run | solver | Newton | linear iterations | memory |", "|---|---:|---:|---:|---:|---:|---:|"]
    for name, runs in found.items():
        last = runs[-1][1]
        total = [sum(step[key] for step in last["steps"]) for key in ("newton_iterations", "linear_iterations")]
        seconds = [median_of(runs, lambda seconds, _: seconds), median_of(runs, lambda _, summary: solving(summary))]
        memory = max(summary["peak_memory_bytes"] for _, summary in runs) / 1e9
        row = [name, number(last["unknowns"]["total"]), *(f"{one:.1f} s" for one in seconds), *map(number, total), f"{memory:.2f} GB"]
        lines.append("| " + " | ".join(map(str, row)) + " |")
    elastic, flow = found.values()
    ratios = [
        median_of(flow, measure) / median_of(elastic, measure)
        for measure in (lambda seconds, _: seconds, lambda _, summary: solving(summary))
    ]
    worst = max(step["flow"]["mass_error"] for _, summary in flow for step in summary["steps"])
    lines.append("")
    lines.append(f"{ratios[0]:.1f} times the whole elastic run, {ratios[1]:.1f} times its solver. Largest mass error of a step: {worst:.1e}.")
    return "\n".join(lines)


def alone(rounds):
    """The table of the thousand fractures."""
    scene = alone_scene(made("alone"))
    runs = [run(scene, scene.parent / "out") for _ in range(rounds)]
    last = runs[-1][1]
    stages = [
        ("gmsh, where a mesh is made", median_of(runs, lambda _, s: s["seconds"]["mesh"] + s["seconds"]["mesh_spared"])),
        ("read, divided, checked", median_of(runs, lambda _, s: s["seconds"]["read"])),
        ("assembled", median_of(runs, lambda _, s: s["seconds"]["assemble"])),
        ("factorised and solved", median_of(runs, lambda _, s: solving(s))),
        ("written", median_of(runs, lambda _, s: s["seconds"]["write"])),
        ("whole run", median_of(runs, lambda seconds, s: seconds + s["seconds"]["mesh_spared"])),
    ]
    lines = ["| stage | |", "|---|---:|", *(f"| {name} | {seconds:.1f} s |" for name, seconds in stages)]
    memory = max(summary["peak_memory_bytes"] for _, summary in runs) / 1e9
    lines.append(f"| peak of memory | {memory:.2f} GB |")
    lines.append("")
    lines.append(f"{number(last['mesh']['nodes'])} nodes.")
    return "\n".join(lines)


def put(name, table):
    """Puts a table between its marks on the page."""
    begin, end = f"<!-- begin of {name} -->\n", f"<!-- end of {name} -->"
    before, rest = PAGE.read_text().split(begin)
    PAGE.write_text(before + begin + "\n" + table + "\n\n" + end + rest.split(end)[1])


def main():
    """Measures and writes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", choices=["alone", "injection"])
    asked = parser.parse_args()
    for name, measure in {"alone": alone, "injection": injection}.items():
        if asked.only in (None, name):
            put(name, measure(asked.rounds))


if __name__ == "__main__":
    main()
