"""Output-error identification: the whole run is simulated and compared with the log."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.model.expressions import Vector

from .axis_motion import AxisMotion, AxisRotation
from .prediction import LONGEST_SUBSTEP, STARTS, UNKNOWNS, Reading, delayed, predict
from .source_method import SourceEstimate, source_method

_DRAG = ("linear", "quadratic")
_USUAL_LAG = 0.15
"""Where the search for a time constant starts, s."""
_NOTHING = 1e-9
_ROUGH, _FINE = (1e-4, 25), (1e-12, 200)
"""Relative accuracy of a fit, and its most evaluations: to choose a delay, and at that delay."""


@dataclass(frozen=True)
class AxisLog:
    """A log of one axis at equal times: what was commanded and what a sensor read."""

    command: Vector
    """(n,), -1 to 1, as it was sent."""
    measured: Vector
    """(n,): acceleration along the axis without gravity, m/s2, or place: m, or unwrapped rad."""
    period: float
    """s."""
    reading: Reading
    rotation: bool
    """Whether the axis is turned about (yaw) rather than moved along."""
    before: tuple[float, ...] = ()
    """Commands before the first row, the last of them one period before it; earlier ones are 0."""

    def part(self, first: int, last: int) -> AxisLog:
        """Return the samples ``first`` to before ``last``."""
        cut = slice(first, last)
        before = (*self.before, *self.command[:first].tolist())
        return replace(self, command=self.command[cut], measured=self.measured[cut], before=before)

    def late_command(self, delay: int) -> Vector:
        """Return the command (n,) that acts at each row if it is ``delay`` rows late."""
        sent = np.concatenate([self.before, self.command])
        return delayed(sent, delay)[len(self.before) :]


@dataclass(frozen=True)
class Structure:
    """Which form of `AxisMotion` is fitted."""

    thrust_law: str = "linear"
    lag: str = "none"
    offset: bool = False
    """Whether a constant force is looked for."""


@dataclass(frozen=True)
class Estimate:
    """What the best simulation found."""

    values: dict[str, float]
    """By name, as `prediction.UNKNOWNS`: all of them, 0 for what was not looked for."""
    structure: Structure
    free: tuple[str, ...]
    """What was looked for, in the order of ``covariance``."""
    covariance: Vector
    """(free, free), with the correlation of the residual taken into account."""
    white_covariance: Vector
    """(free, free), as if the residual were white."""
    delay: int
    """In samples."""
    errors: dict[int, float]
    """Root mean square of the residual for each delay that was tried."""
    residual: Vector
    """(n,) measured less predicted."""

    def deviation(self, name: str) -> float:
        """Return the standard deviation of a value; 0 for what was not looked for."""
        if name not in self.free:
            return 0.0
        place = self.free.index(name)
        return float(np.sqrt(self.covariance[place, place]))


def motion_of(log: AxisLog, structure: Structure) -> AxisMotion:
    """Return the equations of a log's axis."""
    motion = AxisRotation("axis") if log.rotation else AxisMotion("axis")
    motion.set("thrust_law", structure.thrust_law)
    motion.set("lag", structure.lag)
    return motion


def output_error(
    log: AxisLog, delays: Sequence[int], *, thrust_law: str = "linear", offset: bool = False
) -> Estimate:
    """Return the parameters of `AxisMotion` whose simulation is nearest to what was measured.

    Minimises the sum of squares of (measured - simulated) over drag (<= 0), thrust, the state at
    the first sample, the bias of an accelerometer, and with ``offset`` the constant force, once
    for each delay (samples). The simulation never sees a measured velocity, so that what spoils
    least squares, drift of an integrated acceleration or noise of a differentiated angle, does
    not enter. Gradients are exact (`prediction.predict`).

    This is done without a lag of the thruster, and with one, for delays up to the best without:
    a lag takes the place of a part of the delay. Of all delays the least sum is kept; the lag is,
    if Schwarz's criterion n ln(sum) + k ln(n), k unknowns, is lower with it.

    [Paulino2015] uses least squares; this method is ours (see [Klein2006]).
    Holds for a residual that the command does not depend on: an open loop, or a closed one whose
    command was recorded and whose sensor noise moves it little.
    """
    prompt = _best_delay(log, delays, Structure(thrust_law, "none", offset))
    shorter = [delay for delay in delays if delay <= prompt.delay]
    lagging = _best_delay(log, shorter, Structure(thrust_law, "thruster", offset))
    return min(prompt, lagging, key=_schwarz)


def simulated(log: AxisLog, estimate: Estimate) -> Vector:
    """Return a free run (n,) of what was found, over a log that need not be that of the estimate.

    The state at the first sample, and an accelerometer's bias, belong to a log, not to a vehicle:
    they alone are fitted to it.
    """
    own = _of_the_log(log, estimate.structure)
    start = np.array([0.0 if name in own else estimate.values[name] for name in UNKNOWNS])
    _, residual, _ = _fit(log, estimate.delay, estimate.structure, own, start)
    return log.measured - residual


def _best_delay(log: AxisLog, delays: Sequence[int], structure: Structure) -> Estimate:
    free = _free(log, structure)
    rough = {delay: _fit(log, delay, structure, free, accuracy=_ROUGH) for delay in delays}
    errors = {delay: _rms(residual) for delay, (_, residual, _) in rough.items()}
    best = min(errors, key=errors.__getitem__)
    unknowns, residual, jacobian = _fit(log, best, structure, free, rough[best][0])
    unknowns[np.abs(unknowns) < _NOTHING] = 0.0  # a drag at its bound stops just short of it
    errors[best] = _rms(residual)
    white, coloured = covariances(jacobian, residual)
    return Estimate(
        values=dict(zip(UNKNOWNS, unknowns.tolist(), strict=True)),
        structure=structure,
        free=free,
        covariance=coloured,
        white_covariance=white,
        delay=best,
        errors=errors,
        residual=residual,
    )


def _schwarz(estimate: Estimate) -> float:
    count = len(estimate.residual)
    total = float(estimate.residual @ estimate.residual)
    return count * math.log(max(total, 1e-300)) + len(estimate.free) * math.log(count)


def _of_the_log(log: AxisLog, structure: Structure) -> tuple[str, ...]:
    # The place does not act on an acceleration; a place has its start instead of a bias.
    own = ("velocity_start", "bias") if log.reading == "acceleration" else STARTS[:2]
    return (*own, "share_start") if structure.lag == "thruster" else own


def _free(log: AxisLog, structure: Structure) -> tuple[str, ...]:
    offset = ("offset",) if structure.offset else ()
    lag = ("time_constant",) if structure.lag == "thruster" else ()
    return (*_DRAG, *offset, "thrust", *lag, *_of_the_log(log, structure))


def _fit(
    log: AxisLog,
    delay: int,
    structure: Structure,
    free: tuple[str, ...],
    start: Vector | None = None,
    accuracy: tuple[float, int] = _FINE,
) -> tuple[Vector, Vector, Vector]:
    """Return unknowns, residual (n,) and its Jacobian (n, free) at the least sum of squares."""
    from scipy.optimize import least_squares

    motion, command = motion_of(log, structure), log.late_command(delay)
    unknowns = _guess(log, delay, structure) if start is None else start.copy()
    places = [UNKNOWNS.index(name) for name in free]

    def residual(z: Vector) -> Vector:
        unknowns[places] = z
        predicted = predict(motion, log.reading, unknowns, command, log.period)
        jacobian[:] = -predicted.sensitivity[:, places]
        return log.measured - predicted.reading

    jacobian = np.zeros((len(command), len(free)))
    tolerance, evaluations = accuracy
    upper = np.array([0.0 if name in _DRAG else np.inf for name in free])
    lower = np.array([LONGEST_SUBSTEP if name == "time_constant" else -np.inf for name in free])
    found = least_squares(
        residual,
        np.minimum(unknowns[places], upper - 1e-9),
        jac=lambda z: jacobian.copy(),
        bounds=(lower, upper),
        x_scale="jac",
        ftol=tolerance,
        xtol=tolerance,
        gtol=tolerance,
        max_nfev=evaluations,
    )
    final = residual(found.x)
    return unknowns, final, jacobian.copy()


def _guess(log: AxisLog, delay: int, structure: Structure) -> Vector:
    """Return where to start from: [Paulino2015]'s least squares, at this delay."""
    quadratic = structure.thrust_law == "quadratic"
    beta = log.late_command(delay)
    place = log.reading == "place"
    found: SourceEstimate = source_method(
        beta * np.abs(beta) if quadratic else beta,
        log.period,
        acceleration=None if place else log.measured,
        angle=log.measured if place else None,
        longest_delay=0,
        rule="left",
    )
    guess = {"linear": found.linear, "quadratic": found.quadratic, "thrust": found.thrust}
    guess["time_constant"] = _USUAL_LAG
    if place:
        guess["place_start"] = float(log.measured[0])
    return np.array([guess.get(name, 0.0) for name in UNKNOWNS])


def covariances(
    jacobian: Vector, residual: Vector, stretches: Sequence[int] | None = None
) -> tuple[Vector, Vector]:
    """Return the covariance of the estimate if the residual is white, and as it is.

    White: s^2 (J^T J)^-1. As it is, with its autocorrelation R: (J^T J)^-1 [sum_ij R_(i-j) J_i
    J_j^T] (J^T J)^-1 ([Klein2006]), R up to lags of sqrt(n) with Bartlett's weights,
    which keep the sum positive. ``jacobian`` (n, k), ``residual`` (n,); ``stretches`` are the
    lengths of its parts that are not correlated with each other, None: one. What the residual
    does not depend on has a variance beyond all others.
    """
    count, k = jacobian.shape
    scale = np.sqrt((jacobian**2).sum(axis=0))
    scale[scale == 0.0] = 1.0
    U, singular, V = np.linalg.svd(jacobian / scale, full_matrices=False)
    inverse = (
        V.T / np.maximum(singular, np.finfo(float).eps * singular.max(initial=1.0)) / scale[:, None]
    )
    middle = np.zeros((k, k))
    edges = np.cumsum([0, *(stretches or [count])])
    for first, last in pairwise(edges):
        part = U[first:last]
        correlation = autocovariance(residual[first:last], math.isqrt(last - first))
        middle += correlation[0] * (part.T @ part)
        for lag in range(1, len(correlation)):
            weight = 1.0 - lag / len(correlation)
            cross = part[:-lag].T @ part[lag:]
            middle += weight * correlation[lag] * (cross + cross.T)
    spread = count / max(count - k, 1)
    white = residual @ residual / count * inverse @ inverse.T
    return white * spread, inverse @ middle @ inverse.T * spread


def autocovariance(residual: Vector, lags: int) -> Vector:
    """Return the autocovariance (lags + 1,) of a residual (n,), mean not removed."""
    count = len(residual)
    return np.array([residual[: count - lag] @ residual[lag:] / count for lag in range(lags + 1)])


def _rms(residual: Vector) -> float:
    return float(np.sqrt(np.mean(residual**2)))
