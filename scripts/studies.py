"""Runs the studies of the scenes in geometries/ and writes their numbers into docs/verification.

    python scripts/studies.py [--kluft PROGRAM] [--from FOLDER] [NAME...]

Each scene with a section [study] is run by `kluft study` into FOLDER/NAME (target/studies by
default), where a study goes on that was interrupted. In docs/verification/studies `study.csv`
becomes NAME.csv, and the chart of the error over the unknowns NAME.svg if the page studies.md shows
it. Tables of that page are written again below comments that say what they show:

    <!-- table NAME: MEASURE... -->             a row for each setting
    <!-- worst NAME by DIMENSION: MEASURE... --> the largest of all settings with the same choice

A measure is a column of `study.csv` without the name of its fracture. NAME-nested is a study of the
scene in geometries/NAME on meshes that follow from one by dividing its cells.
"""

import argparse
import csv
import re
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/verification/studies.md"
FOLDER = PAGE.with_suffix("")
ROUNDING = 1e-9  # shares below it are written as powers of ten
NESTED = {
    "penny": (
        "h = 0.2, h_disc = 0.6, grow = 0.5",
        "refinements = [0, 1, 2]\nquarter_points = [true, false]",
    ),
    "sphere": ("h = 0.7", "refinements = [0, 1, 2, 3]\norders = [1, 2]"),
}
"""Parameters of the mesh whose cells are divided, and the study, by the folder of the scene."""


def nested(name, folder):
    """Writes the scene of a study on nested meshes, and returns its path."""
    parameters, study = NESTED[name]
    scene = ROOT / "geometries" / name / "scene.toml"
    text, _ = scene.read_text().split("\n[study]\n")
    text = text.replace('geometry = "', f'geometry = "{scene.parent}/')
    text = re.sub(r"parameters = \{[^}]*\}", f"parameters = {{ {parameters} }}", text)
    file = folder / f"{name}-nested.toml"
    folder.mkdir(parents=True, exist_ok=True)
    file.write_text(f"{text}\n[study]\n{study}\n")
    return file


def studies(folder):
    """Scenes of geometries/ with a section [study] by the names of their folders, and those with
    nested meshes."""
    scenes = sorted((ROOT / "geometries").glob("*/scene.toml"))
    scenes = {scene.parent.name: scene for scene in scenes if "\n[study]\n" in scene.read_text()}
    return scenes | {f"{name}-nested": nested(name, folder) for name in NESTED}


def run(program, name, scene, out):
    """Runs a study, or what is left of it."""
    subprocess.run([program, "study", scene, "--out", out, "--verbose"], check=True)
    shutil.copy(out / "study.csv", FOLDER / f"{name}.csv")
    if f"(studies/{name}.svg)" in PAGE.read_text():
        shutil.copy(out / "error-unknowns.svg", FOLDER / f"{name}.svg")


def read(name):
    """Dimensions that are swept, and the rows by column; fractures are left out of measures."""
    with (FOLDER / f"{name}.csv").open(newline="") as file:
        heads, *rows = csv.reader(file)
    first = heads.index("failed") + 1
    plain = [re.sub(r"^[\w-]+\.(?!exact|error)", "", head) for head in heads[first:]]
    rows = [dict(zip(heads[:first] + plain, row)) for row in rows]
    dimensions = heads[1 : heads.index("cells")]
    return [d for d in dimensions if len({row[d] for row in rows}) > 1], rows


def written(measure, text):
    """A number as the page has it."""
    if not text or not measure.endswith(".error"):
        return f"{float(text):.5e}" if "e" in text else text
    share = float(text)
    return f"{share:.0e}" if share < ROUNDING else f"{100 * share:.3g} %"


def lines(heads, rows):
    """A table in Markdown."""
    rule = ["---"] * len(heads)
    return ["| " + " | ".join(row) + " |" for row in [heads, rule, *rows]]


def headed(measures):
    """Heads of columns in words."""
    words = [measure.replace(".error", ", error").replace("_", " ") for measure in measures]
    swaps = {"max slip": "largest slip", " l2": " in L2", " max": " at most", "newton": "Newton"}
    for old, new in swaps.items():
        words = [word.replace(old, new) for word in words]
    return words


def table(name, measures):
    """A row for each setting; meshes of one series follow each other, as the scene lists them."""
    dimensions, rows = read(name)
    others = [d for d in dimensions if d != "mesh"]
    rows.sort(key=lambda row: ([row[d] for d in others], row["folder"]))
    cells = [
        [*(row[d] for d in dimensions), row["unknowns"], *(written(m, row[m]) for m in measures)]
        for row in rows
    ]
    return lines([*headed(dimensions), "unknowns", *headed(measures)], cells)


def worst(name, dimension, measures):
    """The largest of all settings with the same choice of a dimension."""
    _, rows = read(name)
    cells = []
    for choice in dict.fromkeys(row[dimension] for row in rows):
        own = [row for row in rows if row[dimension] == choice]
        most = [max((row[m] for row in own), key=lambda text: float(text or 0)) for m in measures]
        cells.append([choice, str(len(own)), *(written(m, t) for m, t in zip(measures, most))])
    return lines([dimension, "settings", *headed(measures)], cells)


def rewrite():
    """Writes the tables of the page again."""
    found = []
    kept = True
    for line in PAGE.read_text().splitlines():
        kept = kept or not line.startswith("|")
        if kept:
            found.append(line)
        marker = re.fullmatch(r"<!-- (table|worst) ([\w-]+)(?: by (\w+))?: (.*) -->", line)
        if marker:
            kind, name, dimension, measures = marker.groups()
            measures = measures.split()
            made = table(name, measures) if kind == "table" else worst(name, dimension, measures)
            found += made
            kept = False
    PAGE.write_text("\n".join(found) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kluft", default=ROOT / "target/release/kluft", help="the program")
    parser.add_argument("--from", dest="folder", type=Path, default=ROOT / "target/studies")
    parser.add_argument("names", nargs="*", help="the studies to run [default: all]")
    asked = parser.parse_args()
    FOLDER.mkdir(exist_ok=True)
    known = studies(asked.folder)
    for name in asked.names or known:
        run(asked.kluft, name, known[name], asked.folder / name)
    rewrite()


main()
