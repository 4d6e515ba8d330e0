"""Group functions of NMEA 2000 (126208): requests for other intervals, and commands."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

from nmea2000.backend import DATABASE

from .catalogue import DATA
from .codec import GLOBAL, Message

COMMANDED = (127237, 127245)
"""PGNs whose fields other nodes may command."""
_REQUEST, _COMMAND = "nmeaRequestGroupFunction", "nmeaCommandGroupFunction"
_OK, _NOT_SUPPORTED, _NOT_AVAILABLE = 0, 1, 2
_INTERVAL_NOT_SUPPORTED, _INTERVAL_TOO_LOW = 1, 2
_PARAMETER_INVALID = 1
_UNCHANGED_S, _STANDARD_S = 4294967.295, 4294967.294
"""Intervals that are none: all ones, and all ones but the last bit."""
_LEAST_S = 0.01


def serve(
    message: Message, sends: Sequence[int], change: Callable[[int, float], None]
) -> tuple[list[Message], list[int], Message | None]:
    """Carry out a group function addressed to this node, or to all.

    Returns answers, PGNs to send now, and what was commanded as a message like any other (of the
    same source). A request for a PGN that the node sends sends it, and ``change(pgn, seconds)``
    sets its interval, if it names one: 0 stops it, 'standard' is the standard's. Commands are
    carried out for the fields of `COMMANDED`. Requests to all are not answered.
    """
    pgn = message.fields.get("pgn")
    if message.id == _REQUEST and pgn is not None:
        error, interval_error = _requested(message, pgn, sends, change)
        due = [pgn] if (error, interval_error) == (_OK, _OK) else []
        return _answer(message, pgn, error, interval_error), due, None
    if message.id == _COMMAND and pgn is not None:
        if pgn not in COMMANDED:
            return _answer(message, pgn, _NOT_SUPPORTED), [], None
        fields, wrong = _commanded(message, pgn)
        commanded = Message(pgn, fields, message.source) if fields else None
        return _answer(message, pgn, _OK, parameters=wrong), [], commanded
    return [], [], None


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


def _commanded(message: Message, pgn: int) -> tuple[dict[str, Any], list[int]]:
    names, fields, wrong = _names(pgn), {}, []
    items = message.items or ({k: message.fields.get(k) for k in ("parameter", "value")},)
    for item in items:
        number = item.get("parameter")
        known = isinstance(number, int) and 1 <= number <= len(names)
        wrong.append(_OK if known else _PARAMETER_INVALID)
        if known:
            fields[names[number - 1]] = item.get("value")  # type: ignore[operator]
    return fields, wrong


@cache
def _names(pgn: int) -> tuple[str, ...]:
    """Return the fields of a PGN: group functions count them from 1, reserved ones included."""
    return tuple(field.id for field in DATABASE.pgn_variants(pgn)[0].fields)


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
