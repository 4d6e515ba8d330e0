"""Group functions of NMEA 2000 (126208): requests for other intervals, and commands."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

from nmea2000.backend import DATABASE

from .catalogue import DATA
from .codec import GLOBAL, Message

COMMANDED = {
    127237: {
        "steeringMode": "steering_mode",
        "headingReference": "",
        "commandedRudderAngle": "commanded_rudder",
        "headingToSteerCourse": "heading_to_steer",
        "track": "track",
    },
    127245: {"instance": "", "directionOrder": "rudder_direction", "angleOrder": "rudder_order"},
}
"""Fields that other nodes may command: their quantities (`Received`), none if they say which."""
Obey = Callable[[Message, Sequence[str]], tuple[list[str], list[str]]]
"""Carries out a command as `Received.command` does."""
_REQUEST, _COMMAND = "nmeaRequestGroupFunction", "nmeaCommandGroupFunction"
_OK, _NOT_SUPPORTED, _NOT_AVAILABLE = 0, 1, 2
_INTERVAL_NOT_SUPPORTED, _INTERVAL_TOO_LOW = 1, 2
_INVALID, _OUT_OF_RANGE, _DENIED, _NO_PARAMETER = 1, 3, 4, 5
_UNCHANGED_S, _STANDARD_S = 4294967.295, 4294967.294
"""Intervals that are none: all ones, and all ones but the last bit."""
_LEAST_S = 0.01


def serve(
    message: Message, sends: Sequence[int], change: Callable[[int, float], None], obey: Obey
) -> tuple[list[Message], list[int]]:
    """Carry out a group function addressed to this node, or to all.

    Returns answers, and PGNs to send now. A request for a PGN that the node sends sends it, and
    ``change(pgn, seconds)`` sets its interval, if it names one: 0 stops it, 'standard' is the
    standard's. A command for the fields of `COMMANDED` in a PGN that the node sends goes to
    ``obey``, and each field's error code says whether it was carried out. What was addressed to all
    is not answered.
    """
    pgn = message.fields.get("pgn")
    if message.id == _REQUEST and pgn is not None:
        error, interval_error = _requested(message, pgn, sends, change)
        due = [pgn] if (error, interval_error) == (_OK, _OK) else []
        return _answer(message, pgn, error, interval_error), due
    if message.id == _COMMAND and pgn is not None:
        if pgn not in COMMANDED:
            return _answer(message, pgn, _NOT_SUPPORTED), []
        if pgn not in sends:
            return _answer(message, pgn, _NOT_AVAILABLE), []
        return _answer(message, pgn, _OK, parameters=_commanded(message, pgn, obey)), []
    return [], []


def _requested(
    message: Message, pgn: int, sends: Sequence[int], change: Callable[[int, float], None]
) -> tuple[int, int]:
    if pgn not in sends:
        return _NOT_AVAILABLE if pgn in DATA else _NOT_SUPPORTED, _OK
    interval = message.fields.get("transmissionInterval")
    if interval is None or interval >= _UNCHANGED_S:
        return _OK, _OK
    if interval >= _STANDARD_S:
        interval = DATA[pgn].interval_s
    if 0.0 < interval < _LEAST_S:
        return _OK, _INTERVAL_TOO_LOW
    if interval > 3600.0:
        return _OK, _INTERVAL_NOT_SUPPORTED
    change(pgn, float(interval))
    return _OK, _OK


def _commanded(message: Message, pgn: int, obey: Obey) -> list[int]:
    """Carry out a command; return the error code of each of its fields."""
    items = message.items or ({k: message.fields.get(k) for k in ("parameter", "value")},)
    names, known = _names(pgn), COMMANDED[pgn]
    named = [names.get(item.get("parameter", 0), "") for item in items]
    given = zip(named, items, strict=True)
    fields = {name: item.get("value") for name, item in given if name in known}
    order = Message(pgn, fields, message.source)
    obeyed, held = obey(order, [known[name] for name in fields if known[name]])

    def error(name: str) -> int:
        if name not in known:
            return _NO_PARAMETER if name else _INVALID
        if known[name] in obeyed or (obeyed and not known[name]):
            return _OK
        return _DENIED if known[name] in held else _OUT_OF_RANGE

    return [error(name) for name in named]


@cache
def _names(pgn: int) -> dict[int, str]:
    """Return the fields of a PGN: group functions count them from 1, reserved ones included."""
    return dict(enumerate((field.id for field in DATABASE.pgn_variants(pgn)[0].fields), start=1))


def _answer(
    message: Message,
    pgn: int,
    error: int,
    interval_error: int = _OK,
    parameters: Sequence[int] = (),
) -> list[Message]:
    if message.destination == GLOBAL:
        return []
    fields = {
        "pgn": pgn,
        "pgnErrorCode": error,
        "transmissionIntervalPriorityErrorCode": interval_error,
        "numberOfParameters": len(parameters),
    }
    items = tuple({"parameter": each} for each in parameters)
    return [Message(126208, fields, destination=message.source, items=items)]
