"""Arithmetic with units: numbers in SI with the powers of their base units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from ...errors import InputError
from ...model.units import Unit, conversion, unit

_Powers = Mapping[str, Fraction]
_FINEST = 1000
"""Greatest denominator of an exponent."""


@dataclass(frozen=True)
class Amount:
    """A number in SI, and the powers of the base units; a radian is a number."""

    value: float
    powers: _Powers

    def __add__(self, other: Amount) -> Amount:
        return self._alike(other, self.value + other.value)

    def __sub__(self, other: Amount) -> Amount:
        return self._alike(other, self.value - other.value)

    def __mul__(self, other: Amount) -> Amount:
        return self._times(other, 1, self.value * other.value)

    def __truediv__(self, other: Amount) -> Amount:
        if other.value == 0.0:
            raise InputError("it divides by 0")
        return self._times(other, -1, self.value / other.value)

    def __pow__(self, other: Amount) -> Amount:
        if other.powers:
            raise InputError(f"an exponent is a number, found one in {other.unit}")
        power = Fraction(other.value).limit_denominator(_FINEST)
        if self.powers and float(power) != other.value:
            raise InputError(f"{self.unit} to the power {other.value!r} is no unit")
        try:
            value = self.value**other.value
        except (OverflowError, ZeroDivisionError):
            value = math.inf
        if isinstance(value, complex):
            raise InputError(f"{self.value!r} has no real power {other.value!r}")
        return _finite(value, {base: n * power for base, n in self.powers.items() if power})

    def root(self) -> Amount:
        """Return the square root. Raises InputError for one of a negative number."""
        if self.value < 0.0:
            raise InputError(f"{self.value!r} has no square root")
        powers = {base: power / 2 for base, power in self.powers.items()}
        return Amount(math.sqrt(self.value), powers)

    def chosen(self, choose: Callable[[float, float], float], other: Amount) -> Amount:
        """Return what ``choose``, the larger say, takes of this and another of the same unit."""
        return self._alike(other, choose(self.value, other.value))

    @property
    def unit(self) -> str:
        """The SI unit, ``kg.m2/s2``, without radians."""
        above = [_power(base, n) for base, n in self.powers.items() if n > 0]
        below = [f"/{_power(base, -n)}" for base, n in self.powers.items() if n < 0]
        return (".".join(above) or "1") + "".join(below)

    def _alike(self, other: Amount, value: float) -> Amount:
        if self.powers != other.powers:
            raise InputError(f"{self.unit} and {other.unit} do not measure the same")
        return _finite(value, self.powers)

    def _times(self, other: Amount, sign: int, value: float) -> Amount:
        bases = {*self.powers, *other.powers}
        powers = {b: self.powers.get(b, 0) + sign * other.powers.get(b, 0) for b in bases}
        return _finite(value, {base: Fraction(n) for base, n in sorted(powers.items()) if n})


def _power(base: str, power: Fraction) -> str:
    return base if power == 1 else f"{base}{power}"


def _finite(value: float, powers: _Powers) -> Amount:
    if not math.isfinite(value):
        raise InputError("it is beyond the range of doubles")
    return Amount(value, powers)


def number(value: float) -> Amount:
    """Return a pure number. Raises InputError if it is not finite."""
    return _finite(value, {})


def amount(value: float, measure: str | Unit) -> Amount:
    """Return ``value`` in a unit as an amount. Raises InputError for what is no unit."""
    known = measure if isinstance(measure, Unit) else unit(measure)
    powers = {b: Fraction(n) for b, n in sorted(known.exponents.items()) if b != "rad"}
    return _finite(value * known.factor + known.offset, powers)


def dimension(text: str) -> Unit:
    """Return the unit of something computed, ``kg.m2/s2``: radians make no difference to it."""
    return replace(unit(text), by_name=False)


def in_unit(value: float, measure: str | Unit, target: str) -> float:
    """Return ``value`` in another unit. Raises InputError if they do not measure the same."""
    factor, offset = conversion(measure, target)
    return value if (factor, offset) == (1.0, 0.0) else value * factor + offset
