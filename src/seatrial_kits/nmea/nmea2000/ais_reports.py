"""AIS messages of other ships as reports of `received.targets`."""

from __future__ import annotations

from typing import Any

from .codec import Fields

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
