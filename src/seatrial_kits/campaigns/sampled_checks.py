"""Cases of a campaign checked before the first one runs: all, or of many those at the edges."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from seatrial.trial.running.hooks import Hooks

from .asked import Asked
from .case_list import Block, Cases
from .distributions import number_and_unit
from .evaluator import Evaluator, Plan

MOST = 200
"""Cases that are all checked: a check takes as long as a start."""


def check(cases: Cases | Asked, plan: Plan, hooks: Hooks) -> bool:
    """Return whether a case must run alone: it keeps to wall time, or has links.

    Of more than `MOST` cases those are checked that have the least or the greatest number of a
    key, or one of its texts; a limit that only others break makes them failed cases. Raises what
    `Supervisor.check` raises.
    """
    numbers: Iterable[int] = range(len(cases))
    if isinstance(cases, Cases) and len(cases) > MOST:
        numbers = sorted(set(_edges(cases)))
    with Evaluator(cases, plan, hooks) as evaluator:
        alone = [evaluator.check(number) for number in numbers]
    return any(alone)


def _edges(cases: Cases) -> Iterator[int]:
    first = 0
    for block in cases.blocks:
        yield from (first + number for number in _edges_of(block))
        first += len(block)


def _edges_of(block: Block) -> Iterator[int]:
    """Yield numbers of cases, in the block, that have each axis at its ends."""
    yield from (0, len(block) - 1)
    below = len(block.scales)
    yield from range(below)
    yield from (place * below for place in range(len(block.crossed)))
    below *= len(block.crossed)
    for key in block.rows[0]:
        values = [row[key] for row in block.rows]
        yield from (place * below for place in _ends(values))
    below *= len(block.rows)
    for key in reversed(list(block.grid)):
        values = list(block.grid[key])
        yield from (place * below for place in _ends(values))
        below *= len(values)


def _ends(values: list[Any]) -> list[int]:
    """Return the places of the least and the greatest number, and of each other value."""
    sizes = {place: size for place, v in enumerate(values) if (size := _size(v)) is not None}
    others = {repr(v): place for place, v in enumerate(values) if place not in sizes}
    ends = [min(sizes, key=sizes.__getitem__), max(sizes, key=sizes.__getitem__)] if sizes else []
    return [*others.values(), *ends]


def _size(value: Any) -> float | None:
    if isinstance(value, str):
        number, unit = number_and_unit(value)
        return None if unit is None else number
    return float(value) if isinstance(value, (int, float)) else None
