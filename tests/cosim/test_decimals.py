"""Rows as `decimals.c` writes them are what Python's `repr` makes of their numbers."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from numpy.typing import NDArray

from seatrial.sim.compiled.decimals import rows_as_text
from seatrial.sim.compiled.library import library

pytestmark = pytest.mark.skipif(library() is None, reason="no compiler")


def _lines(numbers: NDArray[np.float64]) -> list[str]:
    text, ends = rows_as_text(numbers.reshape(-1, 1), [])
    assert [text[end - 1 : end] for end in ends.tolist()] == [b"\n"] * len(numbers)
    return text.decode().splitlines()


def test_any_double_is_written_as_repr_does() -> None:
    bits = np.random.default_rng(1).integers(0, 2**64, 100_000, np.uint64)
    numbers = bits.view(np.float64)
    assert _lines(numbers) == list(map(repr, numbers.tolist()))


def test_numbers_of_few_digits_and_their_neighbours() -> None:
    rng = np.random.default_rng(2)
    tens = 10.0 ** rng.integers(-12, 20, 30_000)
    few = np.round(rng.normal(size=30_000), 4) * tens
    numbers = np.concatenate([few, np.nextafter(few, 1.0), np.arange(-2000.0, 2000.0)])
    assert _lines(numbers) == list(map(repr, numbers.tolist()))


def test_powers_of_two_and_of_ten_and_what_is_next_to_them() -> None:
    powers = np.array(
        [2.0**i for i in range(-1074, 1024)] + [float(f"1e{i}") for i in range(-323, 309)]
    )
    beside = [np.nextafter(powers, towards) for towards in (0.0, np.inf)]
    numbers = np.concatenate([powers, *beside])
    assert _lines(numbers) == list(map(repr, numbers.tolist()))


def test_what_is_no_ordinary_number() -> None:
    numbers = [0.0, -0.0, np.inf, -np.inf, np.nan, 5e-324, sys.float_info.max, sys.float_info.min]
    assert _lines(np.array(numbers)) == list(map(repr, numbers))


def test_rows_of_whole_and_other_numbers() -> None:
    table = np.array([[0.1, 1.0, -2147483648.0], [-1e22, 0.0, 2147483647.0]])
    text, ends = rows_as_text(table, [1, 2])
    assert text == b"0.1,1,-2147483648\n-1e+22,0,2147483647\n"
    assert ends.tolist() == [18, len(text)]
