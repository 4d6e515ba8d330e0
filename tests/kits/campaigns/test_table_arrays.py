"""Columns of a table are those that pyarrow makes of the same values."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest

from seatrial_kits.campaigns.table_arrays import array_of

pyarrow = pytest.importorskip("pyarrow")

COLUMNS = [
    ("int64", [1, None, -(2**53) - 1, 2**62]),
    ("int64", [3, 4]),
    ("float64", [0.1, None, float("inf"), -0.0, 5]),
    ("float64", [None] * 9),
    ("bool_", [True, False, None, True, True, False, True, False, True]),
    ("string", ["a", "", None, "über", "x" * 300]),
    ("string", []),
]


@pytest.mark.parametrize(("kind", "values"), COLUMNS)
def test_an_array_is_that_of_pyarrow(kind: str, values: list[Any]) -> None:
    of = getattr(pyarrow, kind)()
    made = array_of(pyarrow, values, of)
    made.validate(full=True)
    expected = pyarrow.array(values, of)
    assert made.equals(expected)
    assert made.null_count == expected.null_count


def test_pandas_stays_away() -> None:
    program = (
        "import sys, pyarrow\n"
        "from seatrial_kits.campaigns.table_arrays import array_of\n"
        "for kind in ('int64', 'float64', 'bool_', 'string'):\n"
        "    array_of(pyarrow, [None], getattr(pyarrow, kind)())\n"
        "assert 'pandas' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
