"""A run: its load steps with their fields, its numbers, its history."""

from __future__ import annotations

import html as _html
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Callable, Protocol

import numpy as np

from . import tables
from .grid import Array, Grid
from .vtu import read_grid


class FractureResult:
    """What became of a fracture in a load step.

    Fields are arrays with a value (or a row) for each corner of each facet, facet by facet, and
    share their memory with the grid of all fractures wherever its facets stand side by side.
    """

    def __init__(self, name: str, numbers: dict[str, Any], grid: Grid, index: int) -> None:
        self.name = name
        self.numbers = numbers
        """Area, spreads of aperture, traction and slip, and more, as in ``summary.json``."""
        self._grid = grid
        self._index = index

    def _facets(self) -> slice | Array:
        return _places(np.flatnonzero(self._grid.cell_fields["fracture"] == self._index))

    def _points(self) -> slice | Array:
        facets, ends = self._facets(), self._grid.cells[1].astype(np.int64)
        starts = np.concatenate([[0], ends[:-1]])
        if isinstance(facets, slice):
            if facets.stop <= facets.start:
                return slice(0, 0)
            return slice(int(starts[facets.start]), int(ends[facets.stop - 1]))
        pairs = zip(starts[facets], ends[facets])
        return np.concatenate([np.arange(start, end) for start, end in pairs])

    def __getitem__(self, field: str) -> Array:
        """A field by its name, with a value or a row for each corner of the facets, or for each
        facet.

        Raises:
            KeyError: if there is no such field, with those that there are.
        """
        self._grid.require(field)
        if field in self._grid.point_fields:
            return self._grid.point_fields[field][self._points()]
        return self._grid.cell_fields[field][self._facets()]

    @property
    def points(self) -> Array:
        """Coordinates (m) of the corners of the facets."""
        return self._grid.points[self._points()]

    @property
    def aperture(self) -> Array:
        """Aperture (m)."""
        return self["aperture"]

    @property
    def opening(self) -> Array:
        """Normal part of the jump (m)."""
        return self["opening"]

    @property
    def jump(self) -> Array:
        """``u(plus) - u(minus)`` (m), a row of three for each corner."""
        return self["jump"]

    @property
    def slip(self) -> Array:
        """Tangential part of the jump (m), a row of three for each corner."""
        return self["slip"]

    @property
    def traction(self) -> Array:
        """Traction of the law (Pa), a row of three for each corner; tension is positive."""
        return self["traction"]

    @property
    def normal_traction(self) -> Array:
        """Normal part of the traction (Pa); tension is positive."""
        return self["normal_traction"]

    @property
    def state(self) -> Array:
        """0 open, 1 stuck, 2 slipping, 3 below the cutoff."""
        return self["state"]

    def __repr__(self) -> str:
        facets = int(np.count_nonzero(self._grid.cell_fields["fracture"] == self._index))
        return f"FractureResult({self.name!r}, {tables.count(facets, 'facet')})"


def _places(indices: Array) -> slice | Array:
    """Indices as a slice, if they follow one another: such parts of an array are no copies."""
    if len(indices) == 0:
        return slice(0, 0)
    first, last = int(indices[0]), int(indices[-1])
    return slice(first, last + 1) if last - first + 1 == len(indices) else indices


class Step:
    """A load step that has converged."""

    def __init__(
        self,
        number: int,
        numbers: dict[str, Any],
        fractures: dict[str, dict[str, Any]],
        grids: Callable[[bool], Grid],
    ) -> None:
        self.number = number
        """Its number, from 1."""
        self.numbers = numbers
        """How it was solved, as in ``summary.json``."""
        self._fractures = fractures
        self._grids = grids
        self._made: dict[bool, Grid] = {}

    def _grid(self, of_rock: bool) -> Grid:
        if of_rock not in self._made:
            self._made[of_rock] = self._grids(of_rock)
        return self._made[of_rock]

    @property
    def time(self) -> float:
        """Time at its end; the number of the step if the scene has no times."""
        return float(self.numbers["time"])

    @property
    def rock(self) -> Grid:
        """The rock, with one copy of a node for each of its sectors: displacement, stress."""
        return self._grid(True)

    @property
    def fracture_grid(self) -> Grid:
        """All fractures in one grid; each facet has points of its own."""
        return self._grid(False)

    @property
    def fractures(self) -> Mapping[str, FractureResult]:
        """The fractures by name."""
        grid = self.fracture_grid
        names = enumerate(self._fractures.items())
        return {name: FractureResult(name, own, grid, index) for index, (name, own) in names}

    def __repr__(self) -> str:
        return f"Step({self.number}, time {self.time:g})"


class Source(Protocol):
    """Where the results of a run are."""

    @property
    def summary(self) -> str: ...
    @property
    def history(self) -> str: ...
    def __len__(self) -> int: ...
    def numbers(self, index: int) -> tuple[str, list[tuple[str, str]]]: ...
    def grid(self, index: int, of_rock: bool) -> Grid: ...
    def save(self, folder: str | os.PathLike[str]) -> None: ...


class Run:
    """A run of a scene."""

    def __init__(self, source: Source, ending: str = "solved") -> None:
        self._source = source
        self.ending = ending
        """``solved``, ``stopped``, ``not converged``, or ``not finished`` in the folder of a run that
        goes on or was killed."""

    @property
    def summary(self) -> dict[str, Any]:
        """The numbers of the run, as in ``summary.json``."""
        return dict(json.loads(self._source.summary))

    @property
    def title(self) -> str:
        """The title of the scene."""
        return str(self.summary["title"])

    @property
    def decisions(self) -> list[str]:
        """What the program decided, and why."""
        return list(self.summary["decisions"])

    @property
    def warnings(self) -> list[str]:
        """What one should know about the results."""
        return list(self.summary["warnings"])

    @property
    def steps(self) -> list[Step]:
        """The load steps that have converged."""
        return [self._step(index) for index in range(len(self._source))]

    def _step(self, index: int) -> Step:
        numbers, fractures = self._source.numbers(index)
        own = {name: json.loads(text) for name, text in fractures}
        return Step(
            index + 1,
            json.loads(numbers),
            own,
            lambda of_rock: self._source.grid(index, of_rock),
        )

    @property
    def last(self) -> Step:
        """The last load step that has converged."""
        if len(self._source) == 0:
            raise LookupError("no load step has converged, or none was kept")
        return self._step(len(self._source) - 1)

    @property
    def fractures(self) -> Mapping[str, FractureResult]:
        """The fractures of the last load step by name."""
        return self.last.fractures

    @property
    def rock(self) -> Grid:
        """The rock of the last load step."""
        return self.last.rock

    @property
    def history_csv(self) -> str:
        """The text of ``history.csv``."""
        return self._source.history

    @property
    def history(self) -> Any:
        """How fractures, parts of the surface and blocks fare: a ``pandas.DataFrame`` with a row
        for each of them and each load step. The column ``kind`` says what a row is of."""
        return tables.frame_of_csv(self.history_csv)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Writes what ``kluft run`` writes: grids, ``summary.json``, ``history.csv``."""
        self._source.save(folder)
        return Path(folder)

    def plot(self, field: str = "aperture", **options: Any) -> Any:
        """Draws a field of the fractures with pyvista; ``options`` go to ``add_mesh``.

        Raises:
            KeyError: if there is no such field, with those that there are.
        """
        grid = self.last.fracture_grid
        grid.require(field)
        import pyvista

        plotter = pyvista.Plotter()
        plotter.add_mesh(grid.to_pyvista(), scalars=field, **options)
        return plotter.show()

    def __repr__(self) -> str:
        return f"Run({self.title!r}, {self._steps_in_words()}, {self.ending})"

    def _steps_in_words(self) -> str:
        return tables.count(len(self._source), "load step")

    def _repr_html_(self) -> str:
        rows = [
            {
                "fracture": name,
                "area (m2)": own["area"],
                "mean aperture (m)": own["aperture"]["mean"],
                "smallest": own["aperture"]["min"],
                "largest": own["aperture"]["max"],
                "mean normal traction (Pa)": own["normal_traction"]["mean"],
                "largest slip (m)": own["slip_max"],
            }
            for name, own in self.summary["fractures"].items()
        ]
        steps = self._steps_in_words()
        head = f"<p><b>{_html.escape(self.title)}</b>: {steps}, {self.ending}</p>"
        told = "".join(f"<li>{_html.escape(warning)}</li>" for warning in self.warnings)
        return head + tables.html(rows) + (f"<p>Warnings</p><ul>{told}</ul>" if told else "")


class FolderSource:
    """Results in a folder."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        file = self.folder / "summary.json"
        if not file.is_file():
            raise FileNotFoundError(f"{file} is not there: is this the folder of a run?")
        self.summary = file.read_text("utf-8")
        history = self.folder / "history.csv"
        self.history = history.read_text("utf-8") if history.is_file() else ""
        self._summary = json.loads(self.summary)
        self._written = sorted(self.folder.glob("rock_*.vtu"))

    def __len__(self) -> int:
        return len(self._written)

    def numbers(self, index: int) -> tuple[str, list[tuple[str, str]]]:
        """The numbers of a load step; of the last one, those of the fractures are all there."""
        is_last = index == len(self._written) - 1
        step = self._summary["steps"][index]
        fractures = self._summary["fractures"]
        known = fractures if is_last else step.get("fractures", {})
        own = [(name, json.dumps(known.get(name, {}))) for name in fractures]
        return json.dumps(step), own

    def grid(self, index: int, of_rock: bool) -> Grid:
        """The rock or the fractures of a load step."""
        kind = "rock" if of_rock else "fractures"
        return read_grid(self.folder / f"{kind}_{index + 1:04}.vtu")

    def save(self, folder: str | os.PathLike[str]) -> None:
        """They are in a folder already."""
        raise NotImplementedError(f"the files of this run are in {self.folder}: copy that folder")


def read(folder: str | os.PathLike[str]) -> Run:
    """The run that has written its results to a folder, by ``kluft run`` or :meth:`Run.save`."""
    source = FolderSource(folder)
    return Run(source, json.loads(source.summary)["ending"])
