"""Kinds of messages and their fields."""

from __future__ import annotations

from dataclasses import dataclass


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
