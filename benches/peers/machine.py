"""What the machine can do at most, measured with two threads; prints a line of JSON.

The environment must hold OPENBLAS_NUM_THREADS=2.
"""

import json
import time

import numpy as np
from scipy.linalg.blas import daxpy

ENTRIES = 40_000_000
"""Length of the vectors, far beyond any cache."""

ORDER = 4096
"""Rows and columns of the full matrices."""


def best(action, count):
    """The shortest of `count` runs (s)."""
    times = []
    for _ in range(count):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def bandwidth():
    """Bytes a second of y := a x + y: two vectors read, one written, 24 bytes an entry."""
    x, y = np.ones(ENTRIES), np.ones(ENTRIES)
    return 24.0 * ENTRIES / best(lambda: daxpy(x, y, a=1e-3), 10)


def flop_rate():
    """Floating-point operations a second of a product of full matrices."""
    a, b = np.ones((ORDER, ORDER)), np.ones((ORDER, ORDER))
    out = np.empty((ORDER, ORDER))
    return 2.0 * ORDER**3 / best(lambda: np.matmul(a, b, out=out), 3)


print(json.dumps({"bandwidth": bandwidth(), "flop_rate": flop_rate()}))
