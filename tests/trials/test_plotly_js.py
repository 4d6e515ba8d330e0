"""Plotly's library in pages is in base 85, as Python's own module writes it."""

from __future__ import annotations

import base64

import pytest

from seatrial.trial.reports.plotly_js import _base85


@pytest.mark.parametrize("length", [0, 1, 2, 3, 4, 5, 10_001])
def test_base_85_is_that_of_python(length: int) -> None:
    data = bytes(i * i * 7 % 256 for i in range(length))
    assert _base85(data) == base64.b85encode(data)


def test_the_largest_and_the_least_words() -> None:
    data = b"\xff" * 8 + b"\0" * 8 + b"\xff\0" * 5
    assert _base85(data) == base64.b85encode(data)
