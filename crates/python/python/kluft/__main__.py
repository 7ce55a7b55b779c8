"""``python -m kluft`` is the command ``kluft``."""

import sys

from .command import main

sys.exit(main())
