"""Zig-zag and initial turning: figures of IMO MSC/Circ.1053 and ITTC 7.5-04-02-01."""

from __future__ import annotations

import math

from seatrial.errors import InputError

from .crossings import check_approach, crossing, largest, order_time, side_of
from .record import Record
from .result import Collector, Figures
from .turning import heading_change

MOST = 4
"""Overshoots that are reported."""


def zig_zag(record: Record, heading: float, order: float | None = None) -> Figures:
    """Return the figures of a zig-zag, its helm reversed at heading changes of +-``heading``.

    ``heading`` in rad, above 0; ``order`` is the time of the first order, s, None: `order_time`.
    psi is the heading change since the first order, positive to its side; the k-th reversal is
    where psi reaches +heading (k odd) or -heading (k even).

    ===================== ==================================================================
    initial_turning_time  from the order to the first reversal, s; initial_turning_track the
                          distance run until then, m
    reversal_k_time       from the order to the k-th reversal, s
    overshoot_k           largest heading beyond the heading of the k-th reversal, rad
    time_to_check_yaw_k   from the k-th reversal to the largest heading, s
    overshoot_time_k      from the k-th reversal until the heading is back at its value there, s
    reach                 from the order to the first return to the heading at the order, s
    period                from the order to the second return, s
    ===================== ==================================================================

    Lateness of a helmsman is part of the overshoot. Raises InputError for a record that starts in
    a turn, a ``heading`` not above 0, and a record that does not reach the first reversal.
    """
    check_heading(heading)
    order = order_time(record) if order is None else order
    check_approach(record, order)
    side, found = side_of(record, order), Collector("zig-zag")
    reversals = _reversals(record, heading, order, side)
    _lack_later(found, len(reversals), heading)
    if reversals:
        found.add("s", initial_turning_time=reversals[0] - order)
        found.add("m", initial_turning_track=record.track(order, reversals[0]))
    for number, at in enumerate(reversals[:MOST], 1):
        until = reversals[number] if number < len(reversals) else record.end
        towards = side if number % 2 else -side
        _overshoot(record, order, (number, at, until), towards, heading, found)
    _returns(record, order, side, reversals, found)
    return found.figures()


def initial_turning(
    record: Record, heading: float = math.radians(10.0), order: float | None = None
) -> Figures:
    """Return distance run, m, and time, s, when the heading has changed by ``heading``, rad.

    IMO MSC.137(76) wants a change of 10 deg with 10 deg of helm. ``order`` as for `zig_zag`. Raises
    InputError for a record that starts in a turn or whose heading does not change by that.
    """
    check_heading(heading)
    order = order_time(record) if order is None else order
    check_approach(record, order)
    psi = heading_change(record, order, side_of(record, order))
    found, at = Collector("initial turning"), crossing(psi, heading, order, record.end)
    if at is None:
        found.lack(f"the heading never changes by {math.degrees(heading):.4g} deg",
                   "initial_turning_track", "initial_turning_time")  # fmt: skip
    else:
        found.add("m", initial_turning_track=record.track(order, at))
        found.add("s", initial_turning_time=at - order)
    return found.figures()


def check_heading(heading: float) -> None:
    """Raise InputError for a heading change that is none, or no angle in rad."""
    if not 0.0 < heading <= math.pi:
        raise InputError(f"heading: an angle above 0 up to pi rad is needed, found {heading:g}")


def _reversals(record: Record, heading: float, order: float, side: float) -> list[float]:
    """Return the instants at which the heading reaches +heading, -heading, +heading, ..."""
    reversals: list[float] = []
    after, towards = order, side
    while at := crossing(heading_change(record, order, towards), heading, after, record.end):
        reversals.append(at)
        after, towards = at, -towards
    return reversals


def _overshoot(
    record: Record,
    order: float,
    stretch: tuple[int, float, float],
    towards: float,
    heading: float,
    found: Collector,
) -> None:
    number, at, until = stretch
    psi = heading_change(record, order, towards)
    peak, value = largest(psi, at, until)
    found.add("s", **{f"reversal_{number}_time": at - order})
    if peak == until:
        found.lack(
            "the record ends while the heading still overshoots",
            *(f"{name}_{number}" for name in ("overshoot", "time_to_check_yaw", "overshoot_time")),
        )
        return
    found.add("rad", **{f"overshoot_{number}": value - heading})
    found.add("s", **{f"time_to_check_yaw_{number}": peak - at})
    back = crossing(psi, heading, peak, until)
    if back is None:
        found.lack("the record ends before the heading is back", f"overshoot_time_{number}")
    else:
        found.add("s", **{f"overshoot_time_{number}": back - at})


def _lack_later(found: Collector, reversals: int, heading: float) -> None:
    for number in range(reversals + 1, MOST + 1):
        names = [f"{name}_{number}" for name in ("overshoot", "time_to_check_yaw",
                 "overshoot_time")]  # fmt: skip
        if number == 1:
            names += ["initial_turning_time", "initial_turning_track"]
        sign = "" if number % 2 else "-"
        found.lack(
            f"the heading change does not reach {sign}{math.degrees(heading):.4g} deg "
            f"for reversal {number}",
            f"reversal_{number}_time",
            *names,
        )


def _returns(
    record: Record, order: float, side: float, reversals: list[float], found: Collector
) -> None:
    psi = heading_change(record, order, side)
    for name, number in (("reach", 1), ("period", 2)):
        at = None
        if len(reversals) >= number:
            at = crossing(psi, 0.0, reversals[number - 1], record.end)
        if at is None:
            found.lack(f"the heading does not return after reversal {number}", name)
        else:
            found.add("s", **{name: at - order})
