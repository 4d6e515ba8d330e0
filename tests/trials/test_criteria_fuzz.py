"""Criteria from random text and random trees."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.trial.criteria.criteria import parse

UNITS = {"a.x": "m", "a.y": "m", "b-c.k.z": "1", "d.phi": "rad"}
VALUES = st.floats(allow_nan=True, allow_infinity=True, width=64)
VOCABULARY = """
    always finally eventually until since once historically implies
    says is [ ] end "x" within settles after to and or not abs max min sqrt ( ) , + - * / < <= >
    >= a.x a.y b-c.k.z d.phi e.none 1 0.5 .5 1e3 m deg m/s % s ms kg.m2 rad ° 5 s 4 s 10 deg
    nan inf __import__ lambda ; ' " \\ é ٣ 1e999 m9
"""
WORDS = st.sampled_from(VOCABULARY.split())


def never_another_error(text, time, signals):
    with contextlib.suppress(InputError):
        criterion = parse(text)
        criterion.check_units(UNITS)
        verdict = criterion.evaluate(time, signals, UNITS)
        assert verdict.detail
        assert isinstance(verdict.passed, bool)
        if not all(np.isfinite(signals[name]).all() for name in criterion.signals):
            assert not verdict.passed


@st.composite
def records(draw):
    rows = draw(st.integers(0, 6))
    columns = {name: st.lists(VALUES, min_size=rows, max_size=rows) for name in UNITS}
    signals = {name: np.array(draw(column)) for name, column in columns.items()}
    return np.arange(rows) * 1.0, signals


@given(st.text(max_size=60), records())
def test_any_text(text, record):
    never_another_error(text, *record)


@given(st.lists(WORDS, max_size=14).map(" ".join), records())
def test_any_words(text, record):
    never_another_error(text, *record)


# ---------------------------------------------------------------------- well-formed criteria

LITERALS = st.floats(1e-3, 1e3).map(lambda v: (f"{v!r} m", v))
LENGTHS = st.one_of(
    st.sampled_from([("a.x", "a.x"), ("a.y", "a.y")]),
    LITERALS,
)


def _grown(inner):
    """Return pairs of a criterion's text and what it means, as text for numpy or a number."""
    two = st.tuples(inner, inner)
    return st.one_of(
        two.map(lambda p: (f"{p[0][0]} + ({p[1][0]})", ("+", p[0][1], p[1][1]))),
        two.map(lambda p: (f"{p[0][0]} - ({p[1][0]})", ("-", p[0][1], p[1][1]))),
        two.map(lambda p: (f"max({p[0][0]}, {p[1][0]})", ("max", p[0][1], p[1][1]))),
        two.map(lambda p: (f"min({p[0][0]}, {p[1][0]})", ("min", p[0][1], p[1][1]))),
        two.map(lambda p: (f"sqrt(({p[0][0]}) * ({p[1][0]}))", ("root", p[0][1], p[1][1]))),
        two.map(lambda p: (f"({p[0][0]}) / ({p[1][0]}) * 1 m", ("/", p[0][1], p[1][1]))),
        inner.map(lambda p: (f"-({p[0]})", ("negative", p[1]))),
        inner.map(lambda p: (f"abs({p[0]})", ("abs", p[1]))),
    )


MEANING = {
    "+": np.add,
    "-": np.subtract,
    "max": np.maximum,
    "min": np.minimum,
    "root": lambda a, b: np.sqrt(np.multiply(a, b)),
    "/": np.divide,
    "negative": np.negative,
    "abs": np.abs,
}
TREES = st.recursive(LENGTHS, _grown, max_leaves=8)


def meaning(tree, signals):
    if isinstance(tree, str):
        return signals[tree]
    if isinstance(tree, float):
        return tree
    name, *arguments = tree
    return MEANING[name](*[meaning(a, signals) for a in arguments])


ROWS = st.lists(st.floats(-100, 100), min_size=4, max_size=4).map(np.array)


@pytest.mark.slow
@given(TREES, st.sampled_from(["<", "<=", ">", ">="]), ROWS, ROWS, st.floats(-100, 100))
def test_arithmetic_is_numpys(tree, operator, x, y, bound):
    text, tree = tree
    signals = {"a.x": x, "a.y": y}
    sign = "-" if bound < 0 else ""
    criterion = parse(f"{text} {operator} {sign}{abs(bound)!r} m and a.x < 1e6 m")
    with np.errstate(all="ignore"):
        course = np.broadcast_to(meaning(tree, signals), x.shape)
        compare = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal}
        expected = bool(np.isfinite(course).all() and compare[operator](course, bound).all())
    units = {"a.x": "m", "a.y": "m"}
    assert criterion.evaluate(np.arange(4.0), signals, units).passed is expected


@given(TREES)
def test_the_unit_is_that_of_the_tree(tree):
    text, _ = tree
    units = {"a.x": "m", "a.y": "m"}
    parse(f"{text} < a.x").check_units(units)
    with pytest.raises(InputError, match="'m'"):
        parse(f"{text} < a.x * 1 m").check_units(units)
