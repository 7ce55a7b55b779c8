"""The linear solver that is chosen for each scene of geometries/, beside the three that could be.

    python3 benches/choice.py [--rounds 3] [--limit 60] [SCENE...]

Runs each scene with the solver of the program's choice and with each of the three by name, in turn, on meshes that are
kept, and writes docs/performance/choice.md. A solver that takes longer than the limit (s) and four times the chosen one
is stopped and counts as slower. Takes the release build in target/release as it stands.
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
PAGE = ROOT / "docs/performance/choice.md"
WORK = ROOT / "target/choice"
METHODS = ["chosen", "direct", "condensed", "iterative"]
BRIEF = 2.0
"""Seconds below which every run is made again in each round; longer ones are made twice."""

LARGEST_RATIO = 1.3
"""The choice is to take no longer than this many times the best."""


def scene_of(name, method):
    """The scene of geometries/ that solves by a method."""
    folder = WORK / "geometries" / name
    text = (folder / "scene.toml").read_text()
    if method != "chosen":
        line = f'linear = "{method}"\n'
        if "\n[solver]\n" in text:
            text = re.sub(r"\nlinear = .*", "", text).replace("\n[solver]\n", "\n[solver]\n" + line)
        else:
            text += "\n[solver]\n" + line
    scene = folder / f"{method}.toml"
    scene.write_text(text)
    return scene


def solver_of(decisions):
    """The linear solver that the decisions of a run name, of several runs the first."""
    found = re.findall(r"linear solver: .*?(direct|condensed|iterative)", "\n".join(decisions))
    return found[0] if found else "-"


def run(name, method, limit):
    """Seconds of a run without its mesh, of its solver, and what it says of it; the reason if there is none."""
    out = WORK / "out" / method
    shutil.rmtree(out, ignore_errors=True)
    command = [ROOT / "target/release/kluft", "run", scene_of(name, method), "--out", out, "--no-report", "--quiet"]
    start = time.perf_counter()
    try:
        done = subprocess.run(command, capture_output=True, timeout=limit, text=True)
    except subprocess.TimeoutExpired:
        return {"fails": f"over {limit:.0f} s"}
    wall = time.perf_counter() - start
    if done.returncode != 0:
        words = done.stderr.strip().splitlines()
        return {"fails": words[0] if words else f"exit code {done.returncode}"}
    summary = json.loads((out / "summary.json").read_text())
    seconds = summary["seconds"]
    solver = sum(seconds.get(part) or 0.0 for part in ("factorise", "solve"))
    return {
        "wall": wall - (seconds.get("mesh") or 0.0),
        "solver": solver,
        "method": solver_of(summary["decisions"]),
        "unknowns": (summary.get("unknowns") or {}).get("total"),
        "steps": len(summary.get("steps", [])),
    }


def measure(name, rounds, limit):
    """The runs of a scene by method, as many as there are rounds; two if they are long."""
    found = {method: [] for method in METHODS}
    for round in range(rounds):
        for method in METHODS:
            runs = found[method]
            if runs and ("fails" in runs[0] or (round > 1 and runs[0]["wall"] > BRIEF)):
                continue
            chosen = found["chosen"]
            longest = max(limit, 4.0 * chosen[0]["wall"]) if chosen and "wall" in chosen[0] else 4.0 * limit
            runs.append(run(name, method, longest))
    return found


def median(runs, what):
    """The median of what was measured, none if a run fails."""
    values = [run.get(what) for run in runs]
    return None if None in values else statistics.median(values)


def line(name, found):
    """A line of the table, and how many times the best the choice takes."""
    walls = {method: median(runs, "wall") for method, runs in found.items()}
    solvers = {method: median(runs, "solver") for method, runs in found.items()}
    best = min((wall for method, wall in walls.items() if method != "chosen" and wall is not None), default=None)
    chosen = found["chosen"][0]
    if best is None or walls["chosen"] is None:
        return None, None
    ratio = walls["chosen"] / best
    cell = lambda method: "-" if walls[method] is None else f"{walls[method]:.2f} ({solvers[method]:.2f})"
    cells = [cell(method) for method in METHODS]
    unknowns = f"{chosen['unknowns']:,}".replace(",", " ")
    return f"| {name} | {unknowns} | {chosen['steps']} | {chosen['method']} | " + " | ".join(cells) + f" | {ratio:.2f} |", ratio


def write(lines, ratios, rounds):
    """The page."""
    beyond = [name for name, ratio in ratios.items() if ratio > LARGEST_RATIO]
    said = "none" if not beyond else ", ".join(beyond)
    worst = max(ratios.values())
    PAGE.write_text(
        f"""# The choice of the linear solver

Written by `python3 benches/choice.py`: each scene of `geometries/` with the solver that the program
chooses and with each of the three by name, in turn, on two threads. Seconds are those of the whole
run without its mesh, in brackets those of the solver alone; medians of {rounds} rounds, or of two where
a run takes over {BRIEF:.0f} s. The ratio is that of the run as chosen to the best of the three. A dash is
a solver that refuses, fails or takes over four times as long. Scenes of flow in rigid rock, which
have no choice, are left out.

Over {LARGEST_RATIO} times the best: {said}; the worst {worst:.2f}.

| scene | unknowns | load steps | chosen | as chosen (s) | direct (s) | condensed (s) | iterative (s) | ratio |
| --- | ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: |
"""
        + "\n".join(lines)
        + "\n"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("scenes", nargs="*")
    asked = parser.parse_args()
    shutil.rmtree(WORK, ignore_errors=True)
    shutil.copytree(ROOT / "geometries", WORK / "geometries")
    names = asked.scenes or sorted(path.parent.name for path in (ROOT / "geometries").glob("*/scene.toml"))
    lines, ratios = [], {}
    for name in names:
        found = measure(name, asked.rounds, asked.limit)
        text, ratio = line(name, found)
        if ratio is not None:
            lines.append(text)
            ratios[name] = ratio
        fails = {method: runs[0]["fails"] for method, runs in found.items() if "fails" in runs[0]}
        print(text or name, fails or "", flush=True)
    if not asked.scenes:
        write(lines, ratios, asked.rounds)


if __name__ == "__main__":
    main()
