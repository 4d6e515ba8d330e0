"""Turning circle: figures of IMO MSC/Circ.1053 and ITTC 7.5-04-02-01."""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicSpline

from .crossings import check_approach, crossing, crossings, largest, order_time, side_of
from .record import Record
from .result import Collector, Figures

TURN = math.tau
_PAIRS = 37
"""Pairs of equal heading from which the current is found."""
_INSTANTS = 2001
"""Instants of the last turn over which the steady figures are means."""


def turning_circle(record: Record, order: float | None = None) -> Figures:
    """Return the figures of a turning circle.

    x along the heading at the order, y across it towards the turn, m, both of the water; psi the
    heading change towards the turn:

    =================== ====================================================================
    advance, transfer   x and y at psi = 90 deg
    tactical_diameter   y at psi = 180 deg
    maximum_advance     largest x up to psi = 180 deg
    time_90 (180, 360)  time from the order, s
    steady_diameter     2 U / r, means over the last full turn
    steady_speed        U, m/s; steady_rate r, rad/s, positive to starboard
    steady_drift        psi less the course through the water, rad, positive: bow to starboard
    approach_speed      speed at the order, m/s; steady_speed_ratio: U divided by it
    speed_loss          1 - steady_speed_ratio
    largest_heel        largest size of roll, rad, with a record of it
    current_north, ...  `current_of_circle`, where the record has two turns
    =================== ====================================================================

    ``order`` is the time of the helm order, s; None: `order_time`. Raises InputError for a record
    that starts in a turn, or without a heading change of 90 deg.
    """
    order = order_time(record) if order is None else order
    check_approach(record, order)
    side, found = side_of(record, order), Collector("turning circle")
    current = current_of_circle(record, order, side)
    if current is None:
        found.lack("it needs two full turns", "current_north", "current_east")
        found.note("the current is not known: figures are those over ground")
    else:
        found.add("m/s", current_north=current[0], current_east=current[1])
        record = record.through_water(*current, order)
    _positions(record, order, side, found)
    _steady(record, order, side, found)
    if record.roll is None:
        found.lack("the record has no roll", "largest_heel")
    else:
        found.add("rad", largest_heel=float(np.abs(record.roll[record.time >= order]).max()))
    return found.figures()


def current_of_circle(record: Record, order: float, side: float) -> tuple[float, float] | None:
    """Return the current north and east, m/s, or None where the record has less than two turns.

    IMO MSC/Circ.1053: the displacement between two positions of equal heading, one turn apart,
    after the first 360 deg, divided by the time between; the mean over such pairs of the last
    half turn, where the turn is steadiest.
    """
    psi = heading_change(record, order, side)
    last = float(psi(record.end)) - 1e-9
    first = max(TURN, last - 1.5 * TURN)
    if first + TURN > last:
        return None
    drifts = []
    for angle in np.linspace(first, last - TURN, _PAIRS):
        before = crossing(psi, angle, order, record.end)
        after = crossing(psi, angle + TURN, order, record.end)
        assert before is not None
        assert after is not None
        drifts.append((record.place(after) - record.place(before)) / (after - before))
    north, east = np.mean(drifts, axis=0)
    return float(north), float(east)


def heading_change(record: Record, order: float, side: float) -> CubicSpline:
    """Return the spline of the heading change since the order, rad, positive towards a side."""
    psi = record.course_kept
    return CubicSpline(record.time, side * (record.heading - float(psi(order))))


def along_and_across(record: Record, order: float, side: float, at: float) -> tuple[float, float]:
    """Return the way made since the order, m: along the approach heading, and across to a side."""
    north, east = record.place(at) - record.place(order)
    course = float(record.course_kept(order))
    ahead = north * math.cos(course) + east * math.sin(course)
    starboard = east * math.cos(course) - north * math.sin(course)
    return float(ahead), side * float(starboard)


def approach_speed(record: Record, order: float) -> float:
    """Return the speed at the order, m/s, towards the heading there."""
    north, east = record.place(order, 1)
    course = float(record.course_kept(order))
    return float(north * math.cos(course) + east * math.sin(course))


def _positions(record: Record, order: float, side: float, found: Collector) -> None:
    psi = heading_change(record, order, side)
    names = {90: ("time_90", "advance", "transfer"), 180: ("time_180", "tactical_diameter",
             "maximum_advance"), 360: ("time_360",)}  # fmt: skip
    for degrees, lacking in names.items():
        at = crossing(psi, math.radians(degrees), order, record.end)
        if at is None:
            most = math.degrees(largest(psi, order, record.end)[1])
            found.lack(f"the heading changes by {most:.4g} deg, {degrees} deg are needed", *lacking)
            continue
        found.add("s", **{f"time_{degrees}": at - order})
        along, across = along_and_across(record, order, side, at)
        if degrees == 90:
            found.add("m", advance=along, transfer=across)
        elif degrees == 180:
            found.add("m", tactical_diameter=across)
            found.add("m", maximum_advance=_largest_along(record, order, at))


def _largest_along(record: Record, order: float, last: float) -> float:
    course = float(record.course_kept(order))
    ahead = record.north * math.cos(course) + record.east * math.sin(course)
    curve = CubicSpline(record.time, ahead)
    return largest(curve, order, last)[1] - float(curve(order))


def _steady(record: Record, order: float, side: float, found: Collector) -> None:
    names = ("steady_diameter", "steady_speed", "steady_rate", "steady_drift",
             "steady_speed_ratio", "speed_loss")  # fmt: skip
    speed_before = approach_speed(record, order)
    found.add("m/s", approach_speed=speed_before)
    psi = heading_change(record, order, side)
    turned = float(psi(record.end))
    if turned < 1.5 * TURN:
        reason = f"the heading changes by {math.degrees(turned):.4g} deg, 540 deg are needed"
        return found.lack(reason, *names)
    first = float(crossings(psi, turned - TURN, order, record.end)[-1])
    at = np.linspace(first, record.end, _INSTANTS)
    speed = float(record.speed(at).mean())
    rate = TURN / (record.end - first)
    velocity = record.place(at, 1)
    course = np.arctan2(velocity[:, 1], velocity[:, 0])
    drift = np.exp(1j * (record.course_kept(at) - course))
    found.add("m", steady_diameter=2.0 * speed / rate)
    found.add("m/s", steady_speed=speed)
    found.add("rad/s", steady_rate=side * rate)
    found.add("rad", steady_drift=float(np.angle(drift.mean())))
    ratio = speed / speed_before
    return found.add("1", steady_speed_ratio=ratio, speed_loss=1.0 - ratio)
