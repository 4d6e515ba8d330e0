"""The table of everyday units against pint's registry."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.model.unit_table import _TABLE, known

PINT = {
    "kilogram": "kg", "meter": "m", "second": "s", "ampere": "A", "kelvin": "K", "radian": "rad"
}  # fmt: skip
LONG = {"%": "percent", "rev": "revolution"}
FACTORS = st.lists(
    st.tuples(st.sampled_from(sorted(_TABLE)), st.integers(-3, 3).filter(bool), st.booleans()),
    min_size=1,
    max_size=4,
)


@cache
def registry():
    return pint.UnitRegistry(non_int_type=Fraction)


def by_pint(factors):
    """Return factor and exponents of a product of (name, power, is divided by), by pint."""
    product = registry().Quantity(Fraction(1))
    for name, power, divided in factors:
        one = registry().Quantity(Fraction(1), LONG.get(name, name))
        product = product / one**power if divided else product * one**power
    base = product.to_base_units()
    powers = {PINT[name]: power for name, power in base.unit_items() if power}
    return base.magnitude, powers


@pytest.mark.parametrize("name", sorted(_TABLE))
def test_every_entry(name: str) -> None:
    assert known(name) == by_pint([(name, 1, False)])


@given(FACTORS)
def test_products(factors) -> None:
    factors = [(*factors[0][:2], False), *factors[1:]]
    text = "".join(
        f"{'/' if divided else '.'}{name}{'' if power == 1 else power}"
        for name, power, divided in factors
    )
    assert known(text[1:]) == by_pint(factors)


@pytest.mark.parametrize("text", ["1/s", "1/rad"])
def test_one_over(text: str) -> None:
    assert known(text) == by_pint([(text[2:], 1, True)])


@pytest.mark.parametrize("text", ["N.m/(rad.s)", "kN/(m/s)", "kg.m2/(s2.A)"])
def test_parentheses(text: str) -> None:
    above, below = text.rstrip(")").split("/(")
    whole = registry().Quantity(Fraction(1), f"({to_pint(above)})/({to_pint(below)})")
    base = whole.to_base_units()
    powers = {PINT[name]: power for name, power in base.unit_items()}
    assert known(text) == (base.magnitude, powers)


def to_pint(text):
    return text.replace(".", "*").replace("2", "**2")


@pytest.mark.parametrize(
    "text",
    ["/s", "m/", "m//s", "m.1", "m10", "m0", "N/(m)/(s)", "(N)", "N/()", "1/(s)", "kn", "m s"],
)
def test_what_is_left_to_the_registry(text: str) -> None:
    assert known(text) is None
