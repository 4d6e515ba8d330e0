"""Channels of a log at other times than their own."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError
from seatrial.model.units import conversion, unit
from seatrial.trial.logs.channels import Array, Log
from seatrial.trial.logs.quantities import QUANTITIES, Column, Quantity, Series, defaults, series

from .common_time import GAP

HELD_MOST = 16
"""A channel of a log that is no table, with so few different values, is a state that is held."""
_SLACK = 0.01
"""rad by which a turn may be exceeded: rounding of values."""
_BLOCK = 1 << 16
"""Instants that are looked up at once: a long log takes no more memory than its values."""


@dataclass(frozen=True, eq=False)
class Trace:
    """One channel in its unit, ready to be had at any time: arrays (n,)."""

    name: str
    unit: str
    time: Array
    values: Array
    """Angles without their jumps by whole turns."""
    held: bool
    gap: float
    """Two entries further apart, s, have nothing between them."""

    @cached_property
    def usual(self) -> float:
        """Usual time from an entry to the next, s; 0 for one entry."""
        return usual_time(self.time, 0.0)

    def at(self, times: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return values at rising ``times``, and whether each is known.

        Linear between two entries, or the last one's where it is held. Before the first entry, in
        a gap and, but for what is held, after the last the nearest earlier one stands, and is not
        known. At the trace's own times the values are not copied.
        """
        if times is self.time:
            return self.values, np.ones(len(times), np.bool_)
        found, known = np.empty(len(times)), np.empty(len(times), np.bool_)
        for first in range(0, len(times), _BLOCK):
            block = slice(first, first + _BLOCK)
            found[block], known[block] = self._block(times[block])
        return found, known

    def _block(self, times: Array) -> tuple[Array, NDArray[np.bool_]]:
        before = np.clip(np.searchsorted(self.time, times, side="right") - 1, 0, None)
        after = np.minimum(before + 1, len(self.time) - 1)
        found = self.values[before].copy()
        inside = (times >= self.time[0]) & (self.held | (times <= self.time[-1]))
        apart = self.time[after] - self.time[before]
        known = inside & ((apart <= self.gap) | (times == self.time[before]))
        if not self.held:
            between = known & (apart > 0.0) & (times > self.time[before])
            share = (times[between] - self.time[before[between]]) / apart[between]
            low, high = self.values[before[between]], self.values[after[between]]
            found[between] = low + (high - low) * share
        return found, known


def trace(log: Log, name: str, column: Column, *, unit_needed: bool = False) -> Trace:
    """Return a channel, in its own unit, or a quantity, in that of `QUANTITIES`.

    ``name`` is what the trace is called. Raises InputError for a channel that there is not, or
    that has no value, a unit that is none or not the file's, and, if ``unit_needed``, none.
    """
    own = column.name.removeprefix("-") if column.name not in log.channels else column.name
    channel = log.channel(own)
    said = column.unit or channel.unit
    if said is None and unit_needed:
        raise InputError(
            f"{log.path}: {log.noun} {own!r}: the file does not say its unit: {name}={own}:UNIT"
        )
    try:
        unit(said or "1")
    except InputError as error:
        raise InputError(f"{log.path}: {log.noun} {own!r}: {error}") from None
    found = series(log, name, column, Quantity("a channel", said or "1"))
    held = _is_held(log, found.values, said or "1")
    return _made(name, said or "1", found.time, found.values, held=held)


def served(log: Log, what: str, column: Column | None = None) -> Trace | None:
    """Return the quantity ``what`` in its unit, None where the log does not have it.

    Raises InputError as `quantities.series` does, and for an angle that changes by more than a
    turn from one entry to the next.
    """
    column = column or defaults(log).get(what)
    if column is None:
        return None
    found, quantity = series(log, what, column), QUANTITIES[what]
    if quantity.wraps:
        _check_turns(found)
    return _made(what, quantity.unit, found.time, found.values, held=quantity.held)


def _check_turns(found: Series) -> None:
    steps = np.diff(found.values)
    np.abs(steps, out=steps)
    turned = np.flatnonzero(steps > math.tau + _SLACK)
    usual = usual_time(found.time, math.inf) if len(turned) else math.inf
    for row in turned.tolist():
        if found.time[row + 1] - found.time[row] <= GAP * usual:
            raise InputError(
                f"{found.place(row + 1)}: {found.what} goes from {found.values[row]:g} rad to "
                f"{found.values[row + 1]:g} rad, more than a turn; is it in degrees? (--columns "
                f"{found.what}={found.channel.name}:deg, where the file does not say the unit)"
            )


def _made(name: str, said: str, time: Array, values: Array, *, held: bool) -> Trace:
    """Return a trace of entries in the order of their times."""
    if not np.all(time[1:] > time[:-1]):
        order = np.argsort(time, kind="stable")
        time, values = time[order], values[order]
        kept = np.append(np.diff(time) > 0.0, True)[: len(time)]
        time, values = time[kept], values[kept]
    gap = math.inf if held else GAP * usual_time(time, math.inf)
    return Trace(name, said, time, unwrapped(values, said), held, gap)


def usual_time(time: Array, alone: float) -> float:
    """Return the median time, s, from an entry (n,) to the next; ``alone`` for less than two."""
    return float(np.median(np.diff(time), overwrite_input=True)) if len(time) > 1 else alone


def unwrapped(values: Array, said: str) -> Array:
    """Return an angle without jumps of more than half a turn; other values as they are."""
    turn = turn_of(said)
    if turn is None or len(values) < 2:
        return values
    turns = np.diff(values)  # in place: np.unwrap takes five times the memory of the values
    turns /= turn
    np.rint(turns, out=turns)
    if not turns.any():
        return values
    np.cumsum(turns, out=turns)
    turns *= turn
    found = values.copy()
    found[1:] -= turns
    return found


def turn_of(said: str) -> float | None:
    """Return a whole turn in a unit of angles, None for other units."""
    if said in ("", "1", "%"):
        return None
    try:
        return math.tau * conversion("rad", said)[0]
    except InputError:
        return None


def _is_held(log: Log, values: Array, said: str) -> bool:
    """Say if a channel is a state: whole numbers without a unit, few of them."""
    if said not in ("", "1") or not np.array_equal(values, np.round(values)):
        return False
    return len(np.unique(values[:100_000])) <= HELD_MOST
