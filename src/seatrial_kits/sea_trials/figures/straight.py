"""Stopping, acceleration and coasting, speed trials: figures of manoeuvres ahead."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from seatrial.errors import InputError

from .crossings import check_approach, crossing
from .record import Array, Record
from .result import Collector, Figures
from .turning import along_and_across, approach_speed


def speed_ahead(record: Record) -> CubicSpline:
    """Return the spline of the speed along the bow, m/s, from positions and heading."""
    velocity, heading = record.place(record.time, 1), record.heading
    return CubicSpline(
        record.time, velocity[:, 0] * np.cos(heading) + velocity[:, 1] * np.sin(heading)
    )


def stopping(record: Record, order: float, share: float = 0.0) -> Figures:
    """Return the figures of a stop, by full astern or by inertia, ordered at a time, s.

    The vessel has stopped when its speed along the bow is ``share`` of that at the order (0 with
    engines astern; coasting needs a share, for it never quite stops). ``track_reach`` is along the
    path, ``head_reach`` along the heading at the order, ``side_reach`` across it, positive to
    starboard, m; ``stopping_time`` s, ``heading_change`` rad, positive to starboard; IMO
    MSC/Circ.1053. Raises InputError for a record that starts in a turn, does not move ahead at the
    order, or does not come to that speed.
    """
    names = ("track_reach", "head_reach", "side_reach", "stopping_time", "heading_change")
    found, speed = Collector("stopping"), _moving(record, order)
    at = crossing(speed_ahead(record), share * speed, order, record.end)
    if at is None:
        least = float(speed_ahead(record)(record.end))
        found.lack(
            f"the speed is still {least:.4g} m/s at the end, {share * speed:.4g} m/s is needed",
            *names,
        )
        return found.figures()
    ahead, starboard = along_and_across(record, order, 1.0, at)
    found.add("m", track_reach=record.track(order, at), head_reach=ahead, side_reach=starboard)
    found.add("s", stopping_time=at - order)
    found.add("m/s", approach_speed=speed)
    turned = record.course_kept(at) - record.course_kept(order)
    found.add("rad", heading_change=float(turned))
    return found.figures()


def acceleration(record: Record, order: float, share: float = 0.9) -> Figures:
    """Return time, s, and distance, m, from the order to a share of the speed at the end.

    The speed is along the bow, the final one its mean over the last tenth of the record: noise of
    a sensor, or of a pilot that corrects the heading, is no change of speed. Means over that tenth
    and over the one before must differ by no more than 1 %. Coasting has the same figures by
    `stopping` with a share of 0.2. Raises InputError for a record that is not steady in the end.
    """
    found, ahead = Collector("acceleration"), speed_ahead(record)
    tenth = 0.1 * (record.end - order)
    before, final = (
        float(ahead.integrate(record.end - (n + 1) * tenth, record.end - n * tenth)) / tenth
        for n in (1, 0)
    )
    if abs(final - before) > 0.01 * abs(final):
        raise InputError(
            f"acceleration: the mean speed still changes from {before:.4g} to {final:.4g} m/s over "
            "the last two tenths of the record; up to 1 % is steady"
        )
    found.add("m/s", final_speed=final)
    at = crossing(ahead, share * final, order, record.end)
    if at is None:
        found.lack(f"the speed is above {share:g} of the final one from the order on",
                   "acceleration_time", "acceleration_distance")  # fmt: skip
    else:
        found.add("s", acceleration_time=at - order)
        found.add("m", acceleration_distance=record.track(order, at))
    return found.figures()


def mean_of_means(speeds: Any) -> float:
    """Return the speed through the water of runs (n,) over ground, by turns with and against, m/s.

    The mean of consecutive means, repeated until one is left (ITTC 7.5-04-01-01): a current that
    is a polynomial of degree n - 2 in the number of the run leaves no error. Raises InputError for
    less than two runs, or speeds that are not above 0.
    """
    means = np.asarray(speeds, np.float64)
    if means.ndim != 1 or len(means) < 2:
        raise InputError(f"speeds: at least two runs are needed, found {means.shape}")
    if not (means > 0.0).all():
        raise InputError(f"speeds: values above 0 m/s are needed, found {means.min():g}")
    while len(means) > 1:
        means = (means[1:] + means[:-1]) / 2.0
    return float(means[0])


def run_speed(record: Record, first: float, last: float) -> Figures:
    """Return the mean speed over ground, m/s, and power, W, of a run between two times, s.

    The speed is that from end to end, as by a measured mile. Raises InputError for times outside
    the record.
    """
    if not record.start <= first < last <= record.end:
        raise InputError(
            f"speed run: times from {record.start:g} to {record.end:g} s are needed, "
            f"found {first:g} and {last:g} s"
        )
    found = Collector("speed run")
    way = record.place(last) - record.place(first)
    found.add("m/s", speed_over_ground=math.hypot(*way) / (last - first))
    if record.power is None:
        found.lack("the record has no power", "power")
    else:
        mean = record.spline("power").integrate(first, last) / (last - first)
        found.add("W", power=float(mean))
    return found.figures()


def speed_power(speeds: Array, powers: Array) -> tuple[float, float]:
    """Return (c, n) of P = c U^n through speeds, m/s, and powers, W.

    The sum of squares of the logarithms' errors is least.

    Raises InputError for less than two different speeds, or values that are not above 0.
    """
    speeds, powers = np.asarray(speeds, np.float64), np.asarray(powers, np.float64)
    if speeds.shape != powers.shape or len(set(speeds.tolist())) < 2:
        raise InputError("speed-power curve: at least two different speeds, each with a power, "
                         f"are needed, found {speeds.shape} and {powers.shape}")  # fmt: skip
    if (speeds <= 0.0).any() or (powers <= 0.0).any():
        raise InputError("speed-power curve: speeds and powers above 0 are needed")
    exponent, factor = np.polyfit(np.log(speeds), np.log(powers), 1)
    return float(math.exp(factor)), float(exponent)


def speed_trial(record: Record, runs: Sequence[tuple[float, float]]) -> Figures:
    """Return speed through the water, m/s, and power, W, of double runs, numbered from 1.

    ``runs`` has begin and end of each, s: with a power there and back on the reciprocal course,
    then with the next. A run's speed is the mean along its heading over ground, `mean_of_means`
    that of a double run; the current along the course leaves no error. P = c U^n has the
    exponent ``speed_power_exponent`` n and c = ``power_at_unit_speed``.

    Raises InputError for an odd number of runs, or times outside the record.
    """
    if not runs or len(runs) % 2:
        raise InputError(f"speed trial: runs by twos are needed, found {len(runs)}")
    found, speeds, powers = Collector("speed trial"), [], []
    for number, first in enumerate(range(0, len(runs), 2), 1):
        pair = [run_speed(record, *run) for run in runs[first : first + 2]]
        ahead = [_along(record, *run) for run in runs[first : first + 2]]
        speeds.append(mean_of_means(ahead))
        found.add("m/s", **{f"speed_{number}": speeds[-1]})
        if all("power" in each for each in pair):
            powers.append(sum(each["power"] for each in pair) / 2.0)
            found.add("W", **{f"power_{number}": powers[-1]})
    names = "power_at_unit_speed", "speed_power_exponent"
    if not powers:
        found.lack("the record has no power", "power", *names)
        return found.figures()
    try:
        factor, exponent = speed_power(np.array(speeds), np.array(powers))
    except InputError as error:
        found.lack(str(error), *names)
    else:
        found.add("1", speed_power_exponent=exponent)
        found.add("W", power_at_unit_speed=factor)
    return found.figures()


def bollard_pull(record: Record, order: float) -> Figures:
    """Return the pull on a line at rest, N: mean over the last half of the time from the order, s.

    ``largest_pull`` is that of the first surge into the line, ``power`` the mean, W. Class
    societies take the mean over some minutes, too. Raises InputError without a record of the pull.
    """
    pull, found = record.spline("pull"), Collector("bollard pull")
    first = (order + record.end) / 2.0
    mean = float(pull.integrate(first, record.end)) / (record.end - first)
    found.add("N", bollard_pull=mean, largest_pull=float(record.pull[record.time >= order].max()))
    if record.power is None:
        found.lack("the record has no power", "power")
    else:
        power = record.spline("power").integrate(first, record.end) / (record.end - first)
        found.add("W", power=float(power))
    return found.figures()


def _along(record: Record, first: float, last: float) -> float:
    """Return the mean speed over ground along the heading, m/s."""
    return float(speed_ahead(record).integrate(first, last)) / (last - first)


def _moving(record: Record, order: float) -> float:
    if not record.start <= order < record.end:
        raise InputError(
            f"order: a time from {record.start:g} to {record.end:g} s is needed, found {order:g} s"
        )
    check_approach(record, order)
    speed = approach_speed(record, order)
    if speed <= 0.0:
        raise InputError(f"the vessel does not move ahead at the order: {speed:.4g} m/s")
    return speed
