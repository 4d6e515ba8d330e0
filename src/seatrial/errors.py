"""Errors for the user of seatrial."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

INTERRUPTED = "interrupted by the user"
"""Message of a component that a signal interrupted; a message crosses the FMI, an exception not."""
_MOST_LISTED = 30


class SeatrialError(Exception):
    """Base of every error that carries a message meant for the user."""


class InputError(SeatrialError):
    """Something the user wrote is wrong: a file, a key, a name, a unit, a value."""


class SimulationError(SeatrialError):
    """A simulation could not go on: a component raised, refused a step or produced no number."""


class FatalError(SimulationError):
    """A component is broken: nothing more may be asked of it."""


class ExcessError(SimulationError):
    """An output is not finite, or beyond what its connection may carry."""


class DiscardError(SimulationError):
    """A component could not take a step; it may take a smaller one from a restored state."""


def unknown(what: str, found: object, allowed: Iterable[str]) -> str:
    """Return 'unknown WHAT FOUND' with near misses, or with all that is allowed.

    >>> unknown("port", "atitude", ["attitude", "force"])
    "unknown port 'atitude'; did you mean 'attitude'? (known: attitude, force)"
    """
    names = sorted(set(allowed))
    near = difflib.get_close_matches(str(found), names, n=2, cutoff=0.6)
    hint = f"; did you mean {' or '.join(map(repr, near))}?" if near else ";"
    return f"unknown {what} {str(found)!r}{hint} (known: {listed(names) or 'none'})"


def listed(names: Sequence[str]) -> str:
    """Return names for a message: all of a few, of very many the first and their number."""
    rest = f", ... ({len(names)} in all)" if len(names) > _MOST_LISTED else ""
    return ", ".join(names[:_MOST_LISTED]) + rest
