"""How runs are started, followed and stopped."""

from __future__ import annotations

import os
import sys
from typing import Any, Callable

from . import _kluft
from .errors import NotConverged, Stopped
from .grid import Grid
from .run import Run

Progress = Callable[[dict[str, Any]], Any]


class MemorySource:
    """Results in memory."""

    def __init__(self, results: _kluft.Results) -> None:
        self._results = results

    @property
    def summary(self) -> str:
        return self._results.summary

    @property
    def history(self) -> str:
        return self._results.history

    def __len__(self) -> int:
        return len(self._results)

    def numbers(self, index: int) -> tuple[str, list[tuple[str, str]]]:
        return self._results.numbers(index)

    def grid(self, index: int, of_rock: bool) -> Grid:
        parts = self._results.grid(index, of_rock)
        return Grid(**parts, cells=lambda: self._results.cells(index, of_rock))

    def save(self, folder: str | os.PathLike[str]) -> None:
        self._results.save(folder)


def follower(progress: bool | Progress | None) -> Progress | None:
    """Who is told of a run: nobody, a line on the error stream, or a function."""
    if progress is True:
        return _Line()
    return progress or None


class _Line:
    """One line that is written again and again."""

    def __init__(self) -> None:
        self.step = ""

    def __call__(self, event: dict[str, Any]) -> None:
        kind = event["event"]
        if kind == "step begins":
            self.step = f"step {event['step']} of {event['steps']}"
        text = {
            "stage begins": lambda: f"{self.step} {event['stage']}",
            "iteration": lambda: f"{self.step}, iteration {event['iteration']}, "
            f"residual {event['force_residual']:.1e}",
        }.get(kind)
        if text is not None:
            sys.stderr.write(f"\r{text().strip():<72}")
            sys.stderr.flush()


def end(progress: Progress | None) -> None:
    """Leaves the line that progress was written to."""
    if isinstance(progress, _Line):
        sys.stderr.write("\n")


def judge(run: Run, ending: str, why: str, step: int, reached: float, raised: Any) -> None:
    """Raises what ended a run early.

    Raises:
        Stopped: after Ctrl-C.
        NotConverged: if a load step did not converge.
    """
    if isinstance(raised, KeyboardInterrupt):
        raise Stopped(run) from None
    if raised is not None:
        raise raised
    if ending == "not converged":
        raise NotConverged(why, step, reached, run)
