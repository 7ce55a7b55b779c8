"""Networks of fractures: from a table, or drawn at random, to a geometry and a scene that runs."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import tempfile
from pathlib import Path
from typing import Any, Iterable, Mapping

from . import _kluft, program, tables
from .errors import Defect, InputError
from .scene import Scene

_LISTED, _DESCRIBED = "listed.csv", "described.toml"
_FIRST_LINE = 2
"""Line of the first row of a list, behind the names of the columns."""


class Network:
    """A network whose geometry and scene are written."""

    def __init__(self, folder: str | os.PathLike[str], kept: Any = None) -> None:
        self.folder = Path(folder)
        # A folder of its own lasts as long as the network.
        self._kept = kept

    @property
    def scene(self) -> Scene:
        """The scene of the network, ready to be solved."""
        return Scene.read(self.folder / "scene.toml")

    @property
    def record(self) -> dict[str, Any]:
        """What became of every fracture, and the statistics of every set, as in ``network.json``."""
        return dict(json.loads((self.folder / "network.json").read_text("utf-8")))

    @property
    def fractures(self) -> Any:
        """The fractures in the domain, a ``pandas.DataFrame``."""
        return tables.frame(_flat(self.record["fractures"]))

    @property
    def sets(self) -> Any:
        """The sets: what was asked, drawn, and lies in the domain, a ``pandas.DataFrame``."""
        return tables.frame(_flat(self.record["sets"]))

    def __repr__(self) -> str:
        fractures = tables.count(len(self.record["fractures"]), "fracture")
        return f"Network({fractures} in {os.fspath(self.folder)!r})"

    def _repr_html_(self) -> str:
        return tables.html(_flat(self.record["fractures"]))


def _flat(rows: Any) -> list[dict[str, Any]]:
    """Rows of plain values: a dictionary, whose keys are names, or a list of them."""
    if isinstance(rows, Mapping):
        rows = [{"name": name, **row} for name, row in rows.items()]
    plain = (str, int, float, bool, type(None))
    return [{key: value for key, value in row.items() if isinstance(value, plain)} for row in rows]


def network(
    fractures: Any,
    *,
    out: str | os.PathLike[str] | None = None,
    domain: Iterable[float] | None = None,
    h: float | None = None,
    hydraulic_aperture: float | None = None,
) -> Network:
    """Makes a geometry and a scene from fractures.

    ``fractures`` is a table with a row for each (a ``pandas.DataFrame``, or a list of dictionaries,
    with the columns of lists: ``shape``, ``x``, ``y``, ``z``, ``dip``, ``dip_direction``, ``radius``
    and others), the path of such a list, or a dictionary or path of a description with random sets.
    ``domain`` is the box of rock, six coordinates (m), and ``h`` the size of cells (m) away from
    fractures. Without ``out`` the files go with the network.

    Raises:
        InputError: with every defect of the fractures. Rows of a table are counted from 0, as
            ``fractures[0]`` and ``DataFrame.iloc`` do.
    """
    kept = tempfile.TemporaryDirectory(prefix="kluft-network-") if out is None else None
    folder = Path(kept.name if kept else os.fspath(out or "")).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    given = _file(fractures, folder)
    arguments = ["network", os.fspath(given), "--out", os.fspath(folder), "--quiet"]
    if domain is not None:
        arguments.append("--domain=" + ",".join(f"{value:g}" for value in domain))
    if h is not None:
        arguments += ["--h", f"{h:g}"]
    if hydraulic_aperture is not None:
        arguments += ["--hydraulic-aperture", f"{hydraulic_aperture:g}"]
    try:
        program.run(arguments, folder)
    except InputError as error:
        raise InputError([_as_given(defect, folder) for defect in error.defects]) from None
    return Network(folder, kept)


def _as_given(defect: Defect, folder: Path) -> tuple[str, str, str]:
    """A defect with the rows that were given, in the place of lines of files written for them."""
    listed = re.escape(os.fspath(folder / _LISTED))
    described = os.fspath(folder / _DESCRIBED)

    def row(line: re.Match[str]) -> str:
        number = int(line.group(1)) - _FIRST_LINE
        return f"row {number}" if number >= 0 else "the columns"

    texts = (re.sub(rf"{listed}:(\d+)", row, text) for text in defect)
    place, problem, remedy = (text.replace(described, "the description") for text in texts)
    return place, problem, remedy


def _file(fractures: Any, folder: Path) -> Path:
    """The file that describes fractures, written if it is not there yet."""
    if isinstance(fractures, (str, os.PathLike)):
        return Path(fractures).absolute()
    if isinstance(fractures, Mapping):
        file = folder / _DESCRIBED
        file.write_text(_kluft.toml_of(json.dumps(fractures)), "utf-8")
        return file
    if hasattr(fractures, "to_dict"):
        fractures = fractures.to_dict("records")
    rows = [dict(row) for row in fractures]
    columns = list(dict.fromkeys(key for row in rows for key in row))
    text = io.StringIO()
    table = csv.DictWriter(text, columns, restval="")
    table.writeheader()
    table.writerows({key: _cell(value) for key, value in row.items()} for row in rows)
    file = folder / _LISTED
    file.write_text(text.getvalue(), "utf-8")
    return file


def _cell(value: Any) -> Any:
    """What is missing is empty."""
    return "" if value is None or value != value else value
