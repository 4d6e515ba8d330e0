"""Rows of numbers as text, by `decimals.c`: shortest digits as in [Giulietti2020]."""

from __future__ import annotations

import ctypes
from collections.abc import Collection
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .library import library

_POWERS = range(-292, 325)
"""Of ten, that doubles are multiplied with for their digits."""
_LONGEST = 25
"""Bytes of a number and what follows it."""


def rows_as_text(
    table: NDArray[np.float64], whole: Collection[int]
) -> tuple[bytes, NDArray[np.int64]]:
    """Return rows of numbers (n, m) as lines of CSV, and where each ends (n,).

    Numbers are written as `repr` does, those of the columns ``whole`` as that of an int. There is
    a `library`, as whoever asks has steps from it.
    """
    made, (rows, columns) = library(), table.shape
    assert made is not None
    table = np.ascontiguousarray(table)
    is_whole = np.isin(np.arange(columns), list(whole)).astype(np.uint8)
    text = np.empty(rows * columns * _LONGEST, np.uint8)
    ends = np.zeros(rows, np.int64)
    shape = ctypes.c_int64(rows), ctypes.c_int64(columns)
    arrays = [_at(each) for each in (is_whole, _powers(), text, ends)]
    made.rows_as_text(_at(table), *shape, *arrays)
    return text[: ends[-1] if rows else 0].tobytes(), ends


def _at(values: NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(values.ctypes.data)


@cache
def _powers() -> NDArray[np.uint64]:
    """Return the first 128 bits of powers of ten, upwards rounded, a row of two halves of each."""
    found = (_first_bits(power) for power in _POWERS)
    return np.array([(bits >> 64, bits & (1 << 64) - 1) for bits in found], np.uint64)


def _first_bits(power: int) -> int:
    if power < 0:
        divisor: int = 10**-power
        return -(-(1 << 127 + divisor.bit_length()) // divisor)
    number: int = 10**power
    shift = number.bit_length() - 128
    return -(-number >> shift) if shift > 0 else number << -shift
