"""Fields of sentences that are channels of a log, with units, and the quantities that they serve.

Source: E. S. Raymond, "NMEA Revealed" (gpsd project); fields by pynmeagps's names.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

SENTENCE = re.compile(r"[$!]([A-Z0-9]{3,}[^$!*]*)\*([0-9A-Fa-f]{2})")

_PLACE = {"lat": "deg", "lon": "deg"}
_FIELDS: Mapping[str, Mapping[str, str]] = {
    "GGA": {**_PLACE, "alt": "m"},
    "GLL": _PLACE,
    "GNS": {**_PLACE, "alt": "m"},
    "RMC": {**_PLACE, "spd": "knot", "cog": "deg"},
    "VTG": {"cogt": "deg", "sogn": "knot"},
    "HDT": {"headingT": "deg"},
    "THS": {"headt": "deg"},
    "HDG": {"headingM": "deg"},
    "ROT": {"rot": "deg/min"},
    "RSA": {"stbdangle": "deg", "portangle": "deg"},
    "VHW": {"hdgT": "deg", "spdN": "knot"},
    "DPT": {"depth": "m"},
    "DBT": {"depthm": "m"},
    "MWV": {"angle": "deg"},
}
"""By formatter."""
_XDR_UNITS = {"D": "deg", "M": "m", "V": "V", "A": "A", "R": "rpm", "C": "degC"}
_INVALID: Mapping[str, tuple[str, Any]] = {
    "GGA": ("quality", 0),
    "GLL": ("status", "V"),
    "RMC": ("status", "V"),
    "RSA": ("stbdstatus", "V"),
    "ROT": ("valid", "V"),
    "THS": ("mi", "V"),
}
"""Field and value that mark a sentence as invalid."""

KINDS = frozenset({*_FIELDS, "XDR", "ZDA"})
"""Formatters that have a channel or a time; others are not read."""

DEFAULTS: Mapping[str, tuple[str, ...]] = {
    "latitude": ("GGA.lat", "RMC.lat", "GNS.lat", "GLL.lat"),
    "longitude": ("GGA.lon", "RMC.lon", "GNS.lon", "GLL.lon"),
    "heading": ("HDT.headingT", "THS.headt", "HDG.true", "VHW.hdgT"),
    "course": ("VTG.cogt", "RMC.cog"),
    "speed": ("VTG.sogn", "RMC.spd"),
    "water_speed": ("VHW.spdN",),
    "helm": ("RSA.stbdangle",),
    "roll": ("XDR.ROLL", "XDR.HEEL"),
    "pitch": ("XDR.PITCH", "XDR.PTCH", "XDR.TRIM"),
    "yaw_rate": ("ROT.rot",),
    "water_depth": ("DPT.depth", "DBT.depthm"),
}


def is_valid(message: Any) -> bool:
    """Return whether a sentence does not say that it is invalid."""
    field, mark = _INVALID.get(message.msgID, ("", None))
    return not field or getattr(message, field, None) != mark


def values_of(message: Any) -> dict[str, tuple[str | None, float]]:
    """Return unit and value of the numbers in a sentence, by channel; empty fields are none."""
    kind = message.msgID
    if kind == "XDR":
        return _transducers(vars(message))
    fields = _FIELDS.get(kind, {})
    numbers = {name: getattr(message, name, "") for name in fields}
    found: dict[str, tuple[str | None, float]] = {
        f"{kind}.{name}": (fields[name], float(value))
        for name, value in numbers.items()
        if isinstance(value, (int, float))
    }
    if kind == "HDG" and (true := _true_heading(message)) is not None:
        found["HDG.true"] = ("deg", true)
    return found


def _transducers(fields: Mapping[str, Any]) -> dict[str, tuple[str | None, float]]:
    """Return the readings of XDR by the names of their transducers, in capitals."""
    found: dict[str, tuple[str | None, float]] = {}
    for key, value in fields.items():
        if key.startswith("data_") and isinstance(value, (int, float)):
            number = key.removeprefix("data_")
            name = str(fields.get(f"tdrid_{number}", "")).upper()
            unit = _XDR_UNITS.get(str(fields.get(f"dataunit_{number}", "")))
            found[f"XDR.{name or number}"] = (unit, float(value))
    return found


def _true_heading(message: Any) -> float | None:
    """Return the true heading of HDG: its reading + deviation + variation, positive east, deg."""
    total = message.headingM
    for name, needed in (("variation", True), ("deviation", False)):
        value = getattr(message, name)
        if isinstance(value, (int, float)):
            total += -value if getattr(message, f"{name}EW") == "W" else value
        elif needed:
            return None
    return float(total) % 360.0 if isinstance(message.headingM, (int, float)) else None
