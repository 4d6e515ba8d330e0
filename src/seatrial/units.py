"""Units as FMI writes them (``N.m``, ``kg.m2``, ``rad/s``) and as a person does (``10 deg``)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any

from .errors import InputError

# FMI 2.0's base units, in the order of its BaseUnit element, with pint's names for them.
_BASE = {
    "kg": "kilogram",
    "m": "meter",
    "s": "second",
    "A": "ampere",
    "K": "kelvin",
    "mol": "mole",
    "cd": "candela",
    "rad": "radian",
}
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$", re.DOTALL)
# What pint would take for a product (a stray sign), for the elementary charge (the e of 1e3) or
# for a number with more digits than the memory holds (a power of a power).
_MISTAKEN = re.compile(
    r"[^\w *./^()+°′″‰⁻-]|(?<!\d)\.|\.(?!\d)|(?<![A-Za-z])[\d.]+[eE]"
    r"|\d{3}|(\^|\*\*)[-+(]*\d+\)*(\^|\*\*)"
)


@dataclass(frozen=True)
class Unit:
    """A unit as FMI's UnitDefinitions has it: SI value = factor * value + offset."""

    text: str
    exact_factor: Fraction
    exact_offset: Fraction
    exponents: dict[str, int]
    """Exponent of each base unit that occurs; radian counts as one."""

    @property
    def factor(self) -> float:
        """The double nearest to the factor."""
        return float(self.exact_factor)

    @property
    def offset(self) -> float:
        """The double nearest to the offset."""
        return float(self.exact_offset)


@cache
def _registry() -> Any:
    import pint

    # In pint a radian has no dimension, but it is a base unit, as in FMI: its exponent is what
    # tells an angle from a count on a wire.
    registry: Any = pint.UnitRegistry(cache_folder=None, non_int_type=Fraction)
    registry.define("@alias degree = °")
    registry.define("@alias revolution = rev")
    return registry


@lru_cache(maxsize=1024)
def unit(text: str) -> Unit:
    """Return the unit written ``text``: FMI style (``kg.m2/s``), pint style, ``1`` or ``%``.

    Raises InputError if it is not a unit, or not a linear one (dB).
    """
    registry = _registry()
    if text.strip() in ("", "1"):
        return Unit("1", Fraction(1), Fraction(0), {})
    try:
        parsed = registry.Unit(_to_pint(text))
        # Logarithmic units fail here, for a fraction has no logarithm.
        zero, one = (registry.Quantity(Fraction(k), parsed).to_base_units() for k in (0, 1))
        if not float(one.magnitude - zero.magnitude) > 0.0:
            raise ValueError("beyond the range of doubles")
    except Exception:
        raise InputError(f"{text!r} is not a unit (examples: N.m, kg.m2, rad/s, deg, ms)") from None
    names = {long: short for short, long in _BASE.items()}
    exponents: dict[str, int] = {}
    for name, power in one.unit_items():
        if name not in names or power != int(power):
            raise InputError(f"unit {text!r} cannot be written in FMI's base units")
        exponents[names[name]] = int(power)
    return Unit(text, one.magnitude - zero.magnitude, zero.magnitude, exponents)


def conversion(source: str, target: str) -> tuple[float, float]:
    """Return (factor, offset) with target value = factor * source value + offset.

    Raises InputError if the two do not measure the same thing.
    """
    factor, offset = _exact_conversion(source, target)
    return float(factor), float(offset)


def _exact_conversion(source: str, target: str) -> tuple[Fraction, Fraction]:
    a, b = unit(source), unit(target)
    if a.exponents != b.exponents:
        raise InputError(f"unit {source!r} cannot be converted to {target!r}")
    return a.exact_factor / b.exact_factor, (a.exact_offset - b.exact_offset) / b.exact_factor


def quantity(text: str | float | int, target: str) -> float:
    """Return what ``text`` says (``"10 deg"``, or a bare number already in ``target``).

    The result is the double nearest to what is written. Raises InputError if it is not a
    finite number with a unit that converts to ``target``.
    """
    if isinstance(text, bool) or not isinstance(text, (str, int, float)):
        raise InputError(f"{text!r} is not a quantity such as '10 {target}'")
    try:
        value = _written(text, target) if isinstance(text, str) else float(text)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise InputError(f"{text!r} is not a finite number")
    return value


def _written(text: str, target: str) -> float:
    match = _NUMBER.match(text)
    if match is None:
        raise InputError(f"{text!r} is not a quantity such as '10 {target}'")
    digits, written = match.groups()
    number = float(digits)
    if not written:
        if unit(target).exponents:
            raise InputError(f"{text!r} has no unit; write for example '{number:g} {target}'")
        return number
    factor, offset = _exact_conversion(written, target)
    if number == 0.0 or math.isinf(number):  # never a fraction of 1e-999999999
        return number + float(offset)
    # 1100 us is 1100 / 1000000 s to the last digit; 1100 * 1e-6 is not.
    return float(factor * Fraction(digits) + offset)


def _to_pint(text: str) -> str:
    """Rewrite FMI's ``kg.m2/s`` as pint's ``kg*m**2/s``."""
    text = text.strip().replace("%", "percent").replace("·", "*")
    text = re.sub(r"(?<=[A-Za-z0-9])\.(?=[A-Za-z])", "*", text)
    if _MISTAKEN.search(text):
        raise ValueError("pint would make something of it")
    return re.sub(r"(?<=[A-Za-z])(-?\d+)", r"**(\1)", text)
