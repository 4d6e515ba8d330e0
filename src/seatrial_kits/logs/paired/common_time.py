"""Quantities of different rates on one time axis."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Array
from seatrial.trial.logs.quantities import Series

FASTEST = 30.0
"""rad/s; an angle that turns faster is not in radians."""
GAP = 5.0
"""Usual time steps; a longer one is a gap."""
_LEAST_SHARE = 0.95
"""Of the record that a quantity must cover to be used."""
_WRAP_SLACK = 0.5

Window = tuple[float, float]
WHOLE: Window = (-math.inf, math.inf)


@dataclass(frozen=True, eq=False)
class Together:
    """Quantities at the same times: arrays (n,)."""

    time: Array
    values: Mapping[str, Array]
    place: Callable[[int], str]
    """Place of a row in the file, for messages: the entry of the axis that it is from."""
    notes: tuple[str, ...] = ()


def together(
    found: Mapping[str, Series],
    axis: str,
    needed: Iterable[str] = (),
    window: Window = WHOLE,
    *,
    even: bool = False,
) -> Together:
    """Return quantities at the instants of one of them, ``axis``; ``even``: at its usual period.

    Quantities that have the same times, and the rows of a table, are taken as they are. Others are
    interpolated between their own neighbours, angles after they are unwrapped: by a monotone cubic
    (PCHIP; no value lies beyond its neighbours), an order by its last value. No value is
    extrapolated: the record is cut to the part that all have. A quantity that is not ``needed`` and
    covers less than 95 % of the rest is left out, with a note.

    Raises InputError, with places, for times that do not rise (entries of equal time are left out
    with a note, but for tables), gaps longer than five usual steps, angles as `unwrapped` does,
    and quantities that have no time in common.
    """
    notes: list[str] = []
    rising = {what: _rising(_within(each, window), notes) for what, each in found.items()}
    main = rising[axis]
    alike = all(np.array_equal(each.time, main.time) for each in rising.values())
    parts = rising if alike else _cover(rising, {axis, *needed}, notes)
    first = max(window[0], *(float(each.time[0]) for each in parts.values()))
    last = min(window[1], *(float(each.time[-1]) for each in parts.values()))
    inside = np.flatnonzero((main.time >= first) & (main.time <= last))
    if not len(inside):
        spans = "; ".join(map(_span, parts.values()))
        raise InputError(f"{main.log.path}: no time is common to {spans}")
    for each in [main] if alike else parts.values():
        _check_gaps(each, first, last)
    time, at = main.time[inside], main.at(inside)
    if alike and (main.log.table or not even):
        values = {what: each.values[inside] for what, each in parts.items()}
        return Together(time, values, at.instant, tuple(notes))
    if even:
        time = np.arange(time[0], time[-1] + 1e-9, float(np.median(np.diff(time))))
    values = {what: _interpolated(each, time) for what, each in parts.items()}

    def place(row: int) -> str:
        return at.instant(int(np.searchsorted(at.time, time[row])))

    return Together(time, values, place, tuple(notes))


def unwrapped(time: Array, angle: Array, place: Callable[[int], str]) -> Array:
    """Return an angle (n,), rad, without its jumps by whole turns.

    Raises InputError where it turns by more than 90 deg from one value to the next, for turns
    cannot be counted there, or faster than 30 rad/s (degrees in the place of radians).
    """
    steps, elapsed = np.diff(angle), np.diff(time)
    turned = np.remainder(steps + math.pi, math.tau) - math.pi
    # One wrap from a row to the next is an angle that starts anew; more is another unit.
    wrong = np.flatnonzero(
        (np.abs(steps) > math.tau + _WRAP_SLACK) | (np.abs(turned) > FASTEST * elapsed)
    )
    if len(wrong):
        row = int(wrong[0])
        raise InputError(
            f"{place(row + 1)}: {angle[row]:g} rad to {angle[row + 1]:g} rad from {time[row]:g} s "
            f"to {time[row + 1]:g} s: more than {FASTEST:g} rad/s; is it in degrees?"
        )
    fast = np.flatnonzero(np.abs(turned) > math.pi / 2)
    if len(fast):
        row = int(fast[0])
        raise InputError(
            f"{place(row + 1)}: it turns by {math.degrees(turned[row]):.4g} deg from {time[row]:g} "
            f"s to {time[row + 1]:g} s; up to 90 deg can be distinguished from a turn the other "
            "way: more rows are needed, or it is in degrees"
        )
    return np.concatenate(([angle[0]], angle[0] + np.cumsum(turned)))


def _within(each: Series, window: Window) -> Series:
    """Return the part in a window, with one neighbour on each side of it to interpolate from."""
    if window == WHOLE:
        return each
    inside = np.flatnonzero((each.time >= window[0]) & (each.time <= window[1]))
    if not len(inside):
        ends = zip(("from", "to"), window, strict=True)
        asked = " ".join(f"{word} {end:g} s" for word, end in ends if math.isfinite(end))
        raise InputError(f"{each.log.path}: {_span(each)}: no value {asked}")
    return each.at(slice(max(int(inside[0]) - 1, 0), int(inside[-1]) + 2))


def _rising(each: Series, notes: list[str]) -> Series:
    """Return a quantity whose time rises; raises InputError where it cannot be made so."""
    steps = np.diff(each.time)
    if each.log.table or not np.any(steps == 0.0):
        kept = each
    else:
        kept = each.at(np.concatenate(([True], steps != 0.0)))
        notes.append(
            f"{each.what} ({each.channel.name}): {len(each.time) - len(kept.time)} entries with "
            "the time of the one before are left out"
        )
    back = np.flatnonzero(np.diff(kept.time) <= 0.0)
    if len(back):
        row = int(back[0])
        raise InputError(
            f"{kept.instant(row + 1)}: the time goes from {kept.time[row]:g} s to "
            f"{kept.time[row + 1]:g} s; time must rise"
        )
    return kept


def _cover(found: Mapping[str, Series], needed: set[str], notes: list[str]) -> dict[str, Series]:
    """Return the quantities that cover the part that the needed ones have."""
    first = max(found[what].time[0] for what in needed)
    last = min(found[what].time[-1] for what in needed)
    parts = {}
    for what, each in found.items():
        covered = min(each.time[-1], last) - max(each.time[0], first)
        if what in needed or covered >= _LEAST_SHARE * (last - first):
            parts[what] = each
        else:
            notes.append(f"{_span(each)} is left out: it covers too little")
    return parts


def _check_gaps(each: Series, first: float, last: float) -> None:
    if each.quantity.held or len(each.time) < 2:
        return
    steps = np.diff(each.time)
    usual = float(np.median(steps))
    concerned = (each.time[1:] > first) & (each.time[:-1] < last)
    gaps = np.flatnonzero((steps > GAP * usual) & concerned)
    if len(gaps):
        row = int(gaps[0])
        missing = round(steps[row] / usual) - 1
        raise InputError(
            f"{each.instant(row + 1)}: a gap from {each.time[row]:g} s to {each.time[row + 1]:g} "
            f"s: {missing} rows missing; they are usually {usual:g} s apart, up to {GAP:g} times "
            "that is allowed"
        )


def _interpolated(each: Series, time: Array) -> Array:
    if np.array_equal(each.time, time):
        return each.values
    if each.quantity.held:
        return each.values[np.searchsorted(each.time, time, side="right") - 1]
    values = each.values
    if each.quantity.wraps:
        values = unwrapped(each.time, values, each.place)
    if len(each.time) < 2:
        return np.full(len(time), values[0])
    return np.asarray(PchipInterpolator(each.time, values)(time), np.float64)


def _span(each: Series) -> str:
    return f"{each.what} ({each.channel.name}, from {each.time[0]:g} s to {each.time[-1]:g} s)"
