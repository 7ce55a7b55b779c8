"""From the measurements that were kept to tables: peers.md and peers.csv in docs/performance."""

import csv
import io
import os
import platform
import textwrap
from pathlib import Path
from statistics import median

NAMES = {
    "kluft": "Kluft",
    "opengeosys": "OpenGeoSys",
    "gamg": "PETSc GAMG",
    "mumps": "MUMPS",
    "cholmod": "CHOLMOD",
    "pardiso": "PARDISO",
    "multigrid": "Kluft multigrid",
    "cholesky": "Kluft Cholesky",
}

COLUMNS = {
    "problem": "problem",
    "unknowns": "unknowns",
    "program": "program",
    "runs": "runs",
    "seconds": "wall time (s)",
    "setup_seconds": "set-up (s)",
    "solve_seconds": "solve (s)",
    "peak_memory_bytes": "peak memory (bytes)",
    "newton": "Newton iterations",
    "linear": "linear iterations",
    "difference": "largest relative difference of an aperture from OpenGeoSys",
    "opened_difference": "the same, load reversed, Gauss points in both",
}
"""Columns of the CSV file: key and heading."""

TEXT = """# Kluft and other programs

Written by `sh benches/peers/run`; what is run, and how, is in
[benches/README.md](../../benches/README.md). Measured on {processor}, {cores} cores, {memory:.0f}
GB: memory bandwidth {bandwidth:.1f} GB/s (two vectors read and one written), {flop_rate:.0f}
Gflop/s (product of full matrices of order 4096), both with two threads. Every program had two
threads, or two processes.

![Time and memory against unknowns](peers.svg)

## Whole runs

Reading the mesh, one load step, and writing the results; the same nodes and elements for both
programs. Medians of the runs. Memory is the peak of the process. Unknowns count displacements at
all nodes and jumps at all nodes of the fracture, held ones included.

{runs}

The problems are the same if the apertures agree. The difference is the largest one of the mean
aperture of a facet, relative. OpenGeoSys integrates fractures at Gauss points and Kluft at nodes
([why](../verification/facet-quadrature.md)), which gives the same where the stress is uniform
(`cut`) and another discretisation of the same problem where it is not (`disc`). The last column is
an exact check there too: the load is reversed, so that the joint opens and its law is linear, and
both programs use Gauss points.

{agreement}

OpenGeoSys 6.5.9 (process `SMALL_DEFORMATION_WITH_LIE`), with the fastest of its solvers: conjugate
gradients with a diagonal preconditioner, to 1e-10; Newton's method until the residual is 1e-8 of
the first one.

## Linear systems

A unit cube of six tetrahedra in every small cube, Young's modulus 1, Poisson's ratio 0.3, clamped
at z = 0, under a random load: one matrix, one right-hand side. Set-up is everything that depends on
the matrix alone: aggregation, or ordering and factorisation. Iterations until the residual is 1e-8
of the load. Memory is the peak of all processes with the matrix and all that surrounds it (about
0.1 GB a process is Python's).

{linear}

PETSc 3.18 with GAMG (conjugate gradients, rigid motions as near null space, two processes), MUMPS
by PETSc (two processes), CHOLMOD of SuiteSparse 5.12 with OpenBLAS, PARDISO of the MKL 2026.2.
"""


class Summary:
    """What tables and the chart show: lists of rows, smallest problems first."""

    def __init__(self, records, builds):

        def of_kind(kind):
            return [record for record in records if record["kind"] == kind]

        current = [record for record in of_kind("run") if builds[record["program"]] == record["build"]]
        self.machine = of_kind("machine")[-1]
        self.agreement = {(record["problem"], record["size"]): record for record in of_kind("agreement")}
        self.runs = self.medians(current)
        own = [record for record in of_kind("linear") if record.get("build", builds["kluft"]) == builds["kluft"]]
        self.linear = self.middle_ones(own)
        self.run_operations = self.operations(of_kind("operations"))
        self.linear_operations = {row["unknowns"]: row["factor_flops"] for row in self.linear if "factor_flops" in row}

    def operations(self, records):
        """Operations of one factorisation of the cut box of tetrahedra, by unknowns."""
        unknowns = {(row["problem"], row["size"]): row["unknowns"] for row in self.runs}
        kept = [record for record in records if record["problem"] == "cut, tet"]
        return {unknowns[record["problem"], record["size"]]: record["operations"] for record in kept}

    def medians(self, records):
        """One row for every problem, size and program."""
        groups = {}
        for record in records:
            groups.setdefault((record["problem"], record["size"], record["program"]), []).append(record)
        rows = []
        for (problem, size, program), group in sorted(groups.items()):
            row = {**group[-1], "runs": len(group)}
            for name in ("seconds", "peak_memory_bytes"):
                row[name] = median(record[name] for record in group)
            agreed = self.agreement.get((problem, size))
            if program == "kluft" and agreed:
                row |= {name: agreed.get(name) for name in ("difference", "opened_difference")}
            rows.append(row)
        return rows

    def middle_ones(self, records):
        """For every system and solver the run of the median time."""
        groups = {}
        for record in sorted(records, key=linear_seconds):
            groups.setdefault((record["unknowns"], list(NAMES).index(record["solver"])), []).append(record)
        return [{**group[len(group) // 2], "runs": len(group)} for _, group in sorted(groups.items())]

    def pairs(self):
        """Rows of both programs for every problem and size that both solved."""
        found = {}
        for row in self.runs:
            found.setdefault((row["problem"], row["size"]), {})[row["program"]] = row
        return [pair for pair in found.values() if len(pair) == 2]


def linear_seconds(row):
    """Set-up and solution of a linear system (s)."""
    return row["setup_seconds"] + row["solve_seconds"]


def markdown(heads, rows):
    """A table of Markdown; numbers to the right."""
    rule = ["---" if column == 0 else "---:" for column in range(len(heads))]
    return "\n".join("| " + " | ".join(row) + " |" for row in [heads, rule, *rows])


def count(number):
    """A large number with its thousands apart."""
    return f"{number:,}".replace(",", " ")


def scientific(number, digits=0):
    """A number with a power of ten, or a dash."""
    return "-" if number is None else f"{number:.{digits}e}"


def megabytes(row):
    """Peak memory of a row (MB)."""
    return row["peak_memory_bytes"] / 1e6


def run_table(summary):
    """Time and memory of whole runs."""
    heads = ["problem", "unknowns", "OpenGeoSys (s)", "Kluft (s)", "times faster"]
    heads += ["OpenGeoSys (MB)", "Kluft (MB)", "of its memory", "Newton, OpenGeoSys / Kluft", "runs"]
    rows = []
    for pair in summary.pairs():
        theirs, ours = pair["opengeosys"], pair["kluft"]
        rows.append(
            [
                ours["problem"],
                count(ours["unknowns"]),
                f"{theirs['seconds']:.2f}",
                f"{ours['seconds']:.2f}",
                f"{theirs['seconds'] / ours['seconds']:.1f}",
                f"{megabytes(theirs):.0f}",
                f"{megabytes(ours):.0f}",
                f"{megabytes(ours) / megabytes(theirs):.2f}",
                f"{theirs['newton']} / {ours['newton']}",
                f"{ours['runs']}",
            ]
        )
    return markdown(heads, rows)


def agreement_table(summary):
    """Apertures of both programs."""
    heads = ["problem", "unknowns", "smallest aperture, OpenGeoSys (m)", "Kluft (m)", "mean aperture, OpenGeoSys (m)"]
    heads += ["Kluft (m)", "largest difference", "opened, Gauss points in both"]
    rows = []
    for pair in summary.pairs():
        ours = pair["kluft"]
        agreed = summary.agreement.get((ours["problem"], ours["size"]), {})
        names = ("opengeosys_min", "kluft_min", "opengeosys_mean", "kluft_mean")
        differences = (scientific(agreed.get(name)) for name in ("difference", "opened_difference"))
        apertures = (scientific(agreed.get(name), 7) for name in names)
        rows.append([ours["problem"], count(ours["unknowns"]), *apertures, *differences])
    return markdown(heads, rows)


def linear_table(summary):
    """Time and memory of linear systems."""
    heads = ["solver", "unknowns", "set-up (s)", "solve (s)", "together (s)", "iterations", "memory (MB)", "runs"]
    rows = []
    for row in summary.linear:
        seconds = row["setup_seconds"], row["solve_seconds"], linear_seconds(row)
        times = (f"{value:.2f}" for value in seconds)
        iterations = str(row["iterations"] or "direct")
        rows.append(
            [
                NAMES[row["solver"]],
                count(row["unknowns"]),
                *times,
                iterations,
                f"{megabytes(row):.0f}",
                str(row["runs"]),
            ]
        )
    return markdown(heads, rows)


def processor():
    """Name of the processor."""
    names = [line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    return names[0].split(":")[1].strip() if names else platform.machine()


def csv_text(summary):
    """Whole runs and linear systems as one table; cells that say nothing are empty."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS.values())
    writer.writerows(csv_row(row) for row in summary.runs)
    for row in summary.linear:
        own = {"problem": "linear system", "program": row["solver"], "linear": row["iterations"]}
        writer.writerow(csv_row(row | own))
    return out.getvalue()


def csv_row(row):
    """The cells of a row."""
    cells = row | {"program": NAMES[row["program"]]}
    values = (cells.get(key) for key in COLUMNS)
    return [f"{value:.6g}" if isinstance(value, float) else value for value in values]


def wrapped(page):
    """A page with its prose at most 100 columns wide; tables, headings and pictures stay as they are."""

    def block(text):
        if text.startswith(("|", "#", "!")):
            return text
        items = text.split("\n- ")
        indent = "  " if text.startswith("- ") else ""
        options = {"width": 100, "break_long_words": False, "break_on_hyphens": False}
        return "\n- ".join(
            textwrap.fill(item, initial_indent="  " if number else "", subsequent_indent=indent, **options).removeprefix(
                "  " if number else ""
            )
            for number, item in enumerate(items)
        )

    return "\n\n".join(block(text) for text in page.rstrip("\n").split("\n\n")) + "\n"


def replace(path, text):
    """Writes a file under another name first."""
    new = path.with_name(path.name + ".new")
    new.write_text(text, encoding="utf-8")
    new.rename(path)


def write(summary, folder):
    """Writes both tables."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    text = TEXT.format(
        processor=processor(),
        cores=os.cpu_count(),
        memory=memory,
        bandwidth=summary.machine["bandwidth"] / 1e9,
        flop_rate=summary.machine["flop_rate"] / 1e9,
        runs=run_table(summary),
        agreement=agreement_table(summary),
        linear=linear_table(summary),
    )
    replace(folder / "peers.md", wrapped(text))
    replace(folder / "peers.csv", csv_text(summary))
