"""The program ``kluft``, which the package brings with it."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Sequence

from .command import own
from .errors import InputError


def run(arguments: Sequence[str], folder: Path) -> str:
    """Runs the program in a folder to its end and returns what it prints.

    Raises:
        InputError: if the input is wrong.
        RuntimeError: if it does not end well otherwise.
    """
    interpreter, script, *_ = own()
    done = subprocess.run(
        [interpreter, script, *arguments],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        check=False,
    )
    if done.returncode == 0:
        return done.stdout
    said = done.stderr.strip()
    if done.returncode == 2:
        raise InputError(_defects(said))
    raise RuntimeError(said or f"kluft ended with the code {done.returncode}")


def _defects(said: str) -> list[tuple[str, str, str]]:
    """The defects that the program lists: a line of place and problem, an excerpt that is indented,
    and a line of the remedy."""
    mark = "    remedy: "
    defects = []
    told = ""
    for line in said.splitlines():
        if line.startswith(mark):
            place, _, problem = told.partition(": ")
            defects.append((place, problem, line[len(mark) :]))
        elif not line.startswith(" "):
            told = line
    return defects or [("kluft", said, "see the message")]
