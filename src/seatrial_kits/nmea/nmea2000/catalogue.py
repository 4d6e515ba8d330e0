"""Messages that a node sends and reads: names, priorities and intervals of the standard."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, unknown

DATA_FILES = ("catalogue.toml",)


@dataclass(frozen=True, slots=True)
class Field:
    """A field that a node fills or reads: its name at canboat, our ports, and its sense."""

    name: str
    sent: str = ""
    """Input or parameter that it comes from."""
    received: str = ""
    """Output that it goes to."""
    sense: str = ""


@dataclass(frozen=True, slots=True)
class Pgn:
    """A kind of message. ``interval_s`` is 0 for what goes on request or on occasion."""

    number: int
    id: str
    title: str
    priority: int
    interval_s: float = 0.0
    fields: tuple[Field, ...] = ()


def _messages(table: dict[str, Any]) -> dict[int, Pgn]:
    fields = {number: each.pop("fields", ()) for number, each in table.items()}
    return {
        int(number): Pgn(int(number), **each, fields=tuple(Field(**f) for f in fields[number]))
        for number, each in table.items()
    }


_TABLES = tomllib.loads(Path(__file__).with_name("catalogue.toml").read_text("utf-8"))
DATA, READ, NETWORK = (_messages(_TABLES[name]) for name in ("data", "read", "network"))
"""Messages by number: about the vessel and what is round it; those that a node only reads; about
the network, which every node sends and reads."""

ALL = {**DATA, **READ, **NETWORK}

READABLE = dict(sorted((DATA | READ).items()))
"""Messages about the vessel and what is round it, those that a node only reads too."""

RECEIVED = tuple(n for n, pgn in READABLE.items() if any(f.received for f in pgn.fields))
"""Messages about the vessel that a node reads."""


def sends(text: str) -> list[int]:
    """Return the PGNs of ``sends``, separated by spaces.

    Raises InputError, with near misses, for one that a node cannot send, and for doubles.
    """
    found = []
    for word in text.split():
        if word not in map(str, DATA):
            raise InputError(f"sends: {unknown('PGN', word, map(str, DATA))}")
        if int(word) in found:
            raise InputError(f"sends: {word} is there twice")
        found.append(int(word))
    return found


def intervals(text: str) -> dict[int, float]:
    """Return the intervals (s) of ``PGN SECONDS; PGN SECONDS``; 0: only on request.

    Raises InputError for one that cannot be.
    """
    found = {}
    for part in filter(None, map(str.strip, text.split(";"))):
        number, _, written = part.partition(" ")
        (pgn,) = sends(number)
        try:
            seconds = float(written)
        except ValueError:
            seconds = -1.0
        if seconds != 0.0 and not 0.01 <= seconds <= 3600.0:
            raise InputError(
                f"intervals: {part!r} is not PGN SECONDS, such as '127250 0.2'; allowed 0.01 to "
                "3600 s, and 0 for only on request"
            )
        found[pgn] = seconds
    return found
