"""Numbers and units as a person reads them: degrees for radians, a few significant digits."""

from __future__ import annotations

import math
import re

from .units import conversion, unit


def person_unit(text: str) -> str:
    """Return the unit a person reads for the SI unit ``text``: deg for rad, deg/s for rad/s."""
    return re.sub(r"^rad(?![A-Za-z])", "deg", text)


def person_scale(text: str) -> tuple[float, str]:
    """Return (factor, unit) that turn values in the SI unit ``text`` into a person's.

    Raises InputError if ``text`` is not a unit.
    """
    readable = person_unit(text)
    factor = conversion(text, readable)[0] if readable != text else 1.0
    return factor, readable


def from_si(value: float, text: str) -> float:
    """Return the SI ``value`` in the unit ``text``. Raises InputError if that is not a unit."""
    to = unit(text)
    return (value - to.offset) / to.factor


def number(value: float, digits: int = 4) -> str:
    """Return ``value`` with ``digits`` significant digits, whole digits never dropped.

    >>> number(12345.678), number(0.01951219), number(-0.0), number(3e-9)
    ('12346', '0.01951', '0', '3e-09')
    """
    if value == 0 or not math.isfinite(value):
        return str(abs(value)) if value else "0"
    size = math.floor(math.log10(abs(value)))
    if not -4 <= size < 9:
        return f"{value:.{digits}g}"
    text = f"{value:.{max(0, digits - 1 - size)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def quantity_text(value: float, unit_text: str, digits: int = 4) -> str:
    """Return ``value`` with its unit: ``10.9 deg``, ``5 %``, or the bare number for unit 1."""
    shown = number(value, digits)
    return shown if unit_text in ("", "1") else f"{shown} {unit_text}"


def distinct(value: float, other: float, unit_text: str) -> tuple[str, str]:
    """Return both values as text with the fewest digits, at least 3, that distinguish them."""
    for digits in range(3, 13):
        a = quantity_text(value, unit_text, digits)
        b = quantity_text(other, unit_text, digits)
        if a != b:
            break
    return a, b
