"""Units of MAVLink's message definitions and of ArduPilot's logs."""

from __future__ import annotations

from functools import cache

from seatrial.errors import InputError
from seatrial.model.units import unit

_OWN: dict[str, tuple[float, str | None]] = {
    "c%": (0.01, "%"),
    "d%": (0.1, "%"),
    "degE5": (1e-5, "deg"),
    "degE7": (1e-7, "deg"),
    "deglatitude": (1.0, "deg"),
    "deglongitude": (1.0, "deg"),
    "degheading": (1.0, "deg"),
    "mG": (9.80665e-3, "m/s2"),
    "m/s/s": (1.0, "m/s2"),
    "m/s*5": (0.2, "m/s"),
    "G": (9.80665, "m/s2"),
}
"""Those that mean something else to everybody else, or nothing: a factor, and the unit."""


@cache
def unit_of(text: str) -> tuple[float, str | None]:
    """Return the factor of values and the unit that they have then; None for one not known.

    A number may stand before it, as pymavlink writes ArduPilot's multipliers: ``1e-07 deg``.
    """
    number, space, name = text.partition(" ")
    try:
        factor = float(number) if space else 1.0
    except ValueError:
        return 1.0, None
    own = _OWN.get(name if space else text)
    if own is not None:
        return factor * own[0], own[1]
    try:
        return factor, unit(name if space else text).text if text else None
    except InputError:
        return 1.0, None
