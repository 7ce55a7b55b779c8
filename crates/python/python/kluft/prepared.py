"""A run whose rock stays prepared: each load step costs a solve for the jumps."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from . import _kluft
from .grid import Array, Grid
from .keys import Fracture
from .run import FractureResult, Run, Step
from .solving import MemorySource, Progress, followed, judge


class Source(Protocol):
    """A scene, as far as its laws may change."""

    def replace(self, **sections: Any) -> Source:
        """The same with other values."""

    def _parsed(self, needs_mesh: bool) -> _kluft.Scene:
        """As it is solved."""


class PreparedRun(Run):
    """A run that keeps the rock prepared, and solves the load steps that it is asked for.

    Load steps follow one another: each begins where the last one ended, so that friction remembers.
    As a context manager it gives the memory of the rock back at the end; results stay.
    """

    def __init__(self, scene: Source, prepared: _kluft.Prepared) -> None:
        super().__init__(MemorySource(prepared.results))
        self._scene = scene
        self._prepared = prepared
        self._own_pressures: set[str] = set()
        points = Grid(**prepared.points(), cells=prepared.cells)
        names = enumerate(prepared.fractures)
        self._facets = {name: FractureResult(name, {}, points, index) for index, name in names}
        self._pressures = np.zeros(len(points.points))

    @property
    def acting(self) -> list[str]:
        """What acts and may have a factor: boundaries with conditions, fractures with the pressure
        of the scene, fixed points, ``gravity``."""
        return self._prepared.acting

    def points(self, fracture: str) -> Array:
        """Coordinates (m) of the corners of the facets of a fracture, a row of three for each:
        where pressures are given and fields of results are.

        Raises:
            KeyError: if no fracture has this name.
        """
        _refuse_unknown([fracture], list(self._facets), "fracture")
        return self._facets[fracture].points

    def advance(
        self,
        load: float = 1.0,
        factors: Mapping[str, float] | None = None,
        *,
        fluid_pressure: Mapping[str, Any] | None = None,
        fracture: Mapping[str, Fracture | Mapping[str, Any]] | None = None,
        time: float | None = None,
        rock: bool = False,
        progress: bool | Progress | None = None,
    ) -> Step:
        """Solves a further load step.

        Args:
            load: Factor on everything that acts.
            factors: Other factors by the names of :attr:`acting`.
            fluid_pressure: Pressure on both walls (Pa), opening, by fracture: a number, or an array
                with one for each of :meth:`points`. It takes the place of the pressure that the
                scene gives, and stays until another one is given.
            fracture: Keys of fractures that change, as in the scene:
                ``{"fault": {"normal_stiffness": "20 GPa/m"}}``. They stay changed.
            time: Time at the end of the step, ascending; the number of the step if none is given.
            rock: Whether displacements and stresses of the rock are wanted too.
            progress: As in :meth:`Scene.solve`.

        Raises:
            InputError: if something given does not fit.
            KeyError: if nothing that acts, or no fracture, has a name that is given.
            ValueError: if there are not as many pressures as :meth:`points`.
            NotConverged: if the step does not converge; the run stays where it was.
            Stopped: after Ctrl-C; the run stays where it was.
        """
        own = self._own_pressures | set(fluid_pressure or {})
        pressures = self._pushed(fluid_pressure) if fluid_pressure else None
        all_factors = self._factors(load, factors or {}, own)
        changed = self._scene.replace(fracture=fracture) if fracture else None
        parsed = changed._parsed(needs_mesh=False) if changed is not None else None
        with followed(progress) as told:
            ending, why, reached, raised = self._prepared.advance(
                (time, all_factors), pressures, (parsed, rock), told
            )
        if changed is not None:
            self._scene = changed
        if ending == "solved" and pressures is not None:
            self._own_pressures, self._pressures = own, pressures
        number = len(self._source) + (ending != "solved")
        judge(self, ending, why, number, reached, raised)
        return self.last

    def _factors(self, load: float, factors: Mapping[str, float], own: set[str]) -> list[float]:
        """A factor for each that acts; ``own`` are the fractures whose pressures are given."""
        _refuse_unknown(factors, self.acting, "load")
        given = {**{name: 0.0 for name in own}, **factors}
        return [float(given.get(name, load)) for name in self.acting]

    def _pushed(self, given: Mapping[str, Any]) -> Array:
        """The pressures of all fractures (Pa) with those that are given."""
        _refuse_unknown(given, list(self._facets), "fracture")
        pressures = self._pressures.copy()
        for name, pressure in given.items():
            count, values = len(self.points(name)), np.asarray(pressure, np.float64)
            if values.size != 1 and values.shape != (count,):
                raise ValueError(
                    f"fluid_pressure of {name!r}: an array of shape {values.shape} for {count} "
                    f"points; give a number, or one for each of points({name!r})"
                )
            pressures[self._facets[name]._points()] = values
        return pressures

    def close(self) -> None:
        """Gives the memory of the rock back; results stay."""
        self._prepared.close()

    def __enter__(self) -> PreparedRun:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _refuse_unknown(names: Iterable[str], known: Sequence[str], kind: str) -> None:
    """Refuses names that nothing has.

    Raises:
        KeyError: with those that are known.
    """
    unknown = [name for name in names if name not in known]
    if unknown:
        raise KeyError(f"no {kind} is called {', '.join(unknown)}; there are: {', '.join(known)}")
