"""Identification method of [Paulino2015]: discrete integration, correlation, least squares.

It is here to be compared with. With noise its drag is of the wrong size, because the regressors
carry the integrated noise of the sensor; `seatrial_kits.identify.output_error` is what works.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from seatrial.model.expressions import Vector

from .prediction import delayed

Rule = Literal["trapezoid", "left"]
_RATIOS = ("linear", "quadratic", "offset", "thrust")


@dataclass(frozen=True)
class SourceEstimate:
    """Ratios to the mass or inertia A, as `AxisMotion` has them, and the delay in samples."""

    linear: float
    quadratic: float
    offset: float
    thrust: float
    delay: int


def integrated(rate: Vector, period: float, rule: Rule = "trapezoid") -> Vector:
    """Return the discrete integral (n,) of a rate (n,), 0 at the first sample.

    "left" holds each sample over the period that follows: the right rule for an acceleration
    that jumps with the command at the samples, which the trapezoid smears over two periods.
    """
    steps = rate[:-1] if rule == "left" else (rate[:-1] + rate[1:]) / 2.0
    return np.concatenate([[0.0], np.cumsum(steps) * period])


def differences(angle: Vector, period: float) -> tuple[Vector, Vector]:
    """Return rate and acceleration (n,) of an unwrapped angle (n,) by central differences.

    At the ends, one-sided. White noise of the angle is multiplied by 2.4 / period^2 in the
    acceleration.
    """
    rate = np.gradient(angle, period)
    second = np.diff(angle, 2) / period**2
    return rate, np.concatenate([second[:1], second, second[-1:]])


def correlation_delay(command: Vector, output: Vector, longest: int) -> int:
    """Return the lag, 0 to ``longest`` samples, of the largest |cross-correlation|.

    Both (n,), their means removed; the output follows the command, so that lags are causal.
    """
    beta, y = command - command.mean(), output - output.mean()
    correlation = [abs(float(beta[: len(beta) - lag] @ y[lag:])) for lag in range(longest + 1)]
    return int(np.argmax(correlation))


def normalised_least_squares(regressors: Vector, right_hand_side: Vector) -> Vector:
    """Return x that minimises |regressors x - right_hand_side|: [Paulino2015], eqs 5.13 and 5.14.

    Columns are divided by their largest absolute value: eq. 5.14 prints max(), which may be 0 or
    negative. A column of zeros gets 0.
    """
    scale = np.abs(regressors).max(axis=0)
    scale[scale == 0.0] = 1.0
    scaled = np.linalg.lstsq(regressors / scale, right_hand_side, rcond=None)[0]
    solution: Vector = scaled / scale
    return solution


def least_squares_axis(
    command: Vector, velocity: Vector, acceleration: Vector, *, offset: bool
) -> tuple[float, float, float, float]:
    """Return B/A, C/A, D/A, E/A from series (n,): [Paulino2015], eq. 5.12.

    Regressors nu, |nu| nu, 1 (with ``offset``, else D = 0) and the command, shifted by the delay
    already; for quadratic thrust (eq. 5.10, corrected) give beta |beta|. A drag of the wrong sign,
    positive, is forced to 0 and the rest fitted again.
    """
    columns = {
        "linear": velocity,
        "quadratic": np.abs(velocity) * velocity,
        "offset": np.ones_like(velocity),
        "thrust": command,
    }
    if not offset:
        del columns["offset"]
    while True:
        matrix = np.column_stack(list(columns.values()))
        found = dict(zip(columns, normalised_least_squares(matrix, acceleration), strict=True))
        wrong = [name for name in ("linear", "quadratic") if found.get(name, 0.0) > 0.0]
        if not wrong:
            values = (float(found.get(name, 0.0)) for name in _RATIOS)
            linear, quadratic, constant, thrust = values
            return linear, quadratic, constant, thrust
        for name in wrong:
            del columns[name]


def source_method(
    command: Vector,
    period: float,
    *,
    acceleration: Vector | None = None,
    angle: Vector | None = None,
    longest_delay: int,
    offset: bool = False,
    rule: Rule = "trapezoid",
) -> SourceEstimate:
    """Return what [Paulino2015], section 5.2, finds for one axis from a log of samples (n,).

    Either ``acceleration`` along the axis, which is integrated, or ``angle``, unwrapped, which is
    differentiated twice (rad, or a depth in m). The delay is that of the correlation of command
    and acceleration, up to ``longest_delay`` samples.
    """
    if (acceleration is None) == (angle is None):
        raise ValueError("either an acceleration or an angle is needed")
    if angle is not None:
        velocity, acceleration = differences(angle, period)
    else:
        assert acceleration is not None
        velocity = integrated(acceleration, period, rule)
    delay = correlation_delay(command, acceleration, longest_delay)
    found = least_squares_axis(delayed(command, delay), velocity, acceleration, offset=offset)
    return SourceEstimate(*found, delay)


@dataclass(frozen=True)
class PlanarEstimate:
    """What [Paulino2015], section 5.3, finds with surge and yaw known: kg, N.s/m, N, N."""

    m22: float
    d22: float
    E1: float
    E2: float


def planar_least_squares(
    nu: Vector,
    nu_dot: Vector,
    commands: Vector,
    *,
    m11: float,
    m33: float,
    d11: float = 0.0,
    d33: float = 0.0,
    arm: float = 1.0,
) -> PlanarEstimate:
    """Return sway mass and drag and both motors' thrust: [Paulino2015], eqs 5.18 to 5.21.

    ``nu`` = (u, v, r) and ``nu_dot`` (n, 3) in body axes, ``commands`` (n, 2) of the two motors,
    ``arm`` their lever arm, m, by which the row of yaw is divided; 1 is the source's. In

        m11 u' + d11 u - m22 v r = E1 t1 + E2 t2
        m22 v' + d22 v + m11 u r = 0
        m33 r' + d33 r - (m11 - m22) u v = arm (E1 t1 - E2 t2)

    Corrected in eq. 5.20: d11 u in the first row (printed d22 u), and + m11 u v in the third
    (printed -). Drag is linear.
    """
    (u, v, r), (u_dot, v_dot, r_dot), (t1, t2) = nu.T, nu_dot.T, commands.T
    none = np.zeros_like(u)
    rows = [
        np.column_stack([-v * r, none, -t1, -t2]),
        np.column_stack([v_dot, v, none, none]),
        np.column_stack([u * v / arm, none, -t1, t2]),
    ]
    right = [-m11 * u_dot - d11 * u, -m11 * u * r, (-m33 * r_dot + m11 * u * v - d33 * r) / arm]
    found = normalised_least_squares(np.vstack(rows), np.concatenate(right))
    m22, d22, E1, E2 = (float(value) for value in found)
    return PlanarEstimate(m22, d22, E1, E2)


def thrust_at_top_speed(density: float, drag_area: float, speed: float) -> float:
    """Return E_1, N, that balances the drag at top speed: [Paulino2015], eq. 5.8, without G.

    ``density`` of the water in kg/m3, ``drag_area`` C_d S in m2, ``speed`` in m/s.
    """
    return 0.5 * density * drag_area * speed * abs(speed)
