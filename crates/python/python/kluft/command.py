"""The command ``kluft``: a script of that name, ``python -m kluft``, and the path of this file.

By its path it runs without the package, and so without numpy: this is how the program calls itself.
"""

import os
import signal
import sys

if __package__:
    from . import _kluft
else:
    import _kluft  # type: ignore[import-not-found,no-redef]


def own() -> tuple[str, str, str, str]:
    """How the program calls itself: interpreter, script, the file of its code; where its gmsh is."""
    tools = os.path.dirname(sys.executable)
    return sys.executable, os.path.abspath(__file__), os.path.abspath(_kluft.__file__), tools


def main() -> int:
    """Does what the command line says; returns the exit code."""
    # Ctrl-C ends the program at once: meanwhile nobody asks the interpreter for signals.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _kluft.main(["kluft", *sys.argv[1:]], own())


if __name__ == "__main__":
    sys.exit(main())
