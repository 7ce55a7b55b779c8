"""The chart of the comparison: time and memory against unknowns, of whole runs and of linear systems."""

from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402

# Colours of Okabe and Ito, which colour-blind readers tell apart; on a white card, legible on any page.
BLUE, SKY, VERMILION, GREEN, PURPLE, BLACK = "#0072B2", "#56B4E9", "#D55E00", "#009E73", "#CC79A7", "#000000"
GREY = "#666666"

PROGRAMS = {"opengeosys": ("OpenGeoSys", VERMILION), "kluft": ("Kluft", BLUE)}
PROBLEMS = {"cut, hex": ("s", "-"), "cut, tet": ("^", "--"), "disc, tet": ("o", "-.")}
SOLVERS = {
    "mumps": ("MUMPS", PURPLE, "D"),
    "cholmod": ("CHOLMOD", BLACK, "P"),
    "pardiso": ("PARDISO", VERMILION, "X"),
    "cholesky": ("Kluft Cholesky", BLUE, "s"),
    "gamg": ("PETSc GAMG", GREEN, "v"),
    "multigrid": ("Kluft multigrid", SKY, "o"),
}

PRODUCTS = 100
"""Matrix-vector products of a guide line: few for an iterative solver."""

ENTRIES = 45
"""Entries in a row of the matrix: a node in a mesh of tetrahedra has 14 neighbours."""

ENTRY_BYTES, ROW_BYTES = 12, 28
"""Bytes of the matrix for an entry, and for a row with the entries of both vectors."""


def draw(summary, path):
    """Draws the chart and writes it as SVG; the same measurements give the same file."""
    settings = {"svg.hashsalt": "peers", "font.size": 10, "axes.edgecolor": GREY, "axes.titleweight": "bold"}
    with plt.rc_context(settings):
        figure, panels = plt.subplots(2, 2, figsize=(12.5, 9), layout="constrained", sharex="row")
        figure.get_layout_engine().set(w_pad=0.12, h_pad=0.15)
        draw_row(panels[0], "Whole runs", run_lines(summary))
        draw_guides(panels[0], summary, summary.run_operations)
        draw_row(panels[1], "One linear system", linear_lines(summary))
        draw_guides(panels[1], summary, summary.linear_operations)
        for row in panels:
            row[1].legend(
                *row[0].get_legend_handles_labels(), loc="center left", bbox_to_anchor=(1.02, 0.5), frameon=False
            )
        write(figure, Path(path))
        plt.close(figure)


def write(figure, path):
    """Writes the figure under another name first."""
    new = path.with_name(path.name + ".new")
    figure.savefig(new, format="svg", facecolor="white", metadata={"Date": None})
    new.rename(path)


def run_lines(summary):
    """Label, style and points (unknowns, s, bytes) of every program and problem."""
    for program, (name, colour) in PROGRAMS.items():
        for problem, (marker, dashes) in PROBLEMS.items():
            rows = [row for row in summary.runs if (row["program"], row["problem"]) == (program, problem)]
            points = [(row["unknowns"], row["seconds"], row["peak_memory_bytes"]) for row in rows]
            yield f"{name}, {problem}", {"color": colour, "marker": marker, "linestyle": dashes}, points


def linear_lines(summary):
    """Label, style and points (unknowns, s, bytes) of every solver."""
    for solver, (name, colour, marker) in SOLVERS.items():
        rows = [row for row in summary.linear if row["solver"] == solver]
        points = [
            (row["unknowns"], row["setup_seconds"] + row["solve_seconds"], row["peak_memory_bytes"]) for row in rows
        ]
        yield name, {"color": colour, "marker": marker}, points


def draw_row(panels, title, lines):
    """Time and memory of one kind of measurement."""
    for label, style, points in lines:
        if points:
            unknowns, seconds, size = np.array(sorted(points)).T
            for panel, values in zip(panels, (seconds, size / 1e9)):
                panel.plot(unknowns, values, label=label, markersize=6, linewidth=1.6, zorder=3, **style)
    for panel, what, unit in zip(panels, ("time", "peak memory"), ("s", "GB")):
        panel.set(xscale="log", yscale="log", xlabel="unknowns", ylabel=f"{what} ({unit})", title=f"{title}: {what}")
        panel.grid(True, which="major", color="#d0d0d0", linewidth=0.7)
        for axis in (panel.xaxis, panel.yaxis):
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(plain))
            axis.set_minor_formatter(NullFormatter())
        panel.tick_params(which="minor", length=0)


def plain(value, _):
    """A number on an axis as people write it."""
    for unit, name in ((1e6, " million"), (1e3, " 000")):
        if value >= unit:
            return f"{value / unit:g}{name}"
    return f"{value:g}"


def draw_guides(panels, summary, operations):
    """What the machine allows at best: some products of the matrix, one factorisation; and the matrix alone."""
    time, memory = panels
    low, high = time.get_xlim()
    unknowns = np.geomspace(low, high, 50)
    traffic = unknowns * (ENTRIES * ENTRY_BYTES + ROW_BYTES)
    bandwidth, rate = summary.machine["bandwidth"], summary.machine["flop_rate"]
    if operations:
        known = np.array(sorted(operations))
        seconds = np.array([operations[at] for at in known]) / rate
        label = f"one factorisation\nat {rate / 1e9:.0f} Gflop/s"
        time.plot(*extended(known, seconds, low, high), label=label, color=GREY, linewidth=1.2, linestyle=(0, (5, 3)))
    label = f"{PRODUCTS} products of the matrix\nat {bandwidth / 1e9:.0f} GB/s;\nmemory: the matrix alone"
    style = {"color": GREY, "linewidth": 1.4, "linestyle": (0, (1, 1.5))}
    time.plot(unknowns, PRODUCTS * traffic / bandwidth, label=label, **style)
    memory.plot(unknowns, unknowns * ENTRIES * ENTRY_BYTES / 1e9, **style)
    time.set_xlim(low, high)


def extended(unknowns, seconds, low, high):
    """The line through the points, continued to both ends with the square of the unknowns."""
    ends = seconds[0] * (low / unknowns[0]) ** 2, seconds[-1] * (high / unknowns[-1]) ** 2
    return np.concatenate([[low], unknowns, [high]]), np.concatenate([ends[:1], seconds, ends[1:]])
