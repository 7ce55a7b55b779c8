"""Scenes: what is meshed, of what rock, cut by which fractures, under which loads."""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from . import _kluft
from .keys import SceneSections, Section
from .mesh import Mesh
from .command import own
from .prepared import PreparedRun
from .run import FolderSource, Run
from .solving import MemorySource, Progress, followed, judge

_IN_MEMORY = "mesh in memory"


class Scene(SceneSections):
    """A scene, made of keywords or read from a file.

    The keywords are the keys of a scene file, and sections are the classes of :mod:`kluft.keys` or
    dictionaries. Numbers are in SI units; a text has its unit with it: ``"60 GPa"``.
    """

    _text: str | None = None
    _name = "the scene"
    _folder = Path(".")

    @classmethod
    def read(cls, file: str | os.PathLike[str]) -> Scene:
        """Reads a scene file; paths in it are relative to its folder.

        Raises:
            InputError: with every defect of the file, each with its line.
        """
        path = Path(file)
        return cls.parse(_kluft.Scene.text(os.fspath(path)), str(path), path.parent)

    @classmethod
    def parse(
        cls, text: str, name: str = "the scene", folder: str | os.PathLike[str] = "."
    ) -> Scene:
        """Reads a scene from its text; ``name`` is for messages, ``folder`` is where paths start.

        Raises:
            InputError: with every defect of the text, each with its line.
        """
        scene = cls.__new__(cls)
        scene._text, scene._name, scene._folder = text, name, Path(folder)
        # A text that is no TOML is refused by its reader, which names every defect.
        scene.tables = _kluft.tables_of(text) or {}
        scene._parsed(needs_mesh=False)
        return scene

    def to_toml(self) -> str:
        """The scene as the text of a scene file."""
        return self._text if self._text is not None else _kluft.toml_of(_json(self.tables))

    def replace(self, **sections: Any) -> Scene:
        """The same scene with other values: ``replace(rock={"granite": {"density": 2700}})``.
        Tables are merged key by key, everything else is replaced."""
        scene = Scene.__new__(Scene)
        scene._name, scene._folder = self._name, self._folder
        scene.tables = _merged(self._plain(), _plain_tables(sections))
        return scene

    def check(self, mesh: Mesh | None = None) -> list[str]:
        """Checks the scene, and whether it fits a mesh; returns what is possible but hardly meant.

        Raises:
            InputError: with every defect.
        """
        scene = self._parsed(needs_mesh=False)
        if mesh is None:
            return scene.warnings
        return scene.warnings + scene.check(mesh._mesh)

    def solve(
        self,
        mesh: Mesh | None = None,
        *,
        threads: int | None = None,
        out: str | os.PathLike[str] | None = None,
        keep: bool = True,
        progress: bool | Progress | None = None,
    ) -> Run:
        """Solves all load steps, on a mesh in memory or on the one that the scene names.

        ``out`` names a folder that takes what ``kluft run`` writes; with ``keep=False`` results are
        not held in memory and read from there. ``progress=True`` tells on the error stream; a
        function gets each event as a dictionary, and stops the run by returning ``False``. Ctrl-C
        stops it after the iteration at hand.

        Raises:
            InputError: with every defect of scene and mesh.
            NotConverged: if a load step did not converge; it holds those that did.
            Stopped: after Ctrl-C, with the load steps that had converged.
        """
        if not keep and out is None:
            raise ValueError("keep=False needs a folder for the results: out=...")
        scene = self._parsed(needs_mesh=mesh is None)
        asked = (threads, None if out is None else os.fspath(out), keep, own())
        given = None if mesh is None else mesh._mesh
        with followed(progress) as told:
            ending, why, results, raised = _kluft.solve(scene, given, asked, told)
        run = Run(MemorySource(results), ending)
        if not keep and out is not None:
            run = Run(FolderSource(out), ending)
        steps = run.summary["steps"]
        reached = steps[-1]["completed"] if steps else 0.0
        judge(run, ending, why, len(steps), reached, raised)
        return run

    def prepare(
        self,
        mesh: Mesh | None = None,
        *,
        threads: int | None = None,
        progress: bool | Progress | None = None,
    ) -> PreparedRun:
        """Prepares the rock, and leaves the load steps to :meth:`PreparedRun.advance`.

        Raises:
            InputError: with every defect of scene and mesh.
        """
        scene = self._parsed(needs_mesh=mesh is None)
        given = None if mesh is None else mesh._mesh
        with followed(progress) as told:
            prepared = _kluft.Prepared(scene, given, (threads, own()), told)
        return PreparedRun(self, prepared)

    def _parsed(self, needs_mesh: bool) -> _kluft.Scene:
        """The scene as it is solved; a mesh in memory stands for one that is not named."""
        text = self.to_toml()
        tables = self._plain()
        mesh = tables.get("mesh", {})
        names_mesh = not isinstance(mesh, dict) or "file" in mesh or "geometry" in mesh
        if not names_mesh and not needs_mesh and tables:
            # An own text keeps its lines for messages: a table that is missing is put behind it.
            if self._text is not None and "mesh" not in tables:
                text = f'{text}\n[mesh]\nfile = "{_IN_MEMORY}"\n'
            else:
                tables["mesh"] = {**mesh, "file": _IN_MEMORY}
                text = _kluft.toml_of(json.dumps(tables))
        return _kluft.Scene.parse(text, self._name, os.fspath(self._folder))

    def _plain(self) -> dict[str, Any]:
        return _plain_tables(self.tables)

    def __repr__(self) -> str:
        return f"Scene({self.tables.get('title', 'untitled')!r})"


def _merged(old: Any, new: Any) -> Any:
    """A nested table with the values of another one."""
    if not (isinstance(old, Mapping) and isinstance(new, Mapping)):
        return copy.deepcopy(new)
    both = {key: _merged(value, new[key]) if key in new else value for key, value in old.items()}
    return {**both, **{key: value for key, value in new.items() if key not in old}}


def _json(tables: Any) -> str:
    return json.dumps(tables, default=_plain, allow_nan=False)


def _plain_tables(tables: Any) -> dict[str, Any]:
    """Nested tables of nothing but what JSON has words for."""
    return dict(json.loads(_json(tables)))


def _plain(value: Any) -> Any:
    """What JSON has no word for: sections, paths, numbers and arrays of numpy."""
    if isinstance(value, Section):
        return value.tables
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{value!r} cannot stand in a scene")
