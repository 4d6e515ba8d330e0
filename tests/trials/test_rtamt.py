"""Margins of random formulas against rtamt, a monitor of signal temporal logic by others.

rtamt cuts windows at the end of the record. Ours are intervals there, which must contain its
value; elsewhere both are the same number.
"""

from __future__ import annotations

import random
import sys
import typing

import numpy as np
import pytest

from seatrial.trial.criteria.grammar import tree
from seatrial.trial.criteria.predicates import TINY, Record
from seatrial.trial.criteria.robustness import Evaluation

# Its parser imports a module that is leaving Python: the names are those of typing. It is not to be
# had for 3.13.
sys.modules.setdefault("typing.io", typing)
rtamt = pytest.importorskip("rtamt")

NAMES = ("x", "y", "z")
OPERATORS = (
    *("always", "eventually", "once", "historically", "until", "since"),
    *("finally", "not", "and", "or", "implies"),
)
CHEAP = 200
ALL = 10_000
BATCH = 250


def atom(draw: random.Random) -> tuple[str, str]:
    """Return a comparison in our language and in rtamt's, with the same margin."""
    name, operator = draw.choice(NAMES), draw.choice(["<", "<=", ">", ">="])
    if draw.random() < 0.3:
        other = draw.choice(NAMES)
        return f"a.{name} {operator} a.{other}", f"({name} {operator} {other})"
    bound = draw.choice([0.0, 0.25, 0.5, 1.0, 2.0])
    sign = draw.choice(["", "-"])
    scale = bound or 1.0
    ours = f"a.{name} {operator} {sign}{bound} m"
    return ours, f"(({name} / {scale}) {operator} ({sign}{bound / scale}))"


def interval(draw: random.Random) -> tuple[str, str]:
    if draw.random() < 0.25:
        return "", ""
    first = draw.randrange(0, 6)
    last = first + draw.randrange(0, 9)
    return f"[{first} s, {last} s]", f"[{first},{last}]"


def formula(draw: random.Random, depth: int) -> tuple[str, str]:
    """Return a random formula in our language and in rtamt's."""
    if depth == 0 or draw.random() < 0.15:
        return atom(draw)
    name = draw.choice(OPERATORS)
    (a, theirs_a), (ours, theirs) = formula(draw, depth - 1), interval(draw)
    if name in ("always", "eventually", "once", "historically"):
        return f"{name}{ours} ({a})", f"({name}{theirs} {theirs_a})"
    if name == "finally":  # it has no word for the last point
        return f"finally ({a})", f"(eventually (always {theirs_a}))"
    if name == "not":
        return f"not ({a})", f"(not {theirs_a})"
    b, theirs_b = formula(draw, depth - 1)
    if name in ("until", "since"):
        return f"(({a}) {name}{ours} ({b}))", f"({theirs_a} {name}{theirs} {theirs_b})"
    return f"(({a}) {name} ({b}))", f"({theirs_a} {name} {theirs_b})"


def theirs(text: str, signals: dict[str, np.ndarray], rows: int) -> np.ndarray:
    monitor = rtamt.StlDiscreteTimeSpecification()
    for name in NAMES:
        monitor.declare_var(name, "float")
    monitor.spec = text
    monitor.parse()
    dataset = {"time": list(range(rows)), **{n: signals[n].tolist() for n in NAMES}}
    return np.array([margin for _, margin in monitor.evaluate(dataset)])


def agree(seed: int) -> tuple[int, int]:
    """Compare one formula on one record; return how many rows were compared, and decided."""
    draw, numbers = random.Random(seed), np.random.default_rng(seed)
    rows = draw.randrange(2, 40)
    # Few different values, exact in binary: limits are often met exactly.
    signals = {name: numbers.integers(-16, 17, rows) / 8.0 for name in NAMES}
    ours, text = formula(draw, draw.randrange(1, 5))
    record = Record(np.arange(rows) * 1.0, {f"a.{n}": v for n, v in signals.items()})
    low, high = Evaluation(record).margins(tree(ours))
    expected = theirs(text, signals, rows)
    decided = low == high
    # A limit that is met exactly is the least margin there is here, and zero there.
    assert np.array_equal(np.where(abs(low) <= TINY, 0.0, low)[decided], expected[decided]), ours
    assert (low <= expected + TINY).all(), ours
    assert (expected <= high + TINY).all(), ours
    return rows, int(decided.sum())


@pytest.mark.slow
def test_margins_are_those_of_rtamt():
    rows, decided = np.sum([agree(seed) for seed in range(CHEAP)], axis=0)
    assert decided > 0.5 * rows  # else the comparison is about nothing


@pytest.mark.long
@pytest.mark.parametrize("batch", range(ALL // BATCH))
def test_margins_are_those_of_rtamt_in_all(batch):
    for seed in range(CHEAP + batch * BATCH, CHEAP + (batch + 1) * BATCH):
        agree(seed)
