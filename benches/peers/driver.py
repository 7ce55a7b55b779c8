"""Runs Kluft and other programs in turn, keeps what was measured, writes the table and the chart.

Everything lies in target/peers. A measurement that is kept in results.jsonl there is not made again, unless the
program has changed since or `--again` is given; so an interrupted comparison goes on where it stopped.
"""

import argparse
import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import chart
import kluft
import opengeosys
import problems
import report

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "target/peers"
HERE = Path(__file__).resolve().parent

THREADS = 2
"""Threads, or processes, of every program."""

ROUNDS = {20: 3, 55: 3, 146: 2, 414: 1}
"""How often every whole run is measured, by thousands of unknowns."""

LARGEST_OPENED = 55
"""Thousands of unknowns up to which the opened joint is compared too."""

CUBES = {"small": (21, 31), "medium": (21, 31, 69), "all": (21, 31, 50, 69)}
"""Cubes an edge of the linear systems: 30, 95, 390 and 1014 thousand unknowns."""

CUBE_ROUNDS = {21: 3, 31: 3, 50: 1, 69: 1}
"""How often every linear system is solved, by cubes an edge."""

LARGEST_DIRECT = 50
"""Cubes an edge above which no direct solver runs: its factor would not fit into 24 GB."""

DEBIAN_PYTHON = "/usr/bin/python3"
"""The interpreter for which Debian builds PETSc and CHOLMOD."""


class Results:
    """The measurements kept so far, one JSON object a line."""

    def __init__(self, path, again):
        self.path = path
        if again:
            path.unlink(missing_ok=True)
        lines = path.read_text().splitlines() if path.exists() else []
        self.records = [json.loads(line) for line in lines]

    def find(self, **key):
        """The last record that has all these values, or None."""
        fitting = [record for record in self.records if key.items() <= record.items()]
        return fitting[-1] if fitting else None

    def add(self, **record):
        """Keeps a record, on disk too."""
        self.records.append(record)
        with open(self.path, "a", encoding="utf-8") as out:
            out.write(json.dumps(record) + "\n")
        return record


def say(text):
    """Tells how far the comparison is."""
    print(f"peers: {text}", file=sys.stderr, flush=True)


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(prog="sh benches/peers/run", description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", choices=("small", "medium", "all"), default="all",
                        help="small: up to 100 000 unknowns; medium: whole runs up to 146 000, linear systems 30 000 to 1 million")
    parser.add_argument("--again", action="store_true", help="forget what was measured before")
    parser.add_argument("--prefix", default="", help="a command in front of every measured command, like `nice -n -5`")
    return parser.parse_args()


def environment(threads):
    """The environment of a measured program with so many threads a process."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    petsc = sorted(Path("/usr/lib/petscdir").glob("petsc3*/*-real"))
    return os.environ | dict.fromkeys(names, str(threads)) | {"PETSC_DIR": str(petsc[-1]) if petsc else ""}


def run(command, prefix=(), threads=THREADS):
    """Output of a command; its errors go to the terminal. None if it fails."""
    command = [str(word) for word in (*prefix, *command)]
    done = subprocess.run(command, env=environment(threads), stdout=subprocess.PIPE, text=True, check=False)
    return done.stdout if done.returncode == 0 else None


def build():
    """Builds Kluft and returns what tells this build from others."""
    say("building Kluft")
    subprocess.run(["cargo", "build", "--release", "--locked"], cwd=ROOT, check=True)
    return hashlib.sha256((ROOT / "target/release/kluft").read_bytes()).hexdigest()[:12]


def measure_machine(results, prefix):
    """Memory bandwidth and dense flop rate."""
    if not results.find(kind="machine"):
        say("measuring the machine")
        measured = json.loads(run([sys.executable, HERE / "machine.py"], prefix))
        results.add(kind="machine", **measured)


def matched(centres, values, wanted):
    """The values at the facets with the wanted centres (m)."""
    distance, place = cKDTree(centres).query(wanted)
    assert distance.max() < 1e-9, "the programs have different facets"
    return values[place]


def difference(ours, theirs):
    """The largest relative difference."""
    return np.abs(ours / theirs - 1.0).max()


class WholeRun:
    """One problem of one size, as a folder with the input of all programs."""

    def __init__(self, problem, size):
        self.problem, self.size = problem, size
        self.folder = WORK / "runs" / f"{problem.name.replace(', ', '-')}-{size}"
        self.key = {"problem": problem.name, "size": size}

    def write(self):
        """Meshes and input files, unless they are there; the number of unknowns is written last."""
        done = self.folder / "unknowns"
        if not done.exists():
            say(f"writing {self.problem.name}, {self.size} thousand unknowns")
            self.folder.mkdir(parents=True, exist_ok=True)
            mesh = self.problem.mesh(self.size, self.folder)
            for program in (kluft, opengeosys):
                (self.folder / program.__name__).mkdir(exist_ok=True)
                program.write(self.problem, mesh, self.folder / program.__name__)
            done.write_text(str(mesh.unknowns()))
        return int(done.read_text())

    def measure(self, program, build, number, results, prefix):
        """Runs a program once and keeps what it took."""
        key = {"kind": "run", **self.key, "program": program.__name__, "build": build, "round": number}
        if results.find(**key):
            return
        unknowns = self.write()
        folder = self.folder / program.__name__
        say(f"{self.problem.name}, {unknowns} unknowns, round {number + 1}: {program.__name__}")
        log = folder / "log"
        launch = [sys.executable, HERE / "measure.py", log]
        output = run([*launch, *program.command(ROOT, folder)], prefix)
        if output is None:
            say(f"failed, see {log}")
            return
        newton, linear = program.iterations(folder)
        counts = {"newton": newton, "linear": linear}
        np.savez(self.facets_file(program.__name__), *program.facets(folder))
        record = results.add(**key, unknowns=unknowns, **counts, **json.loads(output))
        say(f"    {record['seconds']:.2f} s, {record['peak_memory_bytes'] / 1e6:.0f} MB")

    def facets_file(self, program):
        """Where centres (m) and apertures (m) of a program's facets are kept."""
        return WORK / "facets" / f"{self.folder.name}-{program}.npz"

    def compare(self, builds, results):
        """Keeps how far the apertures of the programs differ."""
        key = {"kind": "agreement", **self.key, **builds}
        if results.find(**key):
            return
        centres, theirs = np.load(self.facets_file("opengeosys")).values()
        ours = matched(*np.load(self.facets_file("kluft")).values(), centres)
        values = {"difference": difference(ours, theirs)}
        for name, apertures in (("opengeosys", theirs), ("kluft", ours)):
            values |= {name + "_min": apertures.min(), name + "_mean": apertures.mean()}
        if self.size <= LARGEST_OPENED:
            values["opened_difference"] = self.compare_opened()
        results.add(**key, **values)

    def compare_opened(self):
        """The largest difference of apertures with the load reversed and Gauss points in both; None if a run fails.

        The law of an open joint is linear, so both programs then integrate it exactly.
        """
        self.write()
        say(f"{self.problem.name}, {self.size} thousand unknowns: opened, for the comparison of apertures")
        if run(opengeosys.command(ROOT, self.folder / "opengeosys", "opened")) is None:
            return None
        centres, theirs = opengeosys.facets(self.folder / "opengeosys")
        try:
            ours = kluft.opened_facets(ROOT, self.folder / "kluft")
        except subprocess.CalledProcessError:
            say("    the measurement `gauss_facets` failed")
            return None
        return difference(matched(*ours, centres), theirs)

    def count_operations(self, build, results):
        """Keeps how many operations one factorisation of this problem takes, from its symbolic factor."""
        key = {"kind": "operations", **self.key, "build": build}
        if results.find(**key):
            return
        self.write()
        folder = self.folder / "kluft"
        inspect = [ROOT / "target/release/kluft", "inspect", folder / "closed.toml"]
        text = run([*inspect, "--json", "--out", folder / "out"])
        for solver in json.loads(text)["solvers"] if text else []:
            if solver.get("operations"):
                results.add(**key, operations=solver["operations"])
                return

    def remove(self):
        """Removes input and results, which are large."""
        shutil.rmtree(self.folder, ignore_errors=True)


def measure_runs(sizes, builds, results, prefix):
    """Measures whole runs, the programs in turn."""
    for size in sizes:
        for problem in problems.PROBLEMS:
            whole = WholeRun(problem, size)
            for number in range(ROUNDS[size]):
                for program in (opengeosys, kluft):
                    whole.measure(program, builds[program.__name__], number, results, prefix)
            measured = [results.find(kind="run", **whole.key, program=name, build=builds[name]) for name in builds]
            if all(measured):
                whole.compare(builds, results)
                whole.count_operations(builds["kluft"], results)
                whole.remove()


def linear_commands(folder):
    """Command and threads a process for every solver of linear systems."""
    linear = HERE / "linear.py"
    mpi = ["mpirun", "--oversubscribe", "-n", str(THREADS)]
    if os.geteuid() == 0:
        mpi.insert(1, "--allow-run-as-root")
    return {
        "gamg": ([*mpi, DEBIAN_PYTHON, linear, "gamg", folder], 1),
        "mumps": ([*mpi, DEBIAN_PYTHON, linear, "mumps", folder], 1),
        "cholmod": ([DEBIAN_PYTHON, linear, "cholmod", folder], THREADS),
        "pardiso": ([sys.executable, linear, "pardiso", folder], THREADS),
    }


def measure_linear(counts, results, prefix):
    """Measures the solvers of other packages on the linear systems."""
    for count in counts:
        folder = WORK / f"cube-{count}"
        for number in range(CUBE_ROUNDS[count]):
            for solver, (command, threads) in linear_commands(folder).items():
                key = {"kind": "linear", "count": count, "round": number}
                too_large = solver != "gamg" and count > LARGEST_DIRECT
                if too_large or results.find(**key, solver=solver):
                    continue
                if not (folder / "coordinates.npy").exists():
                    say(f"writing the linear system of {count} cubes an edge")
                    subprocess.run([sys.executable, HERE / "cube.py", str(count), folder], check=True)
                say(f"{count} cubes an edge, round {number + 1}: {solver}")
                keep_lines(run(command, prefix, threads), key, results)
        shutil.rmtree(folder, ignore_errors=True)


def keep_lines(output, key, results):
    """Keeps the JSON lines that a solver printed."""
    if output is None:
        say("    failed")
        return
    for line in output.splitlines():
        if line.startswith("{"):
            record = results.add(**key, **json.loads(line))
            say(f"    {record['setup_seconds']:.2f} s + {record['solve_seconds']:.2f} s, {record['solver']}")


def measure_own_linear(counts, build, results, prefix):
    """Measures Kluft's own solvers, by the measurement `linear_system`, which makes the same cube by itself."""
    bench = ["cargo", "bench", "--quiet", "--locked", "--bench", "linear_system"]
    if subprocess.run([*bench, "--no-run"], cwd=ROOT, check=False, stderr=subprocess.DEVNULL).returncode:
        say("Kluft's own linear solvers are left out: the measurement `linear_system` does not build")
        return
    manifest = ["--manifest-path", ROOT / "Cargo.toml"]
    for count in counts:
        for number in range(CUBE_ROUNDS[count]):
            key = {"kind": "linear", "count": count, "round": number, "build": build}
            if not results.find(**key):
                say(f"{count} cubes an edge, round {number + 1}: Kluft")
                keep_lines(run([*bench, *manifest, "--", count], prefix), key, results)


def main():
    """The whole comparison."""
    options = arguments()
    prefix = shlex.split(options.prefix)
    (WORK / "facets").mkdir(parents=True, exist_ok=True)
    results = Results(WORK / "results.jsonl", options.again)
    builds = {"opengeosys": version("ogs"), "kluft": build()}
    measure_machine(results, prefix)
    sizes = problems.SIZES[: {"small": 2, "medium": 3, "all": 4}[options.sizes]]
    measure_runs(sizes, builds, results, prefix)
    measure_linear(CUBES[options.sizes], results, prefix)
    measure_own_linear(CUBES[options.sizes], builds["kluft"], results, prefix)
    summary = report.Summary(results.records, builds)
    report.write(summary, ROOT / "docs/performance")
    chart.draw(summary, ROOT / "docs/performance/peers.svg")
    say("wrote docs/performance/peers.md, docs/performance/peers.csv and docs/performance/peers.svg")


if __name__ == "__main__":
    main()
