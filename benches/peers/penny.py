"""Measures accuracy and time of Kluft and OpenGeoSys on a penny-shaped crack; writes docs/performance/penny-peers.md and its chart.

Everything lies in target/penny. Both programs run in turn on the same meshes, smallest first; what was measured is
kept in results.json there. `--resume` goes on with a run that was stopped; `--report` writes the page without measuring.
"""

import argparse
import json
import shutil
import subprocess
import sys
from pathlib import Path
from statistics import median

import opengeosys
import penny_case as case
import penny_errors
import penny_report

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
WORK = ROOT / "target/penny"
GEOMETRY = ROOT / "geometries/penny/penny.geo"

LONGEST = 300
"""Seconds after which a run is given up."""
SHORT, ROUNDS = 5.0, 3
"""Runs shorter than so many seconds are made so often, and the median is kept."""

SIZES = {"linear": (0.14, 0.1, 0.062), "quadratic": (0.3, 0.2, 0.13), "quarter": (0.3, 0.2, 0.13, 0.1)}
"""Sizes of the cells at the rim (m), by elements: tetrahedra of 4 nodes, of 10, and of 10 with quarter points."""

TOLERANCES = (0.05, 0.02, 0.01)
"""Tolerances of the adaptive meshes, which Kluft makes itself."""

INTEGRATION_ORDER = {"linear": 2, "quadratic": 2, "quarter": 2}
"""Orders of integration in OpenGeoSys."""


def say(text):
    """Tells how far the comparison is."""
    print(f"penny: {text}", file=sys.stderr, flush=True)


def timed(command, folder):
    """Wall time (s) and peak memory (bytes) of a command that writes to `folder`/out; None if it fails."""
    rounds = []
    while len(rounds) < ROUNDS:
        shutil.rmtree(folder / "out", ignore_errors=True)
        (folder / "out").mkdir(parents=True)
        launch = [sys.executable, HERE / "measure.py", folder / "log", "timeout", LONGEST, *command]
        done = subprocess.run([str(word) for word in launch], stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode != 0:
            return None
        rounds.append(json.loads(done.stdout))
        if rounds[0]["seconds"] > SHORT:
            break
    names = ("seconds", "peak_memory_bytes")
    return {name: median(measured[name] for measured in rounds) for name in names} | {"rounds": len(rounds)}


def run_opengeosys(folder):
    """Measures OpenGeoSys on the project in the folder."""
    measured = timed(opengeosys.command(ROOT, folder, "penny"), folder)
    return measured and measured | penny_errors.errors(*case.opengeosys_openings(folder))


def run_kluft(folder):
    """Measures Kluft on the scene in the folder, the time of gmsh taken off."""
    measured = timed([WORK / "program", "run", folder / "scene.toml", "--out", folder / "out"], folder)
    if not measured:
        return None
    summary = json.loads((folder / "out/summary.json").read_text())
    measured["meshing_seconds"] = summary["seconds"].get("mesh", 0.0)
    measured["seconds"] -= measured["meshing_seconds"]
    measured["peak_memory_bytes"] = summary["peak_memory_bytes"]
    own = {row["name"]: row["value"] / row["exact"] - 1.0 for row in summary["measures"] if row["exact"]}
    found = penny_errors.errors(*case.kluft_openings(folder))
    return measured | {"own_unknowns": summary["unknowns"]["total"], "own": own} | found


def keep(records, key, measured):
    """Keeps what was measured, on disk too, in place of what an interrupted run measured."""
    records[:] = [record for record in records if not key.items() <= record.items()]
    records.append(key | (measured or {"failed": True}))
    (WORK / "results.json").write_text(json.dumps(records, indent=1))
    if measured:
        say(f"    {measured['seconds']:.2f} s, volume {100 * measured['volume']:+.2f} %")
    else:
        say("    failed, or took too long")


def compare(elements, size, records):
    """Both programs on one mesh."""
    folder = WORK / f"{elements}-{size}"
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "opengeosys").mkdir(parents=True)
    order = 1 if elements == "linear" else 2
    mesh = case.make_mesh(GEOMETRY, size, order, folder)
    (folder / "kluft").mkdir()
    is_quarter = "true" if elements == "quarter" else "false"
    lines = f'file = "{folder / "mesh.msh"}"\nquarter_points = {is_quarter}'
    case.write_scene(folder / "kluft/scene.toml", lines)
    moved = case.with_quarter_points(mesh) if elements == "quarter" else mesh
    case.write_project(folder / "opengeosys", moved, order, INTEGRATION_ORDER[elements])
    for program, run in (("opengeosys", run_opengeosys), ("kluft", run_kluft)):
        say(f"{elements}, {mesh.unknowns()} unknowns: {program}")
        key = {"elements": elements, "size": size, "program": program, "unknowns": mesh.unknowns()}
        keep(records, key, run(folder / program))
    shutil.rmtree(folder)


def adapt(tolerance, records):
    """Kluft on the meshes it makes itself until its estimate of the error is below the tolerance.

    The pressure acts inside the crack: far from it there is no stress then, of which the error is a share.
    """
    folder = WORK / f"adaptive-{tolerance}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    lines = f'geometry = "{GEOMETRY}"\nparameters = {{ h = 0.3, half = {case.HALF} }}\norder = 2\n'
    case.write_scene(folder / "scene.toml", lines + f"adapt = {{ tolerance = {tolerance} }}", case.PRESSURISED)
    say(f"adaptive, tolerance {tolerance}: kluft")
    measured = run_kluft(folder)
    key = {"elements": "adaptive", "size": tolerance, "program": "kluft"}
    keep(records, key | {"unknowns": measured["own_unknowns"] if measured else 0}, measured)
    shutil.rmtree(folder)


def measure(records):
    """Measures what is not among the records yet."""

    def is_done(elements, size):
        programs = {record["program"] for record in records if (record["elements"], record["size"]) == (elements, size)}
        return "kluft" in programs

    for tolerance in TOLERANCES:
        if not is_done("adaptive", tolerance):
            adapt(tolerance, records)
    meshes = [(elements, size) for elements, sizes in SIZES.items() for size in sizes]
    for elements, size in sorted(meshes, key=lambda mesh: SIZES[mesh[0]].index(mesh[1])):
        if not is_done(elements, size):
            compare(elements, size, records)


def main():
    """The whole comparison."""
    parser = argparse.ArgumentParser(prog="sh benches/peers/penny.sh", description=__doc__.splitlines()[0])
    parser.add_argument("--resume", action="store_true", help="go on with a run that was stopped, with the same program")
    parser.add_argument("--report", action="store_true", help="write the page from what was measured before")
    parser.add_argument("--note", default="", help="what readers should know about this run, for the page")
    options = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    kept = WORK / "results.json"
    if not options.resume and not options.report:
        # A copy: a build meanwhile must not change what is measured.
        shutil.copy(ROOT / "target/release/kluft", WORK / "program")
        kept.unlink(missing_ok=True)
    records = json.loads(kept.read_text()) if kept.exists() else []
    if not options.report:
        measure(records)
    tolerances = ", ".join(f"{100 * tolerance:g} %" for tolerance in TOLERANCES)
    limits = {"short": SHORT, "rounds": ROUNDS, "longest": LONGEST, "tolerances": tolerances, "note": options.note}
    penny_report.write(records, ROOT / "docs/performance", limits)
    say("wrote docs/performance/penny-peers.md and docs/performance/penny-peers.svg")


if __name__ == "__main__":
    main()
