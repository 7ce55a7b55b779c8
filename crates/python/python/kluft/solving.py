"""How runs are started, followed and stopped."""

from __future__ import annotations

import os
import sys
import time
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
        self.first = (0, 0.0)
        """The step that was first, and when it began (s)."""
        self.is_open = False

    def __call__(self, event: dict[str, Any]) -> None:
        kind = event["event"]
        if kind == "step begins":
            self.begin(event["step"], event["steps"])
        text = {
            "stage begins": lambda: f"{self.step} {event['stage']}",
            "iteration": lambda: f"{self.step}, iteration {event['iteration']}, "
            f"residual {event['force_residual']:.1e}",
        }.get(kind)
        if text is not None:
            sys.stderr.write(f"\r{text().strip():<72}")
            sys.stderr.flush()
            self.is_open = True

    def begin(self, number: int, count: int) -> None:
        """Begins a step; a number that does not follow begins a run of its own."""
        now, (first, began) = time.monotonic(), self.first
        if not self.step or number <= first:
            self.first = first, began = number, now
        left = _left(now - began, number - first, count + 1 - number)
        self.step = f"step {number} of {count}{left}"

    def end(self) -> None:
        """Ends the line, if there is one."""
        if self.is_open:
            sys.stderr.write("\n")
        self.is_open = False


def _left(passed: float, done: int, steps: int) -> str:
    """How long the steps that are left take, if they are like those done in the seconds that have
    passed, in the words of the command; nothing before one is done, and for less than some
    seconds."""
    worth_saying = 5.0
    seconds = passed / done * steps if done else 0.0
    if seconds < worth_saying:
        return ""
    if seconds < 100.0:
        return f" (about {seconds:.0f} s left)"
    if seconds < 6000.0:
        return f" (about {seconds / 60.0:.0f} min left)"
    return f" (about {seconds / 3600.0:.1f} h left)"


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
