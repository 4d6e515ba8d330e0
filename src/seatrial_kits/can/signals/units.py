"""Units as DBC files write them."""

from __future__ import annotations

from seatrial.errors import InputError
from seatrial.model.units import Unit, unit

_MEANT = {"Nm": "N.m", "NM": "N.m", "C": "degC"}
"""Texts that are other units to physics: number metres, coulombs."""
_SPELLINGS = {
    "bar": "bar",
    "deg": "deg",
    "deg/s": "deg/s",
    "degc": "degC",
    "hz": "Hz",
    "km": "km",
    "km/h": "km/h",
    "kpa": "kPa",
    "mbar": "mbar",
    "psi": "psi",
    "rpm": "rpm",
    "°": "deg",
    "degree": "deg",
    "degrees": "deg",
    "°/s": "deg/s",
    "º/s": "deg/s",
    "degrees/s": "deg/s",
    "deg/sec": "deg/s",
    "degree/sec": "deg/s",
    "degrees/sec": "deg/s",
    "°c": "degC",
    "ºc": "degC",
    "deg c": "degC",
    "degrees c": "degC",
    "degreesc": "degC",
    "celsius": "degC",
    "kph": "km/h",
    "kmh": "km/h",
    "km^h": "km/h",
    "mph": "mile/h",
    "r/min": "rpm",
    "1/min": "rpm",
    "m/sec": "m/s",
    "m/s^2": "m/s2",
    "m/s²": "m/s2",
    "mm/sec": "mm/s",
    "volt": "V",
    "volts": "V",
    "amp": "A",
    "amps": "A",
    "ampere": "A",
    "watt": "W",
    "watts": "W",
    "kw": "kW",
    "kilopascal": "kPa",
    "millibar": "mbar",
    "meter": "m",
    "meters": "m",
    "metre": "m",
    "sec": "s",
    "seconds": "s",
    "second": "s",
    "usec": "us",
    "msec": "ms",
    "minute": "min",
    "minutes": "min",
    "hour": "h",
    "hours": "h",
    "percent": "%",
    "unitless": "1",
    "-": "1",
}
"""Spellings that are common in public files, by their small letters."""


def unit_of(written: str | None) -> Unit | None:
    """Return the unit of a signal, None if its text is none; without a text it is a number.

    A text is a unit as it is, or in one of `_SPELLINGS`: texts are written by hand.
    """
    text = (written or "1").strip()
    for each in (_MEANT.get(text, text), _SPELLINGS.get(text.lower(), "")):
        try:
            return unit(each) if each else None
        except InputError:
            continue
    return None
