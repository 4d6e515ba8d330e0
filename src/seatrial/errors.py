"""Errors for the user of seatrial."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

INTERRUPTED = "interrupted by the user"
"""Message of a component that a signal interrupted; a message crosses the FMI, an exception not."""
_MOST_LISTED = 30
_NEAREST, _LIKE = 10, 0.4
"""Shown names of a long list: their number, and their least likeness (difflib's ratio)."""


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
    """Return 'unknown WHAT FOUND' with what is allowed, of very many names those most like it.

    >>> unknown("port", "atitude", ["attitude", "force"])
    "unknown port 'atitude'; did you mean 'attitude'? (known: attitude, force)"
    """
    names = sorted(set(allowed))
    near = difflib.get_close_matches(str(found), names, n=_NEAREST, cutoff=_LIKE)
    meant = difflib.get_close_matches(str(found), near, n=2, cutoff=0.6)
    hint = f"; did you mean {' or '.join(map(repr, meant))}?" if meant else ";"
    if len(names) > _MOST_LISTED and near:
        known = f"{', '.join(near)}, ... ({len(names)} in all)"
    else:
        known = listed(names) or "none"
    return f"unknown {what} {str(found)!r}{hint} (known: {known})"


def unmatched(what: str, pattern: str, names: Sequence[str]) -> str:
    """Return 'no WHAT matches PATTERN' with the names that are most like it.

    >>> unmatched("signal", "hul.*", ["hull.force", "servo.angle"])
    "no signal matches 'hul.*'; did you mean 'hull.force'? (known: hull.force, servo.angle)"
    """
    said = unknown(what, pattern, names).removeprefix(f"unknown {what} {pattern!r}")
    return f"no {what} matches {pattern!r}{said}"


def listed(names: Sequence[str]) -> str:
    """Return names for a message: all of a few, of very many the first and their number."""
    rest = f", ... ({len(names)} in all)" if len(names) > _MOST_LISTED else ""
    return ", ".join(names[:_MOST_LISTED]) + rest
