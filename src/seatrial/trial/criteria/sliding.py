"""Least and greatest values in windows of rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .expressions import FloatArray

Rows = NDArray[np.intp]


def least(values: FloatArray, starts: Rows, ends: Rows) -> FloatArray:
    """Return the least of ``values[start:end]`` for each pair; infinity of an empty window.

    Windows to the end, or from the beginning, take time in proportion to the rows; others rows
    times the logarithm of the longest window: by doubling, in a few passes of NumPy.
    """
    n = len(values)
    result = np.full(len(starts), np.inf)
    some = np.flatnonzero(starts < ends)
    starts, ends = starts[some], ends[some]
    if not len(some):
        return result
    if (ends == n).all():
        result[some] = np.minimum.accumulate(values[::-1])[::-1][starts]
    elif (starts == 0).all():
        result[some] = np.minimum.accumulate(values)[ends - 1]
    else:
        result[some] = _by_doubling(values, starts, ends)
    return result


def greatest(values: FloatArray, starts: Rows, ends: Rows) -> FloatArray:
    """Return the greatest of ``values[start:end]``; minus infinity of an empty window."""
    return -least(-values, starts, ends)


def _by_doubling(values: FloatArray, starts: Rows, ends: Rows) -> FloatArray:
    """Two windows of a power of two cover any other."""
    result = np.empty(len(starts))
    level = np.frexp((ends - starts).astype(float))[1] - 1
    of_power, width = values, 1
    for power in range(int(level.max()) + 1):
        here = level == power
        result[here] = np.minimum(of_power[starts[here]], of_power[ends[here] - width])
        of_power = np.minimum(of_power[:-width], of_power[width:])
        width *= 2
    return result


def until(first: FloatArray, second: FloatArray, starts: Rows, ends: Rows) -> FloatArray:
    """Return max over j in ``starts[i]:ends[i]`` of min(second[j], least of ``first[i:j]``).

    By ``a U[s, e] b = (b in [s, e] at some time) and (a till s, and then a U b)``, in one pass
    (Donzé, Ferrère, Maler 2013, Efficient robust monitoring for STL, lemma 2 and 3).
    """
    n = len(first)
    unbounded = np.empty(n + 1)
    value = unbounded[n] = -np.inf
    pairs = zip(reversed(first.tolist()), reversed(second.tolist()), strict=True)
    for row, (a, b) in zip(range(n - 1, -1, -1), pairs, strict=True):
        value = max(b, min(a, value))
        unbounded[row] = value
    begun = np.minimum(least(first, np.arange(n), starts), unbounded[starts])
    return np.minimum(begun, greatest(second, starts, ends))
