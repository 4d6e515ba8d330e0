"""Formulas of signal temporal logic over predicates: what a criterion says, as a tree.

Semantics are in `robustness`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from .expressions import Units
from .predicates import Comparison, Kind, Limit, Predicate, Says, Truth

PREDICATES = (Comparison, Truth, Says)


class Interval(NamedTuple):
    """Times from ``first`` to ``last`` s after a point, or before it; ends included."""

    first: float = 0.0
    last: float | None = None
    """None: to the end of the record; of an operator of the past, to its start."""


WHOLE = Interval()
"""All of the record that is still to come, or that has been."""


@dataclass(frozen=True)
class Logic:
    """``and``, ``or``, ``not`` or ``implies``."""

    name: Literal["and", "or", "not", "implies"]
    parts: tuple[Formula, ...]


@dataclass(frozen=True)
class Temporal:
    """An operator of time with one operand; ``finally`` is the last point of the record."""

    name: Literal["always", "eventually", "once", "historically", "finally"]
    interval: Interval
    parts: tuple[Formula]


@dataclass(frozen=True)
class Until:
    """``until`` or ``since``: the second holds at some point, the first at all between."""

    name: Literal["until", "since"]
    interval: Interval
    parts: tuple[Formula, Formula]


Formula = Predicate | Logic | Temporal | Until
_FUTURE = ("always", "eventually", "finally", "until")


def predicates(node: Formula) -> Iterator[Predicate]:
    """Yield all predicates, from left to right."""
    if isinstance(node, PREDICATES):
        yield node
    else:
        for part in node.parts:
            yield from predicates(part)


def kinds(node: Formula) -> dict[str, set[Kind]]:
    """Return all signals, each with the kinds that predicates take it for."""
    found: dict[str, set[Kind]] = {}
    for predicate in predicates(node):
        for name, kind in predicate.kinds.items():
            found.setdefault(name, set()).add(kind)
    return found


def depth(node: Formula) -> int:
    """Return how many levels the tree has."""
    if isinstance(node, PREDICATES):
        return node.depth()
    return 1 + max(depth(part) for part in node.parts)


def renamed(node: Formula, names: Mapping[str, str]) -> Formula:
    """Return a formula with other names of signals."""
    if isinstance(node, PREDICATES):
        return node.renamed(names)
    parts = tuple(renamed(part, names) for part in node.parts)
    if isinstance(node, Logic):
        return Logic(node.name, parts)
    return type(node)(node.name, node.interval, parts)  # type: ignore[arg-type]


def check(node: Formula, units: Units) -> None:
    """Raise InputError if values are compared or added that do not measure the same."""
    for predicate in predicates(node):
        predicate.check(units)


def looks_ahead(node: Formula) -> bool:
    """Return whether the formula at a point depends on what comes after it."""
    if isinstance(node, PREDICATES):
        return False
    return node.name in _FUTURE or any(looks_ahead(part) for part in node.parts)


def is_timeless(node: Formula) -> bool:
    """Return whether the formula at a point depends on that point alone."""
    if isinstance(node, PREDICATES):
        return node.is_timeless
    return isinstance(node, Logic) and all(is_timeless(part) for part in node.parts)


def from_the_start(node: Formula) -> bool:
    """Return whether the formula is made of formulas that are about the run from its start on."""
    if isinstance(node, (Temporal, Until)):
        return node.name in _FUTURE
    return isinstance(node, Logic) and all(from_the_start(part) for part in node.parts)


def horizon(node: Formula) -> float:
    """Return how long after a point the record must go on for the formula to be decided, s."""
    if isinstance(node, PREDICATES):
        return 0.0
    below = max(horizon(part) for part in node.parts)
    if isinstance(node, Logic) or node.name not in _FUTURE:
        return below
    if node.interval.last is None:
        return node.interval.first
    return node.interval.last + below


def limits(node: Formula) -> list[Limit]:
    """Return the bounds on single signals; none for what is not always a plain conjunction."""
    if isinstance(node, PREDICATES):
        return node.limits()
    if node.name in ("and", "always", "finally", "eventually"):
        return [limit for part in node.parts for limit in limits(part)]
    return []
