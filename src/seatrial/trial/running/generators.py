"""Global generators of random numbers: a run has them to itself, seeded."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

_NUMPY_SEEDS = 2**32


@contextmanager
def own_generators(seed: int) -> Iterator[None]:
    """Seed ``random`` and ``numpy.random`` for a run; behind it they go on where they were.

    A component should draw from ``self.noise`` (keyed by the run's seed and its name). One that
    draws from a generator of the whole process gives the same numbers in every run nevertheless.
    """
    before, numpy_before = random.getstate(), np.random.get_state()
    random.seed(seed)
    np.random.seed(seed % _NUMPY_SEEDS)
    try:
        yield
    finally:
        random.setstate(before)
        np.random.set_state(numpy_before)
