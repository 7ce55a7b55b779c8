"""How runs are started, followed and stopped."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
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


@contextmanager
def followed(progress: bool | Progress | None) -> Iterator[Progress | None]:
    """Who is told of a run: nobody, a line on the error stream, or a function. However the run
    ends, what is written next begins on a line of its own."""
    if progress is not True:
        yield progress or None
        return
    line = _Line()
    try:
        yield line
    finally:
        line.end()


class _Line:
    """One line that is written again and again."""

    def __init__(self) -> None:
        self.step = ""
        self.is_open = False

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
            self.is_open = True

    def end(self) -> None:
        """Ends the line, if there is one."""
        if self.is_open:
            sys.stderr.write("\n")
        self.is_open = False


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
