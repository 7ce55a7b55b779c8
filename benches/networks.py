"""From a list of random fractures to results: how many networks are meshed and solved, how fast.

    python3 benches/networks.py [--fractures 100,300,1000,3000,10000] [--seeds N] [--threads N]
                                [--limit 900] [--program PATH] [--again] [--page PAGE]

The networks are those of `geometries/network-100` with other seeds, in cubes that keep their
density. Each takes `kluft network`, `kluft run`, and `kluft inspect` for its worst cell, which is
not timed. Unless --seeds says otherwise there are 20 of each number up to 1000 fractures, 3 up to
3000 and one beyond. A run that takes longer than --limit seconds is ended, and counts as failed.

Writes docs/performance/network-meshing.md, and each finished network at once into the .csv beside
it. What stands there is not measured again: an interrupted campaign goes on where it stopped. With
--again the networks asked for are removed from it first. The files of a network that failed stay in
target/network-meshing.
"""

import argparse
import csv
import json
import os
import re
import shutil
import signal
import statistics
import subprocess
import textwrap
import threading
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/performance/network-meshing.md"
WORK = ROOT / "target/network-meshing"
MODEL = ROOT / "geometries/network-100/network.toml"
CELL = 2.0
"""Size of the cells on fractures (m); away from them it is twice that."""
FIRST = "whole fractures"
"""The way to mesh that `kluft run` tries first, and does not name."""
KIND = 10
"""Characters of the kind of a line that `kluft run` prints."""
FIELDS = (
    "fractures",
    "seed",
    "threads",
    "gmsh",
    "seconds_to_geometry",
    "mended",
    "left_small",
    "meshed",
    "way",
    "failed_ways",
    "seconds_in_gmsh",
    "cells",
    "worst_cell",
    "unknowns",
    "solved",
    "seconds_of_run",
    "failure",
)


@dataclass
class Ended:
    """A program that has ended: exit code, none if it ran out of time, seconds, what it said."""

    code: int | None
    seconds: float
    printed: str
    errors: str


def end(process):
    """Ends a program and what it has started."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)


def run(options, folder, *arguments):
    """Runs the program, at most as long as the limit."""
    environment = os.environ | {"KLUFT_CACHE": "", "RAYON_NUM_THREADS": str(options.threads)}
    files = [folder / f"{arguments[0]}.{name}" for name in ("out", "err")]
    with files[0].open("w") as out, files[1].open("w") as err:
        start = time.perf_counter()
        command = [options.program, *arguments]
        streams = {"stdin": subprocess.DEVNULL, "stdout": out, "stderr": err}
        process = subprocess.Popen(command, **streams, env=environment, start_new_session=True)
        timer = threading.Timer(options.limit, end, [process])
        timer.start()
        try:
            code = process.wait()
        finally:
            timer.cancel()
            end(process)
    seconds = time.perf_counter() - start
    if code in (-signal.SIGTERM, -signal.SIGINT):
        raise SystemExit(f"{folder.name} was ended from outside: start again to go on with it")
    is_late = code == -signal.SIGKILL and seconds >= options.limit
    texts = [path.read_text(errors="replace") for path in files]
    return Ended(None if is_late else code, seconds, *texts)


def description(fractures, seed):
    """The model with another number of fractures at the same density, and coarse cells."""
    text = MODEL.read_text()
    side = 20 * (fractures / 100) ** (1 / 3)
    steep = round(0.35 * fractures)
    changes = {
        "seed = 4": f"seed = {seed}",
        "high = [20, 20, 20]": f"high = [{side:.6f}, {side:.6f}, {side:.6f}]",
        "h = 0.42": f"h = {2 * CELL}",
        "h_fracture = 0.22": f"h_fracture = {CELL}",
        "h_intersection = 0.2": f"h_intersection = {CELL}",
        "count = 35": f"count = {steep}",
        "count = 30": f"count = {fractures - 2 * steep}",
    }
    missing = [line for line in changes if f"\n{line}\n" not in text]
    if missing:
        raise SystemExit(f"{MODEL} does not hold {', '.join(missing)}")
    return "".join(changes.get(line.strip(), line) for line in re.split("(\n)", text))


def reason(ended, folder):
    """The first line that says why a program failed."""
    lines = (line.strip() for line in ended.errors.replace(f"{folder}/", "").splitlines())
    told = (line for line in lines if line and not re.fullmatch(r"\d+ defects? in the input", line))
    silent = f"signal {-ended.code}" if ended.code < 0 else f"exit code {ended.code}"
    return next(told, silent)


def to_geometry(options, folder, fractures, seed):
    """What becomes of the list."""
    given = folder / "network.toml"
    given.write_text(description(fractures, seed))
    ended = run(options, folder, "network", given, "-o", folder / "made", "-q")
    if ended.code is None:
        return {"failure": f"no geometry: stopped after {options.limit:.0f} s"}
    if ended.code:
        return {"failure": f"no geometry: {reason(ended, folder)}"}
    record = json.loads((folder / "made/network.json").read_text())
    return {
        "seconds_to_geometry": f"{ended.seconds:.3f}",
        "mended": sum(len(fracture["changes"]) for fracture in record["fractures"]),
        "left_small": len(record["small_features"]),
    }


def entries(printed):
    """The lines of a run, by kind and text."""
    return [(line[:KIND].strip(), line[KIND:].strip()) for line in printed.splitlines()]


def number(lines, kind, pattern):
    """A number in the last line of a kind; nothing if there is none."""
    found = [re.search(pattern, text) for of_line, text in lines if of_line == kind]
    found = [match.group(1) for match in found if match]
    return found[-1] if found else ""


def ways(lines):
    """The way in which a mesh was made, and the ways that failed before, with the reasons."""
    told = [text for kind, text in lines if kind == "gmsh"]
    for place, text in enumerate(told):
        _, is_other, way = text.partition("meshed in another way: ")
        if is_other:
            return way, "; ".join(told[:place])
    return FIRST, ""


def stopped(printed, limit):
    """Where a run was that ran out of time."""
    if all(kind != "meshed" for kind, _ in entries(printed)):
        return f"stopped after {limit:.0f} s in gmsh"
    last = " ".join(printed.strip().splitlines()[-1].split())
    return f"stopped after {limit:.0f} s; it printed last: {last}"


def to_results(options, folder):
    """What becomes of the geometry."""
    scene = folder / "made/scene.toml"
    ended = run(options, folder, "run", scene, "--out", folder / "out", "--verbose")
    printed = ended.printed.replace(f"{folder}/", "")
    lines = entries(printed)
    cells = number(lines, "read", r"(\d+) cells")
    way, failed_ways = ways(lines) if cells else ("", "")
    row = {
        "meshed": "yes" if cells else "no",
        "way": way,
        "failed_ways": failed_ways,
        "seconds_in_gmsh": number(lines, "meshed", r"\(([\d.]+) s\)$"),
        "cells": cells,
        "unknowns": number(lines, "enriched", r"(\d+) unknowns"),
        "solved": "no" if ended.code is None or ended.code else "yes",
        "seconds_of_run": f"{ended.seconds:.3f}",
    }
    if ended.code is None:
        row["failure"] = stopped(printed, options.limit)
    elif ended.code:
        row["failure"] = reason(ended, folder)
    return row


def worst_cell(options, folder):
    """The quality of the worst cell; nothing if the mesh cannot be inspected."""
    mesh = folder / "out/mesh.msh"
    ended = run(options, folder, "inspect", mesh, "--json", "--out", folder / "inspected")
    if ended.code != 0:
        return ""
    return f"{json.loads(ended.printed)['cells']['worst'][0]['quality']:.3e}"


def measure(options, fractures, seed):
    """All numbers of a network."""
    folder = WORK / f"{fractures}-{seed}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    row = dict.fromkeys(FIELDS, "") | {"meshed": "no", "solved": "no"}
    row |= {"fractures": fractures, "seed": seed}
    row |= {"threads": options.threads, "gmsh": options.gmsh}
    row |= to_geometry(options, folder, fractures, seed)
    if not row["failure"]:
        row |= to_results(options, folder)
    if row["meshed"] == "yes":
        row["worst_cell"] = worst_cell(options, folder)
    if not row["failure"]:
        shutil.rmtree(folder)
    return {name: str(value) for name, value in row.items()}


def key(row):
    """What a network is known by."""
    return int(row["fractures"]), int(row["seed"])


def read(table):
    """The networks measured so far."""
    if not table.exists():
        return {}
    with table.open(newline="") as file:
        return {key(row): row for row in csv.DictReader(file)}


def write_rows(table, rows, mode):
    """Writes rows to the table, or appends them with the mode `a`."""
    is_new = mode == "w" or not table.exists()
    with table.open(mode, newline="") as file:
        out = csv.DictWriter(file, FIELDS, lineterminator="\n")
        if is_new:
            out.writeheader()
        out.writerows(rows)


def values(rows, *names):
    """The sums of some columns, of the rows that have them all."""
    complete = [row for row in rows if all(row[name] for name in names)]
    return [sum(float(row[name]) for name in names) for row in complete]


def middle(found, digits=0):
    """A median; a dash if there is nothing."""
    return f"{statistics.median(found):.{digits}f}" if found else "-"


def spread(found):
    """The median and the largest of some seconds."""
    return f"{middle(found, 2)}, {max(found):.2f}" if found else "-"


def column(rows, used):
    """The entries of the table for the networks of one number of fractures."""
    meshed = [row for row in rows if row["meshed"] == "yes"]
    solved = [row for row in rows if row["solved"] == "yes"]
    worst = values(meshed, "worst_cell")
    share = lambda some: f"{len(some)} ({100 * len(some) / len(rows):.0f} %)"
    return {
        "networks": str(len(rows)),
        "meshed": share(meshed),
        **{f"by way of {way}": str(sum(row["way"] == way for row in meshed)) for way in used},
        "solved": share(solved),
        "seconds to the geometry": spread(values(rows, "seconds_to_geometry")),
        "seconds in gmsh": spread(values(meshed, "seconds_in_gmsh")),
        "seconds from the list to the results": spread(
            values(solved, "seconds_to_geometry", "seconds_of_run")
        ),
        "features mended": middle(values(rows, "mended")),
        "features left small": middle(values(rows, "left_small")),
        "worst cell": f"{min(worst):.1e}" if worst else "-",
        "cells": middle(values(meshed, "cells")),
        "unknowns": middle(values(meshed, "unknowns")),
    }


def table(rows):
    """A column for each number of fractures."""
    numbers = sorted({int(row["fractures"]) for row in rows})
    used = sorted({row["way"] for row in rows if row["way"]}, key=lambda way: (way != FIRST, way))
    of_number = ([row for row in rows if int(row["fractures"]) == count] for count in numbers)
    columns = [column(some, used) for some in of_number]
    lines = [
        "| fractures | " + " | ".join(map(str, numbers)) + " |",
        "|---|" + "---:|" * len(numbers),
    ]
    for name in columns[0]:
        lines.append(f"| {name} | " + " | ".join(column[name] for column in columns) + " |")
    return "\n".join(lines)


def wrapped(text, first="", indent=""):
    """Lines of at most 100 columns."""
    widths = {"width": 100, "break_long_words": False, "break_on_hyphens": False}
    return textwrap.fill(text, initial_indent=first, subsequent_indent=indent, **widths)


def listed(told):
    """A list of networks with what is told of each."""
    items = (f"{row['fractures']} fractures, seed {row['seed']}: {text}" for row, text in told)
    return "\n".join(wrapped(item, "- ", "  ") for item in items) or "None."


def failures(rows):
    """What failed, by name."""
    state = lambda row: "meshed, not solved" if row["meshed"] == "yes" else "not meshed"
    return listed((row, f"{state(row)}: {row['failure']}") for row in rows if row["failure"])


def other_ways(rows):
    """The networks that another way meshed than the first, with the reasons."""
    others = (row for row in rows if row["failed_ways"])
    return listed((row, f"{row['way']}; {row['failed_ways']}") for row in others)


def page(rows, name):
    """The page about all networks; `name` is that of the file of all numbers."""
    told = lambda field: " or ".join(sorted({row[field] for row in rows}))
    one = {row["threads"] for row in rows} == {"1"}
    before = f"""
        From a list of random fractures to results: networks as `geometries/network-100`, with other
        seeds, in cubes that keep its density, cells of {CELL:g} m on fractures and twice that away
        from them; gmsh {told("gmsh")} on one thread, Kluft on {told("threads")}
        thread{"" if one else "s"}. Nothing here is typed in: `python3 benches/networks.py` measures
        it and writes this page, and [{name}]({name}) has all numbers."""
    after = f"""
        Seconds are the median and the largest; those to the geometry are of `kluft network`, those
        in gmsh of all ways that were tried until one succeeded, in networks that were meshed, and
        those to the results of `kluft network` and `kluft run` together, in networks that were
        solved. `kluft run` tries one way to mesh after the other, {FIRST} first. A network counts
        as meshed once its mesh is read and found sound. Of features mended (corners and outlines
        that were moved), features that stay too small for the mesh, cells and unknowns the medians
        are given. The worst cell is that of all networks, by the quality that `kluft inspect`
        tells: 1 is regular, 0 is flat."""
    parts = (
        "# Meshing of random networks",
        wrapped(" ".join(before.split())),
        table(rows),
        wrapped(" ".join(after.split())),
        "## Failures",
        failures(rows),
        "## Meshed in another way than the first",
        other_ways(rows),
    )
    return "\n\n".join(parts) + "\n"


def seeds(options, fractures):
    """How many networks of a number of fractures are asked for."""
    usual = 20 if fractures <= 1000 else 3 if fractures <= 3000 else 1
    return options.seeds or usual


def tell(row):
    """Prints what came of a network."""
    shown = ("way", "seconds_to_geometry", "seconds_in_gmsh", "seconds_of_run", "unknowns")
    told = [f"{name} {row[name] or '-'}" for name in (*shown, "worst_cell")]
    print(f"{row['fractures']} fractures, seed {row['seed']}:", *told, row["failure"], flush=True)


def campaign(options):
    """Measures what is missing, and writes each network down at once."""
    kept = options.page.with_suffix(".csv")
    counts = options.fractures
    asked = [(count, seed) for count in counts for seed in range(1, seeds(options, count) + 1)]
    rows = read(kept)
    if options.again:
        rows = {known: row for known, row in rows.items() if known not in asked}
        write_rows(kept, rows.values(), "w")
    for fractures, seed in asked:
        if (fractures, seed) in rows:
            continue
        row = measure(options, fractures, seed)
        write_rows(kept, [row], "a")
        rows[key(row)] = row
        tell(row)
        write(options.page, rows)
    write(options.page, rows)


def write(path, rows):
    """Writes the page, if there is anything to say."""
    if rows:
        path.write_text(page([rows[known] for known in sorted(rows)], path.stem + ".csv"))


def version():
    """What gmsh says of itself."""
    gmsh = os.environ.get("KLUFT_GMSH") or "gmsh"
    done = subprocess.run([gmsh, "--version"], capture_output=True, text=True, check=True)
    return (done.stdout + done.stderr).strip()


def arguments():
    """The options."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    counts = lambda text: [int(part) for part in text.split(",")]
    parser.add_argument("--fractures", type=counts, default=[100, 300, 1000, 3000, 10000])
    parser.add_argument("--seeds", type=int, help="networks of each number of fractures")
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/kluft")
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="of Kluft")
    parser.add_argument("--limit", type=float, default=900, help="seconds a run may take")
    parser.add_argument("--again", action="store_true", help="measure again what is written down")
    parser.add_argument("--page", type=Path, default=PAGE, help="the page to write")
    options = parser.parse_args()
    if not options.program.exists():
        parser.error(f"there is no {options.program}; --program names another")
    return options


def main():
    """Measures and writes."""
    # What runs must end with this program, however it is ended.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    options = arguments()
    options.gmsh = version()
    options.program = options.program.resolve()
    campaign(options)


if __name__ == "__main__":
    main()
