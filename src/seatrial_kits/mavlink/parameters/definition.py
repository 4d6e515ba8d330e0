"""Definition of a parameter: name, type, limits, and the setting that it changes."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError, unknown

from ..settings import LIMITS, Settings

INT8: int = mavlink.MAV_PARAM_TYPE_INT8
INT16: int = mavlink.MAV_PARAM_TYPE_INT16
INT32: int = mavlink.MAV_PARAM_TYPE_INT32
REAL32: int = mavlink.MAV_PARAM_TYPE_REAL32

BELONGS_TO_TRIAL = "it belongs to the trial"

_LARGEST = float.fromhex("0x1.fffffep127")  # of 32 bits
_NAME = re.compile(r"[A-Z][A-Z0-9_]{0,15}")

Apply = Callable[[Settings, float], None]


@dataclass(frozen=True)
class Definition:
    """One parameter. Raises InputError for a name or a default that it cannot have."""

    name: str
    kind: int
    """MAV_PARAM_TYPE."""
    default: float
    low: float = -_LARGEST
    high: float = _LARGEST
    numbers: tuple[int, ...] = ()
    """The only values allowed; none: all from ``low`` to ``high``."""
    apply: Apply | None = None
    """Passes a value on to the settings."""
    fixed: str = ""
    """Why it cannot be set; empty if it can."""
    or_zero: bool = False
    """Whether 0 is allowed too."""
    passing: str = ""
    """Why no file keeps it; empty if one does."""

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            raise InputError(
                f"parameter {self.name!r}: 1 to 16 capital letters, digits and '_' are needed, a "
                "letter first"
            )
        taken = self.accepted(self.default)
        if taken is None or (self.kind != REAL32 and taken != self.default):
            raise InputError(
                f"parameter {self.name} starts with {self.default:g}, {self.allowed} is allowed"
            )

    def accepted(self, value: float) -> float | None:
        """Return what ``value`` becomes, of the parameter's type; None outside the limits."""
        if not math.isfinite(value):
            return None
        taken = shortest(value) if self.kind == REAL32 else float(round(value))
        if self.numbers:
            return taken if taken in self.numbers else None
        if self.or_zero and taken == 0.0:
            return 0.0
        return taken if self.low <= taken <= self.high else None

    @property
    def allowed(self) -> str:
        """The limits, for people."""
        if self.numbers:
            return "one of " + ", ".join(str(number) for number in sorted(self.numbers))
        whole = "" if self.kind == REAL32 else "a whole number, "
        whole += "0, or " if self.or_zero else ""
        if self.high == _LARGEST:
            return f"{whole}at least {self.low:g}"
        return f"{whole}{self.low:g} to {self.high:g}"


def fixed(name: str, kind: int, value: float, why: str = BELONGS_TO_TRIAL) -> Definition:
    """Return a parameter that cannot be set."""
    return Definition(name, kind, value, fixed=why)


def real(name: str, setting: str, settings: Settings, scale: float = 1.0) -> Definition:
    """Return a parameter for a setting that is a number; one unit of it is ``scale`` there."""
    start = getattr(settings, setting) / scale
    low, high = (shortest(limit / scale) for limit in LIMITS[setting])
    return Definition(name, REAL32, start, low, high, apply=_moves(setting, lambda v: v * scale))


def whole(name: str, setting: str, settings: Settings, low: int, high: int) -> Definition:
    """Return a parameter for a setting that is a number, in whole numbers."""
    start = getattr(settings, setting)
    return Definition(name, INT32, start, low, high, apply=_moves(setting, round))


def choice(
    name: str, setting: str, settings: Settings, meanings: Mapping[int, Any], kind: int = INT8
) -> Definition:
    """Return a parameter whose numbers mean values of a setting.

    It starts with the first number that means the setting's value. Raises InputError if none
    does.
    """
    value = getattr(settings, setting)
    number = next((n for n, meaning in meanings.items() if meaning == value), None)
    if number is None:
        allowed = [str(meaning) for meaning in dict.fromkeys(meanings.values())]
        raise InputError(unknown(f"{setting} of this vehicle", value, allowed))
    apply = _moves(setting, lambda v: meanings[round(v)])
    return Definition(name, kind, number, numbers=tuple(meanings), apply=apply)


def _moves(setting: str, meaning: Callable[[float], Any]) -> Apply:
    return lambda settings, value: setattr(settings, setting, meaning(value))


def shortest(value: float) -> float:
    """Return the shortest decimal number for what a float of 32 bits makes of ``value``.

    What a person set to 0.1 comes over the link as 0.10000000149.
    """
    if abs(value) > _LARGEST:
        return value  # beyond all limits
    sent = _single(value)
    return next(
        short for digits in range(1, 10) if _single(short := float(f"{sent:.{digits}g}")) == sent
    )


def _single(value: float) -> float:
    try:
        return float(struct.unpack("<f", struct.pack("<f", value))[0])
    except OverflowError:  # rounded up beyond the largest
        return math.inf
