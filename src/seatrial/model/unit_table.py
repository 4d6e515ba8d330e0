"""Units of everyday use with exact factors: products of these need no registry, which takes long.

The factors and names are those of pint's registry; what is not here is looked up there.
"""

from __future__ import annotations

import re
from fractions import Fraction

Known = tuple[Fraction, dict[str, int]]
"""Factor to the SI unit, and exponent of each of FMI's base units."""

STANDARD_GRAVITY = 9.80665
"""Standard gravity, m/s2: the unit g of sensors and of kilogram-force, not that of a place."""

_PI = Fraction("3.1415926535897932384626433832795028841971693993751")
_PREFIXES = {
    prefix: Fraction(10) ** power
    for prefix, power in {"G": 9, "M": 6, "k": 3, "": 0, "c": -2, "m": -3, "u": -6, "n": -9}.items()
}
_NEWTON = {"kg": 1, "m": 1, "s": -2}
_PASCAL = {"kg": 1, "m": -1, "s": -2}
_WATT = {"kg": 1, "m": 2, "s": -3}
_PREFIXED: dict[str, tuple[str, Known]] = {
    "m": ("kcmun", (Fraction(1), {"m": 1})),
    "s": ("mun", (Fraction(1), {"s": 1})),
    "N": ("kMm", (Fraction(1), _NEWTON)),
    "Pa": ("kM", (Fraction(1), _PASCAL)),
    "W": ("kMm", (Fraction(1), _WATT)),
    "Hz": ("kMG", (Fraction(1), {"s": -1})),
    "A": ("m", (Fraction(1), {"A": 1})),
    "V": ("m", (Fraction(1), {"kg": 1, "m": 2, "s": -3, "A": -1})),
    "ohm": ("k", (Fraction(1), {"kg": 1, "m": 2, "s": -3, "A": -2})),
    "rad": ("m", (Fraction(1), {"rad": 1})),
    "g": ("km", (Fraction(1, 1000), {"kg": 1})),
}
"""Units by name, with the prefixes that they may have here."""

_TABLE: dict[str, Known] = {
    "K": (Fraction(1), {"K": 1}),
    "J": (Fraction(1), {"kg": 1, "m": 2, "s": -2}),
    "T": (Fraction(1), {"kg": 1, "s": -2, "A": -1}),
    "C": (Fraction(1), {"s": 1, "A": 1}),
    "hPa": (Fraction(100), _PASCAL),
    "bar": (Fraction(10**5), _PASCAL),
    "min": (Fraction(60), {"s": 1}),
    "h": (Fraction(3600), {"s": 1}),
    "t": (Fraction(1000), {"kg": 1}),
    "l": (Fraction(1, 1000), {"m": 3}),
    "deg": (_PI / 180, {"rad": 1}),
    "rev": (2 * _PI, {"rad": 1}),
    "rpm": (2 * _PI / 60, {"rad": 1, "s": -1}),
    "knot": (Fraction(1852, 3600), {"m": 1, "s": -1}),
    "%": (Fraction(1, 100), {}),
    **{
        prefix + name: (_PREFIXES[prefix] * factor, exponents)
        for name, (prefixes, (factor, exponents)) in _PREFIXED.items()
        for prefix in ("", *prefixes)
    },
}
_FACTOR = re.compile(r"(^1/|^|(?!^)[./*·])([A-Za-z]+|%)(-?[1-9](?!\d))?")


_QUOTIENT = re.compile(r"([^()]+)/\(([^()]+)\)")


def known(text: str) -> Known | None:
    """Return what ``text`` (``kg.m2/s``, ``N/(m.s)``) is, None if the table has not all of it.

    As in pint, a solidus without parentheses holds for the next name alone: ``N/m.s`` is N s/m.
    """
    quotient = _QUOTIENT.fullmatch(text)
    if quotient is None:
        return _product(text)
    above, below = _product(quotient[1]), _product(quotient[2])
    if above is None or below is None:
        return None
    return above[0] / below[0], _sum(above[1], below[1], -1)


def _product(text: str) -> Known | None:
    factor, exponents, end = Fraction(1), dict[str, int](), 0
    while end < len(text):
        found = _FACTOR.match(text, end)
        if found is None or found[2] not in _TABLE:
            return None
        power = int(found[3] or 1) * (-1 if found[1].endswith("/") else 1)
        scale, bases = _TABLE[found[2]]
        factor, exponents = factor * scale**power, _sum(exponents, bases, power)
        end = found.end()
    return factor, exponents


def _sum(a: dict[str, int], b: dict[str, int], power: int) -> dict[str, int]:
    """Return the exponents of a product with the ``power`` of another unit."""
    total = {base: a.get(base, 0) + power * b.get(base, 0) for base in a | b}
    return {base: count for base, count in total.items() if count}
