"""Units as FMI writes them (``N.m``, ``kg.m2``, ``rad/s``) and as a person does (``10 deg``)."""

from __future__ import annotations

import re
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Unit:
    """A unit as FMI's UnitDefinitions has it: SI value = factor * value + offset."""

    text: str
    factor: float
    offset: float
    exponents: dict[str, int]
    """Exponent of each base unit that occurs; radian counts as one."""


@cache
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(cache_folder=None, on_redefinition="ignore")
    # In pint a radian is a pure number; FMI keeps it as a base unit, and so do we: it is what
    # tells an angle from a count on a wire.
    registry.define("radian = [angle] = rad")
    registry.define("degree = π / 180 * radian = deg = °")
    registry.define("revolution = 2 * π * radian = rev")
    return registry


@lru_cache(maxsize=1024)
def unit(text: str) -> Unit:
    """Return the unit written ``text``: FMI style (``kg.m2/s``), pint style, ``1`` or ``%``.

    Raises InputError if it is not a unit.
    """
    registry = _registry()
    if text.strip() in ("", "1"):
        return Unit("1", 1.0, 0.0, {})
    try:
        parsed = registry.Unit(_to_pint(text))
        one = registry.Quantity(1.0, parsed).to_base_units()
        zero = registry.Quantity(0.0, parsed).to_base_units()
    except Exception:
        raise InputError(f"{text!r} is not a unit (examples: N.m, kg.m2, rad/s, deg, ms)") from None
    names = {long: short for short, long in _BASE.items()}
    exponents: dict[str, int] = {}
    for name, power in one.unit_items():
        if name not in names or power != int(power):
            raise InputError(f"unit {text!r} cannot be written in FMI's base units")
        exponents[names[name]] = int(power)
    factor = one.magnitude - zero.magnitude
    return Unit(text, float(factor), float(zero.magnitude), exponents)


def conversion(source: str, target: str) -> tuple[float, float]:
    """Return (factor, offset) with target value = factor * source value + offset.

    Raises InputError if the two do not measure the same thing.
    """
    a, b = unit(source), unit(target)
    if a.exponents != b.exponents:
        raise InputError(f"unit {source!r} cannot be converted to {target!r}")
    return a.factor / b.factor, (a.offset - b.offset) / b.factor


def quantity(text: str | float | int, target: str) -> float:
    """Return what ``text`` says (``"10 deg"``, or a bare number already in ``target``).

    Raises InputError if it is not a number with a unit that converts to ``target``.
    """
    if isinstance(text, bool) or not isinstance(text, (str, int, float)):
        raise InputError(f"{text!r} is not a quantity such as '10 {target}'")
    if not isinstance(text, str):
        return float(text)
    match = _NUMBER.match(text)
    if match is None:
        raise InputError(f"{text!r} is not a quantity such as '10 {target}'")
    number, written = float(match.group(1)), match.group(2)
    if not written:
        if unit(target).exponents:
            raise InputError(f"{text!r} has no unit; write for example '{number:g} {target}'")
        written = "1"
    factor, offset = conversion(written, target)
    parts = round(1.0 / factor)
    # 1100 us is 1100 / 1000000 s to the last digit; 1100 * 1e-6 is not.
    exact = parts > 1 and 1.0 / parts == factor
    return (number / parts if exact else number * factor) + offset


def _to_pint(text: str) -> str:
    """Rewrite FMI's ``kg.m2/s`` as pint's ``kg*m**2/s``."""
    text = text.strip().replace("%", "percent").replace("·", "*")
    text = re.sub(r"(?<=[A-Za-z0-9])\.(?=[A-Za-z])", "*", text)
    return re.sub(r"(?<=[A-Za-z])(-?\d+)", r"**(\1)", text)
