"""The program ``kluft``, which the package brings with it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Sequence

from .errors import InputError

_VARIABLE = "KLUFT_PROGRAM"
"""Names another program to run instead."""


def find() -> str:
    """The file of the program: beside the interpreter, else on the search path.

    Raises:
        FileNotFoundError: if it is nowhere.
    """
    named = os.environ.get(_VARIABLE)
    if named:
        return named
    beside = Path(sys.executable).parent / "kluft"
    found = str(beside) if beside.is_file() else shutil.which("kluft")
    if not found:
        message = f"the program kluft is not found: install the wheel again, or name it in {_VARIABLE}"
        raise FileNotFoundError(message)
    return found


def run(arguments: Sequence[str], folder: Path) -> str:
    """Runs the program in a folder to its end and returns what it prints.

    Raises:
        InputError: if the input is wrong.
        RuntimeError: if it does not end well otherwise.
    """
    done = subprocess.run(
        [find(), *arguments],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        env=_environment(),
        check=False,
    )
    if done.returncode == 0:
        return done.stdout
    said = done.stderr.strip()
    if done.returncode == 2:
        raise InputError(_defects(said))
    raise RuntimeError(said or f"kluft ended with the code {done.returncode}")


def _environment() -> dict[str, str]:
    """That of this process; a gmsh beside the interpreter is found as in an activated environment."""
    folder = os.fspath(Path(sys.executable).parent)
    path = os.environ.get("PATH", os.defpath)
    return {**os.environ, "PATH": os.pathsep.join([folder, path])}


def _defects(said: str) -> list[tuple[str, str, str]]:
    """The defects that the program lists: a line of place and problem, and one of the remedy."""
    defects = []
    lines = said.splitlines()
    for line, after in zip(lines, lines[1:]):
        mark = "    remedy: "
        if after.startswith(mark):
            place, _, problem = line.partition(": ")
            defects.append((place, problem, after[len(mark) :]))
    return defects or [("kluft", said, "see the message")]
