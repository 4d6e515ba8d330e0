"""Other ships' AIS messages as PGNs."""

from __future__ import annotations

import math
from typing import Any

from .codec import Fields, Message

_KNOT = 1852.0 / 3600.0
_FROM_AIR = 0
_PGNS = {1: 129038, 2: 129038, 3: 129038, 5: 129794, 18: 129039}
_PARTS = (129809, 129810)

AIS = (*dict.fromkeys(_PGNS.values()), *_PARTS)
"""PGNs that a node sends when a message was received."""


def traffic(received: Fields) -> Message | None:
    """Return a message of AIS, fields by pyais's names, as a PGN; None if it has none."""
    kind = received["msg_type"]
    pgn = _PARTS[received["partno"] != 0] if kind == 24 else _PGNS.get(kind)
    if pgn is None:
        return None
    fields = {
        "messageId": kind,
        "repeatIndicator": received.get("repeat", 0),
        "userId": received["mmsi"],
        "aisTransceiverInformation": _FROM_AIR,
    }
    if pgn in (129038, 129039):
        fields |= _moving(received)
    if pgn == 129038:
        fields |= {
            "rateOfTurn": _turn(received["turn"]),
            "navStatus": int(received["status"]),
            "specialManeuverIndicator": int(received["maneuver"]),
        }
    elif pgn == 129039:
        fields |= {
            "unitType": int(received["cs"]),
            "integratedDisplay": int(received["display"]),
            "dsc": int(received["dsc"]),
            "band": int(received["band"]),
            "canHandleMsg22": int(received["msg22"]),
            "aisMode": int(received["assigned"]),
            "aisCommunicationState": received["radio"] >> 19,
        }
    elif pgn == 129794:
        fields |= {
            "imoNumber": received["imo"] or None,
            "name": received["shipname"],
            "draft": received["draught"] or None,
            "destination": received["destination"],
            "aisVersionIndicator": int(received["ais_version"]),
            "gnssType": int(received["epfd"]),
            "dte": int(received["dte"]),
            **_hull(received),
        }
    elif pgn == 129809:
        fields |= {"name": received["shipname"]}
    else:
        fields |= {"vendorId": str(received["vendorid"]), **_hull(received)}
    return Message(pgn, fields)


def _moving(received: Fields) -> Fields:
    """Return what both classes report; "not available" of AIS is that of NMEA 2000 too."""
    latitude, longitude = received["lat"], received["lon"]
    there = abs(latitude) <= 90.0 and abs(longitude) <= 180.0
    course, heading, speed = received["course"], received["heading"], received["speed"]
    return {
        "longitude": longitude if there else None,
        "latitude": latitude if there else None,
        "positionAccuracy": int(received["accuracy"]),
        "raim": int(received["raim"]),
        "timeStamp": received["second"],
        "cog": math.radians(course) if course < 360.0 else None,
        "sog": speed * _KNOT if speed < 102.25 else None,
        # As bytes: the package writes no other value of 19 bits, and shifts what follows.
        "communicationState": (received["radio"] & 0x7FFFF).to_bytes(3, "little"),
        "heading": math.radians(heading) if heading < 360 else None,
    }


def _turn(rate: Any) -> float | None:
    """Return a rate of turn, deg/min, in rad/s; its whole numbers 127 and 128 say other things."""
    if rate in (127, -127, 128, -128):
        return None
    return math.radians(float(rate)) / 60.0


def _hull(received: Fields) -> Fields:
    bow, stern = received["to_bow"], received["to_stern"]
    port, starboard = received["to_port"], received["to_starboard"]
    return {
        "callsign": received["callsign"],
        "typeOfShip": int(received["ship_type"]),
        "length": float(bow + stern) or None,
        "beam": float(port + starboard) or None,
        "positionReferenceFromStarboard": float(starboard),
        "positionReferenceFromBow": float(bow),
    }


_HEADINGS = {129038: "heading", 129039: "heading", 129040: "trueHeading"}
_LENGTHS = {129041: ("lengthDiameter", "beamDiameter")}
_NAMES = {129040: "name", 129041: "atonName", 129794: "name", 129809: "name"}

AIS_PGNS = (129038, 129039, 129040, 129041, 129794, 129809, 129810)
"""PGNs about other ships, stations and marks."""


def report(pgn: int, fields: Fields) -> dict[str, Any] | None:
    """Return the report of a message of `AIS_PGNS`, None for one that names no station."""
    if fields.get("userId") is None:
        return None
    found = {"mmsi": int(fields["userId"])}
    length, beam = _LENGTHS.get(pgn, ("length", "beam"))
    given: dict[str, Any] = {
        "latitude": fields.get("latitude"),
        "longitude": fields.get("longitude"),
        "course": fields.get("cog"),
        "speed": fields.get("sog"),
        "heading": fields.get(_HEADINGS.get(pgn, "")),
        "length": fields.get(length),
        "beam": fields.get(beam),
        "name": str(fields.get(_NAMES.get(pgn, "")) or "").strip(" @\0"),
    }
    return found | {name: value for name, value in given.items() if value not in (None, "")}
