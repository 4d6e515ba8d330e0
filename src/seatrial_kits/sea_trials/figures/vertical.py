"""Step of depth and zig-zag in the vertical plane: figures of craft under water."""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicSpline

from seatrial.errors import InputError

from .crossings import crossing, crossings, largest
from .record import Record
from .result import Collector, Figures
from .zigzag import check_heading

_BAND = 0.05


def depth_step(record: Record, order: float, depth: float) -> Figures:
    """Return the figures of a step to a ``depth``, m, ordered at a time, s.

    ``rise_time`` is from 10 % to 90 % of the step, ``settling_time`` from the order until the
    depth stays within 5 % of the step, s; ``overshoot`` m, ``overshoot_share`` of the step;
    ``final_error`` m, positive too deep. Raises InputError without a record of depth, or for a
    step of none.
    """
    curve = record.spline("depth")
    before = float(curve(order))
    step = depth - before
    if step == 0.0:
        raise InputError(f"depth step: the depth at the order is {depth:g} m already")
    done = CubicSpline(record.time, (record.depth - before) / step)
    found = Collector("depth step")
    at = [crossing(done, share, order, record.end) for share in (0.1, 0.9)]
    if at[0] is None or at[1] is None:
        found.lack("the depth does not come to 90 % of the step", "rise_time")
    else:
        found.add("s", rise_time=at[1] - at[0])
    most = largest(done, order, record.end)[1]
    found.add("m", overshoot=max(most - 1.0, 0.0) * abs(step))
    found.add("1", overshoot_share=max(most - 1.0, 0.0))
    last = max(
        (each for level in (1.0 - _BAND, 1.0 + _BAND)
         if (each := _last_crossing(done, level, order, record.end)) is not None),
        default=None,
    )  # fmt: skip
    if last is None or abs(float(done(record.end)) - 1.0) > _BAND:
        found.lack("the depth does not stay within 5 % of the step", "settling_time")
    else:
        found.add("s", settling_time=last - order)
    found.add("m", final_error=float(curve(record.end)) - depth)
    return found.figures()


def pitch_zig_zag(record: Record, pitch: float, order: float) -> Figures:
    """Return the figures of a vertical zig-zag with planes reversed at +-``pitch``, rad.

    Towards the side of the first pitch: ``execute_time``, from the order to the first reversal,
    s; ``overshoot_pitch``, beyond the pitch of reversal, rad; ``overshoot_depth``, the change of
    depth from the first reversal to its extremum, m, of either sign; ``reach_time``, from the
    order to the first return to the pitch at the order, s. As for submarines. Raises InputError
    without pitch and depth, or if the pitch of reversal is not reached.
    """
    check_heading(pitch)
    turned = record.spline("pitch")
    start = float(turned(order))
    change = record.pitch - start
    after = record.time > order
    side = math.copysign(1.0, change[after][np.argmax(np.abs(change[after]) > pitch / 2.0)])
    theta, found = CubicSpline(record.time, side * change), Collector("pitch zig-zag")
    at = crossing(theta, pitch, order, record.end)
    if at is None:
        found.lack(f"the pitch never changes by {math.degrees(pitch):.4g} deg", "execute_time",
                   "overshoot_pitch", "overshoot_depth", "reach_time")  # fmt: skip
        return found.figures()
    found.add("s", execute_time=at - order)
    back = crossing(theta, 0.0, at, record.end)
    until = record.end if back is None else back
    value = largest(theta, at, until)[1]
    if back is None:
        found.lack("the pitch does not return", "reach_time", "overshoot_depth")
    else:
        found.add("s", reach_time=back - order)
        depth = record.spline("depth")
        rising = CubicSpline(record.time, -side * record.depth)
        when = largest(rising, at, record.end)[0]
        found.add("m", overshoot_depth=float(depth(when) - depth(at)))
    found.add("rad", overshoot_pitch=value - pitch)
    return found.figures()


def _last_crossing(curve: CubicSpline, level: float, first: float, last: float) -> float | None:
    found = crossings(curve, level, first, last)
    return float(found[-1]) if len(found) else None
