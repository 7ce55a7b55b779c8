"""The page and the chart of the penny-shaped crack, from what was measured."""

import os

import chart
from report import NAMES, count, markdown, megabytes, processor, replace, wrapped

KINDS = {
    "linear": ("4 nodes", "^", "-"),
    "quadratic": ("10 nodes", "s", "--"),
    "quarter": ("10 nodes, quarter points", "o", "-"),
    "adaptive": ("adaptive, quarter points", "*", ":"),
}
"""Name, marker and dashes of the elements."""

ERRORS = {"centre": "centre opening", "volume": "volume", "intensity": "K_I"}

COLOURS = {"opengeosys": chart.VERMILION, "kluft": chart.BLUE}

TEXT = """# A penny-shaped crack: Kluft and OpenGeoSys

Written by `sh benches/peers/penny.sh`, with one build of each program, on {processor}, {cores}
cores, {memory:.0f} GB. Compare times within this page only. {note}

{summary}

![Error against seconds](penny-peers.svg)

## What is measured

A crack of radius 1 m in the middle of a cube of side 20 m
([geometries/penny](../../geometries/penny/penny.geo)), E = 25 GPa, nu = 0.25, under 2 MPa. Sneddon
(1946), for an unbounded rock: centre opening 1.909859e-4 m, volume 4.0e-4 m^3, K_I 2.256758 MPa
sqrt(m). Both programs pull top and bottom of the cube by 2 MPa and leave the crack free
(OpenGeoSys, which knows no free crack, with a stiffness of 1e-9 E over the radius): the openings
are those under pressure inside, which OpenGeoSys (process `SMALL_DEFORMATION_WITH_LIE`) does not
have. The adaptive runs of Kluft have the pressure inside.

- Nodes and cells are the same for both programs, except for the adaptive runs: there Kluft meshes
  by itself until its estimate of the error is below the tolerance (`adapt`, here {tolerances}).
- OpenGeoSys leaves the rim of a crack open, so its jumps there are set to zero by conditions. It
  does not know quarter points either: the script moves the nodes for it by hand. Kluft does both by
  itself; the rows of *10 nodes* have `quarter_points = false`.
- OpenGeoSys runs with the fastest of its solvers, as in [peers.md](peers.md), and integration order
  2 (on the coarsest mesh with quarter points order 3 took longer and was less accurate, and order 4
  did not start).
- Seconds are those of the whole process, without gmsh; for the adaptive runs those of all meshes.
  Runs below {short:g} s are made {rounds} times, and the median is given. Runs above {longest} s
  are given up.
- Errors are found in the same way for both, from the openings at the nodes of the facets: K_I from
  a line fitted to w^2 / d over the distance d from the rim, of the facets' mean openings w with d
  from 0.05 to 0.4 m, taken at d = 0: K_I = E' / 8 sqrt(2 pi w^2 / d), E' = E / (1 - nu^2). Means
  over facets cost accuracy: from exact openings this K_I is 3 % too low on the coarsest mesh of 4
  nodes, and 12 % on the coarsest of 10 nodes. In brackets the K_I that Kluft writes itself, with
  its own fit.

## Figures

{table}
"""


def percent(value, digits=2):
    """A relative error with its sign."""
    return f"{100.0 * value:+.{digits}f} %"


def between(values, digits):
    """The range of some ratios."""
    return f"{min(values):.{digits}f} to {max(values):.{digits}f}"


def pairs(records):
    """Records of both programs on the same mesh."""
    found = {}
    for record in records:
        found.setdefault((record["elements"], record["size"]), {})[record["program"]] = record
    return [pair for pair in found.values() if len(pair) == 2]


def best_of(records, program, where=""):
    """What tells the smallest error of the volume of a program."""
    best = min((record for record in records if record["program"] == program), key=lambda record: abs(record["volume"]))
    adapted = " on a mesh it made itself" if best["elements"] == "adaptive" else ""
    errors = ", ".join(f"{name} {percent(best[key])}" for key, name in ERRORS.items())
    return (
        f"{NAMES[program]} is best{where} with {count(best['unknowns'])} unknowns ({KINDS[best['elements']][0]}){adapted}: "
        f"{errors}, in {best['seconds']:.1f} s."
    )


def quickest(records, program, error):
    """The shortest time in which a program has an error of the volume below a bound."""
    fitting = [row["seconds"] for row in records if row["program"] == program and abs(row["volume"]) <= error]
    return f"{min(fitting):.1f} s" if fitting else "not reached"


def summary(records):
    """The results in words."""
    both = pairs(records)
    faster = [pair["opengeosys"]["seconds"] / pair["kluft"]["seconds"] for pair in both]
    lighter = [pair["kluft"]["peak_memory_bytes"] / pair["opengeosys"]["peak_memory_bytes"] for pair in both]
    lines = [
        f"**On the same mesh Kluft is {between(faster, 1)} times as fast as OpenGeoSys, "
        f"with {between(lighter, 2)} of its memory.**",
        *(best_of(records, program) for program in COLOURS),
        best_of([row for row in records if row["elements"] != "adaptive"], "kluft", " of the meshes of both"),
    ]
    reached = [
        f"{100 * error:g} %: Kluft {quickest(records, 'kluft', error)}, "
        f"OpenGeoSys {quickest(records, 'opengeosys', error)}"
        for error in (0.05, 0.02, 0.01)
    ]
    lines.append(f"Shortest runs with the volume within {'; '.join(reached)}.")
    largest = {pair["kluft"]["elements"]: pair for pair in sorted(both, key=lambda pair: pair["kluft"]["unknowns"])}
    said = "; ".join(
        f"{KINDS[kind][0]}, {percent(pair['opengeosys']['volume'], 4)} and {percent(pair['kluft']['volume'], 4)}"
        for kind, pair in largest.items()
    )
    lines.append(
        "On the same mesh both are about as accurate. Errors of the volume on the finest one, OpenGeoSys and Kluft: "
        f"{said}. What makes Kluft more accurate in the same time is its speed; and it needs no help to move nodes to quarter "
        "points, to close the rim, and to find the mesh."
    )
    return "\n\n".join(lines)


def table(records):
    """All measurements."""
    heads = ["elements", "program", "unknowns", "time (s)", "gmsh (s)", "memory (MB)", *ERRORS.values()]
    order = {kind: number for number, kind in enumerate(KINDS)}
    rows = []
    for record in sorted(records, key=lambda row: (order[row["elements"]], row["unknowns"], row["program"] == "kluft")):
        start = [KINDS[record["elements"]][0], NAMES[record["program"]], count(record["unknowns"])]
        if "failed" in record:
            rows.append([*start, "failed", *["-"] * 5])
            continue
        errors = [percent(record[key]) for key in ERRORS]
        if "own" in record:
            errors[-1] += f" ({percent(record['own']['stress_intensity'])})"
        meshing = record.get("meshing_seconds", 0.0)
        costs = [f"{record['seconds']:.2f}", f"{meshing:.1f}" if meshing else "-", f"{megabytes(record):.0f}"]
        rows.append([*start, *costs, *errors])
    return markdown(heads, rows)


def draw(records, path):
    """Error against seconds, a panel for each quantity."""
    plt = chart.plt
    with plt.rc_context({"svg.hashsalt": "penny", "font.size": 10, "axes.edgecolor": chart.GREY}):
        figure, panels = plt.subplots(1, 3, figsize=(13.5, 5.4), layout="constrained", sharex=True)
        for panel, (key, name) in zip(panels, ERRORS.items()):
            for program, colour in COLOURS.items():
                for kind, (label, marker, dashes) in KINDS.items():
                    rows = [row for row in records if (row["program"], row["elements"]) == (program, kind)]
                    points = sorted((row["seconds"], 100.0 * abs(row[key])) for row in rows)
                    if points:
                        style = {"color": colour, "marker": marker, "linestyle": dashes, "linewidth": 1.6}
                        panel.plot(*zip(*points), label=f"{NAMES[program]}, {label}", markersize=7, **style)
            panel.set(xscale="log", yscale="log", xlabel="time (s)", ylabel="error (%)", title=name)
            panel.grid(True, which="major", color="#d0d0d0", linewidth=0.7)
            for axis in (panel.xaxis, panel.yaxis):
                axis.set_major_locator(chart.LogLocator(subs=(1.0, 2.0, 5.0)))
                axis.set_major_formatter(chart.FuncFormatter(chart.plain))
                axis.set_minor_formatter(chart.NullFormatter())
            panel.tick_params(which="minor", length=0)
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
        chart.write(figure, path)
        plt.close(figure)


def write(records, folder, limits):
    """Writes page and chart; `limits` are times, rounds and tolerances of the measurement and a note, by name."""
    done = [record for record in records if "failed" not in record]
    text = TEXT.format(
        processor=processor(),
        cores=os.cpu_count(),
        memory=os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30,
        summary=summary(done),
        table=table(records),
        **limits,
    )
    replace(folder / "penny-peers.md", wrapped(text))
    draw(done, folder / "penny-peers.svg")
