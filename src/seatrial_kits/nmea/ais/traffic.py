"""Ships of a file with scripted tracks, as AIS stations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.model.units import quantity
from seatrial.reading import toml_content

from .station import STATUSES, UNDEFINED, Identity

_TEXTS = ("equipment", "name", "callsign", "destination")
_NUMBERS = ("imo", "ship_type", "status")
_LENGTHS = ("length", "beam", "draught", "antenna")
_KEYS = ("mmsi", "track", *_TEXTS, *_NUMBERS, *_LENGTHS)
_POINT = (("time", "s"), ("north", "m"), ("east", "m"))
MOST_SHIPS, _MOST_POINTS = 200, 10_000
_ANTENNA_M = 10.0

Moved = tuple[tuple[float, float], float, float | None]
"""North and east, m; speed, m/s; course, rad, None for a ship that lies still."""


@dataclass(frozen=True)
class Ship:
    """A ship on a track, which it follows from point to point, straight and at constant speed.

    It is there from the time of the first point to that of the last.
    """

    identity: Identity
    track: tuple[tuple[float, float, float], ...]
    """Time, s; north and east of the origin, m."""
    status: int = UNDEFINED
    antenna: float = _ANTENNA_M
    """Above the water, m."""

    def at(self, time: float) -> Moved | None:
        """Return where it is and how it moves; None before its track and after."""
        last, now = self.track[-1][0], round(time, 9)
        if not self.track[0][0] <= now <= last:
            return None
        legs = list(zip(self.track, self.track[1:], strict=False))
        (t0, n0, e0), (t1, n1, e1) = next(leg for leg in legs if now < leg[1][0] or leg is legs[-1])
        share, duration = (now - t0) / (t1 - t0), t1 - t0
        north, east = n1 - n0, e1 - e0
        course = math.atan2(east, north) if north or east else None
        speed = math.hypot(north, east) / duration
        return (n0 + share * north, e0 + share * east), speed, course


def read_traffic(path: Path) -> list[Ship]:
    """Return the ships of a TOML file, tables ``[[ships]]``.

    Raises InputError, with file, ship and key, for what cannot be.
    """
    try:
        content = toml_content(path.read_bytes(), str(path))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    _known(f"{path}", content, ("ships",))
    listed = content.get("ships")
    if not isinstance(listed, list) or not all(isinstance(each, dict) for each in listed):
        raise InputError(f"{path}: tables [[ships]] are needed")
    if len(listed) > MOST_SHIPS:
        raise InputError(f"{path}: {len(listed)} ships, at most {MOST_SHIPS} are allowed")
    ships = [_ship(f"{path}: ships[{k}]", each) for k, each in enumerate(listed)]
    numbers = [ship.identity.mmsi for ship in ships]
    for k, number in enumerate(numbers):
        if number in numbers[:k]:
            raise InputError(f"{path}: ships[{k}].mmsi: {number} is another's")
    return ships


def _ship(called: str, found: Mapping[str, Any]) -> Ship:
    _known(called, found, _KEYS)
    given: dict[str, Any] = {key: _text(called, key, found[key]) for key in _TEXTS if key in found}
    given |= {key: _whole(called, key, found[key]) for key in _NUMBERS if key in found}
    lengths = {
        key: _quantity(f"{called}.{key}", found[key], "m") for key in _LENGTHS if key in found
    }
    if "mmsi" not in found or "track" not in found:
        missing = "mmsi" if "mmsi" not in found else "track"
        raise InputError(f"{called}: {missing} is missing")
    status = given.pop("status", 0)
    if status not in STATUSES:
        raise InputError(f"{called}.status is {status}, 0 to 15 are allowed")
    length, beam = 0.5 * lengths.get("length", 0.0), 0.5 * lengths.get("beam", 0.0)
    antenna = lengths.get("antenna", _ANTENNA_M)
    if antenna < 0.0:
        raise InputError(f"{called}.antenna is {antenna:g} m, it is above the water")
    identity = Identity(
        mmsi=_whole(called, "mmsi", found["mmsi"]),
        **given,
        to_bow=length,
        to_stern=length,
        to_port=beam,
        to_starboard=beam,
        draught=lengths.get("draught", 0.0),
    ).checked(f"{called}.")
    return Ship(identity, _track(f"{called}.track", found["track"]), status, antenna)


def _track(called: str, found: Any) -> tuple[tuple[float, float, float], ...]:
    if not isinstance(found, list) or not 2 <= len(found) <= _MOST_POINTS:
        raise InputError(
            f"{called}: two points at least are needed, ['0 s', '100 m', '0 m'] each: time, "
            f"north, east; at most {_MOST_POINTS}"
        )
    points: list[tuple[float, float, float]] = []
    for k, point in enumerate(found):
        if not isinstance(point, list) or len(point) != len(_POINT):
            raise InputError(f"{called}[{k}] is {point!r}, time, north and east are needed")
        pairs = zip(point, _POINT, strict=True)
        t, n, e = (_quantity(f"{called}[{k}], {name}", value, u) for value, (name, u) in pairs)
        if points and t <= points[-1][0]:
            raise InputError(f"{called}[{k}]: {t:g} s is not after the point before")
        points.append((t, n, e))
    return tuple(points)


def _known(called: str, found: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    for key in found:
        if key not in keys:
            raise InputError(f"{called}: {unknown('key', key, keys)}")


def _text(called: str, key: str, value: Any) -> str:
    if not isinstance(value, str):
        raise InputError(f"{called}.{key} is {value!r}, a text is needed")
    return value


def _whole(called: str, key: str, value: Any) -> int:
    if type(value) is not int:
        raise InputError(f"{called}.{key} is {value!r}, a whole number is needed")
    return value


def _quantity(called: str, value: Any, unit: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise InputError(f"{called} is {value!r}, something like '10 {unit}' is needed")
    try:
        found = quantity(value, unit)
    except InputError as error:
        raise InputError(f"{called}: {error}") from None
    if not math.isfinite(found):
        raise InputError(f"{called} is {value!r}, a finite number is needed")
    return found
