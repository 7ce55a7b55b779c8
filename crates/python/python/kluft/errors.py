"""What can go wrong: wrong input, steps that do not converge, runs that are stopped."""

from __future__ import annotations

from typing import TYPE_CHECKING, Iterable, NamedTuple

if TYPE_CHECKING:
    from .run import Run


class Defect(NamedTuple):
    """Something wrong in an input."""

    place: str
    """Where it is: a line of the scene, a group, an element or a node by its tag."""
    problem: str
    """What is wrong there."""
    remedy: str
    """What can be done about it."""

    def __str__(self) -> str:
        return f"{self.place}: {self.problem}\n    remedy: {self.remedy}"


class InputError(ValueError):
    """The input is wrong; ``defects`` holds everything that is."""

    def __init__(self, defects: Iterable[tuple[str, str, str]]) -> None:
        self.defects = [Defect(*defect) for defect in defects]
        super().__init__("\n".join(map(str, self.defects)))

    def _repr_html_(self) -> str:
        from .tables import html

        return html([defect._asdict() for defect in self.defects])


class NotConverged(RuntimeError):
    """A load step did not converge; ``run`` holds those that did."""

    def __init__(self, why: str, step: int, reached: float, run: Run) -> None:
        self.step = step
        """Number of the load step, from 1."""
        self.reached = reached
        """Share of it that was solved, 0 to 1."""
        self.run = run
        """The run up to it."""
        super().__init__(why)


class Stopped(KeyboardInterrupt):
    """Ctrl-C stopped a run after an iteration; ``run`` holds the load steps that had converged."""

    def __init__(self, run: Run) -> None:
        self.run = run
        """The run up to there."""
        super().__init__()
