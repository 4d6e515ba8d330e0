"""Williamson turn, turn on the spot and station keeping: figures of handling a craft."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from seatrial.errors import InputError

from .course_stability import steady_rate
from .crossings import check_approach, crossing, order_time, side_of
from .record import Array, Record
from .result import Collector, Figure, Figures
from .turning import along_and_across, heading_change

_WITHIN = 0.95


def williamson(record: Record, order: float | None = None) -> Figures:
    """Return the figures of a Williamson turn: back on the own track on the reciprocal course.

    The heading changes by some 70 deg to one side, then by 250 deg to the other. ``turn_time``
    is from the order to a heading change of -180 deg, s; ``offset`` the distance from the approach
    track then, positive to the side of the first helm, and ``advance`` that along it, m. Raises
    InputError for a record that starts in a turn or never heads back.
    """
    order = order_time(record) if order is None else order
    check_approach(record, order)
    side, found = side_of(record, order), Collector("Williamson turn")
    at = crossing(heading_change(record, order, side), -math.pi, order, record.end)
    if at is None:
        found.lack("the heading never is the reciprocal one, by the other side",
                   "turn_time", "offset", "advance")  # fmt: skip
        return found.figures()
    ahead, across = along_and_across(record, order, side, at)
    found.add("s", turn_time=at - order)
    found.add("m", offset=across, advance=ahead)
    return found.figures()


def turn_on_the_spot(record: Record, order: float | None = None) -> Figures:
    """Return the figures of a turn on the spot.

    ``rate_of_turn`` rad/s, the steady one, positive to starboard; ``time_90`` and ``time_360``
    from the order, s; ``pivot_drift``, m, the distance of the reference point from its place at
    the order after a full turn, and ``largest_drift`` that until then. Raises InputError without a
    heading change of 90 deg.
    """
    order = order_time(record) if order is None else order
    side, found = side_of(record, order), Collector("turn on the spot")
    psi = heading_change(record, order, side)
    for name, angle in (("time_90", math.pi / 2.0), ("time_360", math.tau)):
        at = crossing(psi, angle, order, record.end)
        if at is None:
            found.lack(f"the heading never changes by {math.degrees(angle):g} deg", name)
        else:
            found.add("s", **{name: at - order})
    if at is None:
        found.lack("the record has no full turn", "pivot_drift", "largest_drift")
    else:
        rows = (record.time >= order) & (record.time <= at)
        away = np.column_stack((record.north, record.east))[rows] - record.place(order)
        found.add("m", pivot_drift=math.dist(record.place(at), record.place(order)))
        found.add("m", largest_drift=float(np.hypot(*away.T).max()))
    figures = found.figures()
    steady = Figure(steady_rate(record, order, record.end), "rad/s")
    return replace(figures, found={**figures.found, "rate_of_turn": steady})


def station_box(record: Record, north: float, east: float, heading: float) -> Figures:
    """Return the figures of keeping a station at (north, east), m, with a heading, rad.

    ``radius_95`` is the distance from the station that is kept for 95 % of the time, m,
    ``largest_distance`` m; ``heading_error_rms`` and ``heading_error_95`` rad; ``power`` the mean,
    W. Rows weigh by the time that they stand for. Raises InputError for what is not finite.
    """
    if not all(map(math.isfinite, (north, east, heading))):
        raise InputError(f"station: finite values are needed, found {(north, east, heading)}")
    weights = np.gradient(record.time)
    away = np.hypot(record.north - north, record.east - east)
    error = np.remainder(record.heading - heading + math.pi, math.tau) - math.pi
    found = Collector("station keeping")
    found.add("m", radius_95=_quantile(away, weights), largest_distance=float(away.max()))
    rms = math.sqrt(float(np.average(error**2, weights=weights)))
    found.add("rad", heading_error_rms=rms, heading_error_95=_quantile(np.abs(error), weights))
    if record.power is None:
        found.lack("the record has no power", "power")
    else:
        found.add("W", power=float(np.average(record.power, weights=weights)))
    return found.figures()


def _quantile(values: Array, weights: Array) -> float:
    """Return the value that is not exceeded for 95 % of the time."""
    order = np.argsort(values)
    share = np.cumsum(weights[order]) / weights.sum()
    return float(values[order[int(np.searchsorted(share, _WITHIN))]])
