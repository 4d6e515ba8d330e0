"""Nominal motion and commands of a vessel without sway force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from seatrial.errors import InputError

_SUB_STEP = 0.02
"""Longest Runge-Kutta step of the sway velocity, in units of its time constant."""

_SETTLED = 40.0
"""Time constants after which nothing of a transient is left in a double."""

_MOST_ROWS = 500_000


@dataclass(frozen=True)
class VesselModel:
    """What a controller believes of its vessel: the parameters of `SurfaceVessel`, SI."""

    mass: tuple[float, float, float]
    damping: tuple[float, float, float]
    thrust: tuple[float, float]
    lever_arm: float
    yaw_coupling_sign: float

    def commands(self, X: float, N: float) -> tuple[float, float]:
        """Return (t1, t2) that give surge force X, N, and yaw moment N, N.m (5.18 solved)."""
        first, second = self.thrust
        turning = N / self.lever_arm
        return (X + turning) / (2.0 * first), (X - turning) / (2.0 * second)

    def loads(
        self, nu: tuple[float, float, float], surge: float, yaw: float
    ) -> tuple[float, float]:
        """Return X, N, and N, N.m, for u' = ``surge``, m/s2, and r' = ``yaw``, rad/s2, at nu.

        X = m11 u' + d11 u - m22 v r,   N = m33 r' + d33 r - s (m11 - m22) u v
        """
        (m11, m22, m33), (d11, _d22, d33), (u, v, r) = self.mass, self.damping, nu
        coupling = self.yaw_coupling_sign * (m11 - m22) * u * v
        return m11 * surge + d11 * u - m22 * v * r, m33 * yaw + d33 * r - coupling


@dataclass(frozen=True)
class Profile:
    """A velocity over time: constant, or from rest to ``value`` within ``duration``, s.

    The latter is value (10 x^3 - 15 x^4 + 6 x^5) with x = t / duration, held afterwards: first
    and second derivatives vanish at both ends ([Paulino2015], section 6.1, for 240 s). A duration
    of 0 stands for a constant.
    """

    value: float
    duration: float

    def at(self, t: float) -> tuple[float, float, float]:
        """Return the velocity and its first and second derivative."""
        if t >= self.duration:
            return self.value, 0.0, 0.0
        x, per_second = t / self.duration, 1.0 / self.duration
        return (
            self.value * x**3 * (10.0 - 15.0 * x + 6.0 * x**2),
            self.value * per_second * 30.0 * x**2 * (1.0 - x) ** 2,
            self.value * per_second**2 * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
        )


class Nominal(NamedTuple):
    """Nominal u, v, r with first and second derivatives, SI, and the commands that give them."""

    velocity: tuple[float, float, float]
    acceleration: tuple[float, float, float]
    jerk: tuple[float, float, float]
    command: tuple[float, float]


def nominal_motion(
    model: VesselModel, surge: Profile, yaw: Profile, period: float
) -> list[Nominal]:
    """Return the nominal motion every ``period``, s, until it is steady.

    Surge U and yaw rate R are given; sway follows, corrected from [Paulino2015], eq. 6.1:

        m22 V' + d22 V + m11 U R = 0,   V(0) = -m11 U R / d22 at t = 0

    by the classical Runge-Kutta method of order 4, with steps of at most 2 % of m22 / d22. The
    commands are (6.2) and (6.3), corrected, in the form of `VesselModel.loads`.

    Raises InputError without damping of sway (V would grow without end), and for more than
    500000 rows.
    """
    m11, m22, _m33 = model.mass
    _d11, d22, _d33 = model.damping
    if d22 <= 0.0:
        raise InputError(f"damping.v is {d22!r} N.s/m: a nominal sway velocity needs more than 0")
    lag, drive = m22 / d22, -m11 / d22
    moving = max(surge.duration, yaw.duration)
    count = math.ceil((moving + _SETTLED * lag) / period) if moving > 0.0 else 0
    if count > _MOST_ROWS:
        raise InputError(
            f"a trajectory of {moving!r} s that settles with {lag:.4g} s has {count} samples of "
            f"{period!r} s, at most {_MOST_ROWS} are allowed"
        )

    def slope(t: float, v: float) -> float:
        return (drive * surge.at(t)[0] * yaw.at(t)[0] - v) / lag

    v = drive * surge.at(0.0)[0] * yaw.at(0.0)[0]
    parts = max(1, math.ceil(period / (_SUB_STEP * lag)))
    rows = []
    for k in range(count + 1):
        (u, u1, u2), (r, r1, r2) = surge.at(k * period), yaw.at(k * period)
        v1 = (drive * u * r - v) / lag
        v2 = (drive * (u1 * r + u * r1) - v1) / lag
        velocity = u, v, r
        command = model.commands(*model.loads(velocity, u1, r1))
        rows.append(Nominal(velocity, (u1, v1, r1), (u2, v2, r2), command))
        for part in range(parts if k < count else 0):
            h = period / parts
            t = k * period + part * h
            k1 = slope(t, v)
            k2 = slope(t + h / 2, v + h / 2 * k1)
            k3 = slope(t + h / 2, v + h / 2 * k2)
            k4 = slope(t + h, v + h * k3)
            v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return rows
