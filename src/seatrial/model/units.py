"""Units as FMI writes them (``N.m``, ``kg.m2``, ``rad/s``) and as a person does (``10 deg``)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any

from ..errors import InputError
from .unit_table import known

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
    """Exponent of each base unit that occurs; radian is one."""
    by_name: bool = True
    """False for a unit that an FMU defines; it may have left the radian out."""

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
    # tells an angle from a count on a connection.
    registry: Any = pint.UnitRegistry(cache_folder=None, non_int_type=Fraction)
    registry.define("@alias degree = °")
    registry.define("@alias revolution = rev")
    return registry


@lru_cache(maxsize=1024)
def unit(text: str) -> Unit:
    """Return the unit written ``text``: FMI style (``kg.m2/s``), pint style, ``1`` or ``%``.

    Raises InputError if it is not a unit, or not a linear one (dB).
    """
    if text.strip() in ("", "1"):
        return Unit("1", Fraction(1), Fraction(0), {})
    usual = known(text)
    factor, offset, exponents = (
        _looked_up(text) if usual is None else (usual[0], Fraction(0), usual[1])
    )
    return Unit(
        text, factor, offset, {base: exponents[base] for base in _BASE if base in exponents}
    )


def _looked_up(text: str) -> tuple[Fraction, Fraction, dict[str, int]]:
    """Return factor, offset and exponents of a unit by pint's registry; see `unit`."""
    registry = _registry()
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
    return one.magnitude - zero.magnitude, zero.magnitude, exponents


def defined_unit(text: str, exponents: Mapping[str, int], factor: float, offset: float) -> Unit:
    """Return the unit that an FMU calls ``text`` and defines: SI = factor * value + offset.

    Where the name means the same it is `unit` of that name, with exact factors; the definition
    may have left the radian out. Raises InputError for a factor that converts nothing.
    """
    if not (math.isfinite(factor) and math.isfinite(offset) and factor > 0.0):
        raise InputError(f"unit {text!r} has factor {factor!r} and offset {offset!r}")
    powers = {name: power for name, power in exponents.items() if power}
    try:
        named = unit(text)
    except InputError:
        named = None
    if named is not None and (named.factor, named.offset) == (factor, offset):
        without = {name: power for name, power in named.exponents.items() if name != "rad"}
        if powers in (named.exponents, without):
            return named
    return Unit(text, Fraction(factor), Fraction(offset), powers, by_name=False)


def conversion(source: str | Unit, target: str | Unit) -> tuple[float, float]:
    """Return (factor, offset) with target value = factor * source value + offset.

    A unit is a name, or what an FMU defines. Equal names need not be known. Raises InputError
    if the two do not measure the same thing, or one of two different names is not known.
    """
    exact = _exact_conversion(source, target)
    try:
        factor, offset = float(exact[0]), float(exact[1])
    except OverflowError:
        factor = offset = 0.0
    if factor == 0.0:
        ends = f"unit {_name(source)!r} cannot be converted to {_name(target)!r}"
        raise InputError(f"{ends}: the factor is beyond the range of doubles")
    return factor, offset


def _exact_conversion(source: str | Unit, target: str | Unit) -> tuple[Fraction, Fraction]:
    defined = isinstance(source, Unit) and isinstance(target, Unit)
    if _name(source) == _name(target) and not defined:
        return Fraction(1), Fraction(0)
    refusal = f"unit {_name(source)!r} cannot be converted to {_name(target)!r}"
    try:
        a, b = (end if isinstance(end, Unit) else unit(end) for end in (source, target))
    except InputError as error:
        raise InputError(f"{error}; {refusal}") from None
    if not _alike(a, b):
        raise InputError(refusal)
    return a.exact_factor / b.exact_factor, (a.exact_offset - b.exact_offset) / b.exact_factor


def _alike(a: Unit, b: Unit) -> bool:
    """Return whether two units measure the same; radians matter only where names alone decide."""
    if a.by_name and b.by_name:
        return a.exponents == b.exponents
    names = (a.exponents.keys() | b.exponents.keys()) - {"rad"}
    return all(a.exponents.get(name, 0) == b.exponents.get(name, 0) for name in names)


def _name(measure: str | Unit) -> str:
    return measure.text if isinstance(measure, Unit) else measure


def quantity(text: str | float | int, target: str | Unit) -> float:
    """Return the value of ``text`` (``"10 deg"``, or a bare number already in ``target``).

    The result is the double nearest to what is written. Raises InputError if it is not a
    finite number with a unit that converts to ``target``.
    """
    if isinstance(text, bool) or not isinstance(text, (str, int, float)):
        raise InputError(f"{text!r} is not a quantity such as '10 {_name(target)}'")
    try:
        value = _written(text, target) if isinstance(text, str) else float(text)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise InputError(f"{text!r} is not a finite number")
    return value


def split_quantity(text: str) -> tuple[float, str] | None:
    """Return number and unit of a text such as ``"10 deg"``; None for any other text."""
    match = _NUMBER.fullmatch(text)
    if match is None or not match[2]:
        return None
    try:
        unit(match[2])
    except InputError:
        return None
    value = float(match[1])
    return (value, match[2]) if math.isfinite(value) else None


def _written(text: str, target: str | Unit) -> float:
    match = _NUMBER.match(text)
    if match is None:
        raise InputError(f"{text!r} is not a quantity such as '10 {_name(target)}'")
    digits, written = match.groups()
    number = float(digits)
    if not written:
        if _has_dimension(target):
            raise InputError(
                f"{text!r} has no unit; write for example '{number:g} {_name(target)}'"
            )
        return number
    factor, offset = _exact_conversion(written, target)
    if number == 0.0 or math.isinf(number):  # never a fraction of 1e-999999999
        return number + float(offset)
    # 1100 us is 1100 / 1000000 s to the last digit; 1100 * 1e-6 is not.
    return float(factor * Fraction(digits) + offset)


def _has_dimension(measure: str | Unit) -> bool:
    """Return whether a number needs this unit written; one that is not known is no pure number."""
    try:
        return bool((measure if isinstance(measure, Unit) else unit(measure)).exponents)
    except InputError:
        return True


def _to_pint(text: str) -> str:
    """Rewrite FMI's ``kg.m2/s`` as pint's ``kg*m**2/s``."""
    text = text.strip().replace("%", "percent").replace("·", "*")
    text = re.sub(r"(?<=[A-Za-z0-9])\.(?=[A-Za-z])", "*", text)
    if _MISTAKEN.search(text):
        raise ValueError("pint would make something of it")
    return re.sub(r"(?<=[A-Za-z])(-?\d+)", r"**(\1)", text)
