"""Steering commands of chart plotters and remote controls: the sentences APB, RMB and HSC.

Source: E. S. Raymond, "NMEA Revealed" (gpsd project); pynmeagps has the fields.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

MILE = 1852.0
"""m."""

_LARGEST_ERROR = 1e3
"""Cross-track errors beyond so many miles are none."""


@dataclass(frozen=True)
class Order:
    """Content of one sentence; None for what it does not have."""

    heading: float | None = None
    """True, clockwise from north, rad."""
    place: tuple[float, float] | None = None
    """Waypoint to go to, latitude and longitude, degrees."""
    cross_track: float | None = None
    """m, positive to starboard of the leg."""
    waypoint: str | None = None
    """Its name."""
    arrived: bool | None = None
    """Whether the arrival circle was entered or the waypoint passed abeam."""


def read_order(message: Any, variation: float) -> Order | None:
    """Return what a sentence orders; None if nothing, or its status is not valid.

    HSC: the heading commanded, true if there, else magnetic; not one that is only reported.
    APB: the heading to steer, cross-track error and arrival; RMB: the waypoint and the same.
    Magnetic directions become true ones by the magnetic ``variation``, rad, positive east.
    """
    readers = {"HSC": _hsc, "APB": _apb, "RMB": _rmb}
    reader = readers.get(message.msgID)
    return None if reader is None else reader(message, variation)


def heading_ordered(orders: Mapping[str, Order]) -> float | None:
    """Return the heading of HSC, or else of APB; ``orders`` are by formatter."""
    headings = (orders[name].heading for name in ("HSC", "APB") if name in orders)
    return next((heading for heading in headings if heading is not None), None)


def last_reported(orders: Mapping[str, Order]) -> Order:
    """Return the last order with a cross-track error; ``orders`` stand the oldest first."""
    reported = (order for order in reversed(list(orders.values())) if order.cross_track is not None)
    return next(reported, Order())


def _hsc(message: Any, variation: float) -> Order | None:
    if _text(message, "status") == "R":
        return None
    heading = _direction(_field(message, "cmdheadingT"), "T", variation)
    if heading is None:
        heading = _direction(_field(message, "cmdheadingM"), "M", variation)
    return None if heading is None else Order(heading)


def _apb(message: Any, variation: float) -> Order | None:
    if "V" in (_text(message, "LCgwarn"), _text(message, "LCcwarn")):
        return None
    if _text(message, "mode") == "N":
        return None
    unit = MILE if _text(message, "ctrkUnit") != "K" else 1000.0
    arrived = "A" in (_text(message, "aalmcirc"), _text(message, "aalmperp"))
    return Order(
        _direction(_field(message, "bearS"), _text(message, "bearSu"), variation),
        None,
        _cross_track(message, unit),
        _text(message, "wpt"),
        arrived,
    )


def _rmb(message: Any, variation: float) -> Order | None:
    if _text(message, "status") != "A" or _text(message, "valstatus") == "N":
        return None
    latitude, longitude = _field(message, "lat"), _field(message, "lon")
    place = None
    if latitude is not None and longitude is not None and abs(latitude) <= 90.0:
        place = (latitude, longitude) if abs(longitude) <= 180.0 else None
    arrived = _text(message, "arrstatus") == "A"
    return Order(None, place, _cross_track(message, MILE), _text(message, "wptD"), arrived)


def _cross_track(message: Any, unit: float) -> float | None:
    """Return the error: a vessel to be steered left is to starboard of the leg."""
    error, side = _field(message, "ctrkerr"), _text(message, "dirs")
    if error is None or side not in ("L", "R") or abs(error) > _LARGEST_ERROR:
        return None
    return error * unit if side == "L" else -error * unit


def _direction(degrees: float | None, reference: str, variation: float) -> float | None:
    if degrees is None or not 0.0 <= degrees <= 360.0 or reference not in ("T", "M"):
        return None
    true = math.radians(degrees) + (variation if reference == "M" else 0.0)
    return true % math.tau


def _field(message: Any, name: str) -> float | None:
    value = getattr(message, name, None)
    return value if isinstance(value, float) else None


def _text(message: Any, name: str) -> str:
    """Return a field of text; "" without: older devices send fewer fields."""
    return str(getattr(message, name, ""))
