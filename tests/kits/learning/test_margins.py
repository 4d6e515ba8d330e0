"""Margins step by step are those of the whole record so far, which the criteria evaluate."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.trial.criteria.grammar import tree
from seatrial.trial.criteria.predicates import Record
from seatrial.trial.criteria.robustness import Evaluation
from seatrial_kits.learning.margins import Margins, is_of_past

FORMULAS = [
    "a.x > 0.2",
    "historically a.x > 0.2",
    "once[100 ms, 300 ms] a.x > 0.2",
    "once[200 ms, end] a.x > a.y",
    "historically[0 s, 200 ms] (a.x > 0 and not a.y < 0.1)",
    "a.x > 0 since a.y > 0.3",
    "a.x > 0 since[100 ms, 400 ms] a.y > 0.3",
    "a.x > 0 since[300 ms, end] (once[0 s, 100 ms] a.y > 0.3)",
    "a.x > 0.1 implies (a.y < 0.2 or historically[0 s, 100 ms] a.x < a.y)",
]
PERIOD = 0.1


@pytest.mark.parametrize("text", FORMULAS)
@settings(max_examples=20)
@given(data=st.data())
def test_margins_are_those_of_the_record_of_each_copy(text: str, data: Any) -> None:
    formula: Any = tree(text)
    assert is_of_past(formula)
    count, rows = 3, data.draw(st.integers(1, 12))
    draws = st.lists(st.floats(-1, 1), min_size=2 * count, max_size=2 * count)
    values = np.array([data.draw(draws) for _ in range(rows)]).reshape(rows, 2, count)
    starts = [data.draw(st.integers(0, rows - 1)) for _ in range(count)]
    margins, found = Margins(formula, count, PERIOD), np.zeros(count)
    for row in range(rows):
        begun = np.array([row == start for start in starts])
        now = Record(np.zeros(count), {"a.x": values[row, 0], "a.y": values[row, 1]})
        if row == 0:
            margins.start(np.ones(count, dtype=bool))
        old = ~begun
        found = np.where(old, margins.at(now, old), found) if old.any() else found
        margins.start(begun)
        found = np.where(begun, margins.at(now, begun), found) if begun.any() else found
    for copy, start in enumerate(starts):
        own = values[start:, :, copy]
        record = Record(np.arange(len(own)) * PERIOD, {"a.x": own[:, 0], "a.y": own[:, 1]})
        assert found[copy] == Evaluation(record).margins(formula)[0][-1]


@pytest.mark.parametrize(
    "text", ["always a.x > 0", "finally a.x > 0", "eventually a.x > 1", "rms(a.x) < 1"]
)
def test_a_look_ahead_is_no_margin_of_the_past(text: str) -> None:
    formula: Any = tree(text)
    assert not is_of_past(formula)


def test_an_interval_is_whole_decisions() -> None:
    formula: Any = tree("once[0 s, 250 ms] a.x > 0")
    with pytest.raises(InputError, match=r"0.25 s is not a whole number of decisions of 0.1 s"):
        Margins(formula, 1, PERIOD)
