"""Pull-out and spirals: figures of stability on a straight course."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from seatrial.errors import InputError

from .record import Array, Record
from .result import Collector, Figures

_SETTLED = 0.1
"""Share of a stretch, at its end, over which a steady rate is a mean."""
_FOUND = 0.4
"""The same of a reverse spiral: the helm moves about the one that is found."""


@dataclass(frozen=True)
class Loop:
    """The loop of the r'-helm curve of a vessel that is not stable on a straight course."""

    height: float
    """Difference of the steady rates at helm amidships, in the unit of the rates."""
    width: float
    """Range of helm in which two rates are steady, rad."""


def steady_rate(record: Record, first: float, last: float, share: float = _SETTLED) -> float:
    """Return the mean rate of turn over a ``share`` of a stretch of time, at its end, rad/s."""
    start = last - share * (last - first)
    psi = record.course_kept
    return float((psi(last) - psi(start)) / (last - start))


def pull_out(record: Record, order: float) -> Figures:
    """Return the residual rate of turn, rad/s, after helm amidships was ordered at a time, s.

    ``rate_before`` is that of the steady turn. A vessel that is stable on a straight course has a
    residual rate of 0 after turns to both sides, or the same one, which its asymmetry explains
    (`is_stable`). Raises InputError for a time outside the record.
    """
    if not record.start < order < record.end:
        raise InputError(
            f"order: a time from {record.start:g} to {record.end:g} s is needed, found {order:g} s"
        )
    found = Collector("pull-out")
    before, after = steady_rate(record, record.start, order), steady_rate(record, order, record.end)
    found.add("rad/s", rate_before=before, residual_rate=after)
    found.add("1", residual_share=after / before if before else math.inf)
    return found.figures()


def is_stable(starboard: float, port: float, before: float, share: float = 0.02) -> bool:
    """Return whether the residual rates after pull-outs from both sides agree, rad/s.

    They agree within a ``share`` of the rate ``before``, of the steady turn.
    """
    return abs(starboard - port) <= share * abs(before)


def spiral(
    record: Record, length: float | None, orders: Sequence[float] = ()
) -> tuple[Array, Array]:
    """Return helm (m,), rad, and r' = r L / U (m,) at the steps of a spiral, in their order.

    Steps begin at ``orders``, s; without them a step is a stretch of unchanged helm, so that the
    spiral is a direct one. It has at least eight rows; its helm, rate and speed are means over its
    last tenth, with ``orders`` over its last two fifths. Without a ``length``, m, the rates are
    r, rad/s. Raises InputError without helm, or with less than three steps.
    """
    if record.helm is None:
        raise InputError("spiral: the record has no helm")
    if orders:
        edges = np.searchsorted(record.time, np.asarray(orders))
    else:
        same = np.abs(np.diff(record.helm)) <= 1e-6 * np.abs(record.helm).max()
        edges = np.flatnonzero(~same) + 1
    starts = np.concatenate(([0], edges))
    ends = np.concatenate((edges - 1, [len(record.helm) - 1]))
    share = _FOUND if orders else _SETTLED
    helms, rates = [], []
    for first, last in zip(starts, ends, strict=True):
        if last - first < 8:
            continue
        at = float(record.time[first]), float(record.time[last])
        settled = at[1] - share * (at[1] - at[0])
        scale = 1.0
        if length is not None:
            scale = length * (at[1] - settled) / record.track(settled, at[1])
        rows = slice(int(np.searchsorted(record.time, settled)), last + 1)
        helms.append(float(record.helm[rows].mean()))
        rates.append(steady_rate(record, *at, share) * scale)
    if len(helms) < 3:
        raise InputError(f"spiral: at least three steps of helm are needed, found {len(helms)}")
    return np.array(helms), np.array(rates)


@dataclass(frozen=True)
class Stability:
    """The curve of helm against rate of a reverse spiral, which is single-valued."""

    neutral_helm: float
    """Helm at which the rate is 0, rad."""
    slope: float
    """Helm by rate there, rad in the unit of the rate; below 0 for a vessel that is not stable on a
    straight course."""
    width: float
    """Range of helm in which three rates are steady, rad: 0 for a stable vessel."""


def stability(helm: Any, rate: Any) -> Stability:
    """Return what a reverse spiral tells of helm (n,), rad, and rate (n,), in any order.

    The curve is the cubic spline through its points; the width is that between its extrema on the
    branch that is not stable. Raises InputError for less than four rates, or rates that do not
    enclose 0.
    """
    order = np.argsort(rate)
    helm, rate = np.asarray(helm, np.float64)[order], np.asarray(rate, np.float64)[order]
    if len(rate) < 4 or not rate[0] < 0.0 < rate[-1] or not (np.diff(rate) > 0.0).all():
        raise InputError("reverse spiral: four different rates, to both sides, are needed")
    curve = CubicSpline(rate, helm)
    at = np.linspace(rate[0], rate[-1], 2001)
    falling = np.diff(curve(at)) < 0.0
    inside = curve(at)[:-1][falling]
    width = float(inside.max() - inside.min()) if falling.any() else 0.0
    return Stability(float(curve(0.0)), float(curve(0.0, 1)), width)


def loop(helm: Any, rate: Any) -> Loop:
    """Return the loop of a spiral from full helm to one side to full helm to the other, and back.

    ``helm`` (n,), rad, and ``rate`` (n,) are in the order of the steps, the turning point of the
    helm between. Each branch is linear between its steps. The height is the difference of the
    branches at helm 0; the width the range of helm in which they differ by more than a tenth of
    the height. Both are 0 for branches that coincide, to 1 % of the largest rate.

    Raises InputError for a spiral with one branch only, or branches that do not enclose helm 0.
    """
    helm, rate = np.asarray(helm, np.float64), np.asarray(rate, np.float64)
    turn = int(np.argmin(helm) if helm[0] > 0.0 else np.argmax(helm))
    down, up = np.arange(turn + 1), np.arange(turn, len(helm))
    if len(up) < 2 or len(down) < 2:
        raise InputError("spiral: helm must go to one side and come back, for two branches")
    branches = []
    for rows in (down, up):
        order = rows[np.argsort(helm[rows])]
        if not helm[order[0]] <= 0.0 <= helm[order[-1]]:
            raise InputError("spiral: each branch must enclose helm 0")
        branches.append((helm[order], rate[order]))
    low, high = max(b[0][0] for b in branches), min(b[0][-1] for b in branches)
    at = np.linspace(low, high, 2001)
    apart = np.abs(np.interp(at, *branches[0]) - np.interp(at, *branches[1]))
    height = float(np.interp(0.0, at, apart))
    if height <= 0.01 * float(np.abs(rate).max()):
        return Loop(0.0, 0.0)
    inside = at[apart > 0.1 * height]
    return Loop(height, float(inside[-1] - inside[0]))
