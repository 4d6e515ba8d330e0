"""Identity and motion of an AIS station, as fields of its messages.

Layouts and "not available" values: Rec. ITU-R M.1371-5, Annex 8, and the US Coast Guard's pages on
AIS messages; fields by pyais's names.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from seatrial.errors import InputError

Fields = dict[str, Any]

EQUIPMENT = ("A", "B-SO", "B-CS")
"""Class A, and class B with self-organised and with carrier-sense access."""
KNOT = 1852.0 / 3600.0
"""m/s."""
AT_ANCHOR, MOORED, UNDEFINED = 1, 5, 15
STATUSES = range(16)
"""Navigational statuses: 0 under way using engine, 8 under way sailing ..."""
_NO_SPEED, _NO_COURSE, _NO_HEADING, _NO_TURN = 102.3, 360.0, 511, -128
_NO_LATITUDE, _NO_LONGITUDE, _NO_SECOND = 91.0, 181.0, 60
_FASTEST = 102.2
_GPS = 1
_TEXT = re.compile(r"[ -_]*")
"""AIS's 6-bit characters, those of ASCII from the space to the underscore."""


@dataclass(frozen=True)
class Identity:
    """What a station says of itself, m; `checked` makes one from what somebody wrote."""

    mmsi: int
    equipment: str = "A"
    name: str = ""
    callsign: str = ""
    imo: int = 0
    ship_type: int = 0
    to_bow: float = 0.0
    """From the antenna."""
    to_stern: float = 0.0
    to_port: float = 0.0
    to_starboard: float = 0.0
    draught: float = 0.0
    destination: str = ""

    def checked(self, called: str) -> Identity:
        """Return it with texts in capitals. Raises InputError, beginning with ``called``."""
        if not 0 < self.mmsi < 1_000_000_000:
            raise InputError(f"{called}mmsi is {self.mmsi}, 1 to 999999999 are allowed")
        if self.equipment not in EQUIPMENT:
            allowed = ", ".join(EQUIPMENT)
            raise InputError(f"{called}equipment is {self.equipment!r}, allowed: {allowed}")
        for key, low, high in _LIMITS:
            value = getattr(self, key)
            if not low <= value <= high:
                raise InputError(f"{called}{key} is {value}, {low} to {high} are allowed")
        texts = {}
        for key, most in (("name", 20), ("callsign", 7), ("destination", 20)):
            text = getattr(self, key).upper()
            if len(text) > most or not _TEXT.fullmatch(text):
                raise InputError(
                    f"{called}{key} is {getattr(self, key)!r}, at most {most} letters, digits and "
                    "ASCII signs are allowed"
                )
            texts[key] = text
        return Identity(**{**vars(self), **texts})

    @property
    def class_a(self) -> bool:
        """Whether it is class A."""
        return self.equipment == "A"


_LIMITS = (
    ("imo", 0, 999_999_999),
    ("ship_type", 0, 255),
    ("to_bow", 0.0, 511.0),
    ("to_stern", 0.0, 511.0),
    ("to_port", 0.0, 63.0),
    ("to_starboard", 0.0, 63.0),
    ("draught", 0.0, 25.5),
)


@dataclass(frozen=True)
class Motion:
    """Motion at an instant; None for what is not available."""

    second: int
    """Of UTC, in the minute."""
    place: tuple[float, float] | None = None
    """Latitude and longitude, degrees."""
    speed: float | None = None
    """Over ground, m/s."""
    course: float | None = None
    """Over ground, clockwise from north, rad."""
    heading: float | None = None
    """True, clockwise from north, rad."""
    turn: float | None = None
    """Rate of turn, to starboard, rad/s."""
    status: int = UNDEFINED
    """Navigational status."""


def position_report(of: Identity, motion: Motion) -> Fields:
    """Return the fields of message 1 of class A, 18 of class B."""
    latitude, longitude = motion.place or (_NO_LATITUDE, _NO_LONGITUDE)
    shared: Fields = {
        "mmsi": of.mmsi,
        "speed": _NO_SPEED if motion.speed is None else _speed(motion.speed),
        "accuracy": 0,
        "lat": latitude,
        "lon": longitude,
        "course": _NO_COURSE if motion.course is None else _degrees(motion.course, 1),
        "heading": _NO_HEADING if motion.heading is None else int(_degrees(motion.heading, 0)),
        "second": _NO_SECOND if motion.place is None else motion.second,
        "raim": 0,
        "radio": 0,
    }
    if of.class_a:
        turn = {"turn": _turn(motion.turn), "status": motion.status, "maneuver": 0}
        return {"msg_type": 1, **shared, **turn}
    carrier_sense = int(of.equipment == "B-CS")
    return {"msg_type": 18, **shared, "cs": carrier_sense, "dsc": 1, "band": 1, "msg22": 1}


def static_reports(of: Identity) -> list[Fields]:
    """Return the fields of message 5 of class A, of both parts of 24 of class B."""
    described: Fields = {
        "mmsi": of.mmsi,
        "callsign": of.callsign,
        "ship_type": of.ship_type,
        "to_bow": round(of.to_bow),
        "to_stern": round(of.to_stern),
        "to_port": round(of.to_port),
        "to_starboard": round(of.to_starboard),
    }
    if of.class_a:
        voyage = {"destination": of.destination, "draught": round(of.draught, 1), "epfd": _GPS}
        no_eta = {"month": 0, "day": 0, "hour": 24, "minute": 60}
        named = {"shipname": of.name, "imo": of.imo, "ais_version": 2}
        return [{"msg_type": 5, **described, **named, **voyage, **no_eta, "dte": 0}]
    return [
        {"msg_type": 24, "partno": 0, "mmsi": of.mmsi, "shipname": of.name},
        {"msg_type": 24, "partno": 1, **described, "vendorid": "SEA"},
    ]


def _speed(speed: float) -> float:
    return min(round(speed / KNOT, 1), _FASTEST)


def _degrees(angle: float, decimals: int) -> float:
    return round(math.degrees(angle), decimals) % 360.0


def _turn(rate: float | None) -> float:
    """Return degrees per minute, as pyais takes them: it has the square-root scale."""
    if rate is None:
        return _NO_TURN
    per_minute = max(-708.0, min(708.0, 60.0 * math.degrees(rate)))
    # These numbers, and no others, it takes for "turning, no indicator" and "not available".
    return per_minute + 0.01 if abs(per_minute) in (127.0, 128.0) else per_minute
