"""Nomoto's first-order model of steering from a record, by least squares, with its uncertainty."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares
from scipy.signal import lfilter

from seatrial.errors import InputError

from .record import Array, Record

_ITERATIONS, _CONVERGED = 50, 1e-9
_EQUAL = 1e-9
"""Difference of the decays over rows that are equally spaced, but for rounding."""


@dataclass(frozen=True)
class Nomoto:
    """T r' + r = K (delta + delta_0), r in rad/s and delta in rad, positive to starboard.

    ``deviations`` are standard deviations of K, T and delta_0; an interval of 1.96 of them
    contains the value with a probability of 95 %, as far as the vessel is of first order.
    """

    K: float
    """1/s."""
    T: float
    """s."""
    delta_0: float
    """Helm that is missing for a straight course, rad."""
    residual: float
    """Root mean square of the heading less that of the model, rad."""
    deviations: tuple[float, float, float]

    def nondimensional(self, length: float, speed: float) -> tuple[float, float]:
        """Return K' = K L / U and T' = T U / L of a length, m, and a speed, m/s."""
        return self.K * length / speed, self.T * speed / length


def nomoto(record: Record) -> Nomoto:
    """Return Nomoto's model of a record with helm angle, best a zig-zag.

    A first estimate comes from the equation integrated twice over time, so that the heading need
    not be differentiated; it is linear in c_0, c_1, 1/T, K/T and K delta_0 / T:

        psi(t) = c_0 + c_1 t + (K iint delta + K delta_0 t^2 / 2 - int psi) / T

    Noise of the heading enters int psi. The heading that the equation gives with the helm alone,

        psi(t) = psi_0 + r_0 T (1 - exp(-t/T)) + K g(t) + K delta_0 h(t),

    g and h the responses to the helm and to 1, has none: its least squares by Gauss and Newton
    give K, T and delta_0. Helm is linear between rows. The covariance is that of least squares
    with residuals whose autocorrelation, to lags of the square root of the rows with Bartlett's
    weights, is that found; corners of the helm between rows are not in it.

    Raises InputError without helm, with a helm that never changes, and where no positive T fits.
    """
    if record.helm is None or not np.ptp(record.helm):
        raise InputError("Nomoto's model needs a helm that changes")
    time = record.time - record.start
    T = _first_estimate(record, time)
    for _ in range(_ITERATIONS):
        basis, slopes = _responses(time, record.helm, T)
        linear = solved(basis, record.heading)
        design = np.column_stack((basis, slopes @ linear))
        change = float(solved(design, record.heading - basis @ linear)[-1])
        T = max(T + change, T / 2.0)
        if abs(change) < _CONVERGED * T:
            break
    else:
        raise InputError("Nomoto's model: no T fits the record; is the vessel of first order?")
    residual = record.heading - basis @ linear
    deviations = _deviations(covariance(design, residual), linear)
    rms = float(np.sqrt(np.mean(residual**2)))
    return Nomoto(float(linear[2]), T, float(linear[3] / linear[2]), rms, deviations)


def _deviations(covariance: Array, linear: Array) -> tuple[float, float, float]:
    """Return the standard deviations of K, T and delta_0, the latter K delta_0 / K."""
    gain, offset = linear[2:]
    ratio = np.array([-offset / gain**2, 1.0 / gain])
    variances = covariance[2, 2], covariance[4, 4], ratio @ covariance[2:4, 2:4] @ ratio
    K, T, delta_0 = (math.sqrt(each) for each in variances)
    return K, T, delta_0


def solved(design: Array, wanted: Array) -> Array:
    """Return the least-squares solution; raises InputError where it is not unique."""
    scale = np.sqrt((design**2).sum(axis=0))
    solution, _, rank, _ = np.linalg.lstsq(design / scale, wanted, rcond=None)
    if rank < design.shape[1]:
        raise InputError("Nomoto's model: the record does not distinguish K, T and delta_0")
    return np.asarray(solution / scale)


def _first_estimate(record: Record, time: Array) -> float:
    inverse = float(solved(_design(record, time), record.heading)[2])
    if inverse <= 0.0:
        raise InputError(f"Nomoto's model: 1/T is {inverse:.3g} 1/s, above 0 is needed")
    return 1.0 / inverse


def _responses(time: Array, helm: Array, T: float) -> tuple[Array, Array]:
    """Return the columns (n, 4) of the heading for psi_0, r_0, K, K delta_0, and their d/dT."""
    columns, slopes = [np.ones_like(time)], [np.zeros_like(time)]
    decay = np.exp(-time / T)
    columns.append(T * (1.0 - decay))
    slopes.append(1.0 - decay * (1.0 + time / T))
    step = time - T * (1.0 - decay)
    heading, slope = helm_response(time, helm, T)
    columns += [heading, step]
    slopes += [slope, -slopes[1]]
    return np.column_stack(columns), np.column_stack(slopes)


def helm_response(time: Array, helm: Array, T: float) -> tuple[Array, Array]:
    """Return the heading (n,) by T r' + r = delta from rest, and its derivative by T.

    From the equation psi = int delta - T r; its derivative by T, q, obeys T q'' + q' = -r', so
    that T q' + q = -r.
    """
    once = _integral(time, helm)
    rate = _lagged(time, helm, T)
    return once - T * rate, _lagged(time, -rate, T)


def _integral(time: Array, values: Array) -> Array:
    steps = np.diff(time)
    return np.concatenate(([0.0], np.cumsum(steps * (values[1:] + values[:-1]) / 2.0)))


def _lagged(time: Array, values: Array, T: float) -> Array:
    """Return y (n,) of T y' + y = values from 0, exact for values that are linear between rows."""
    steps = np.diff(time)
    decay, slopes = np.exp(-steps / T), np.diff(values) / steps
    driven = (values[:-1] - T * slopes) * (1.0 - decay) + slopes * steps
    if np.ptp(decay) < _EQUAL:
        return np.concatenate(([0.0], lfilter([1.0], [1.0, -decay[0]], driven)))
    lagged, result = 0.0, [0.0]
    for share, added in zip(decay.tolist(), driven.tolist(), strict=True):
        lagged = lagged * share + added
        result.append(lagged)
    return np.array(result)


def _design(record: Record, time: Array) -> Array:
    """Return the columns (n, 5) of the equation integrated twice."""
    integral = CubicSpline(time, record.heading).antiderivative()
    steps, helm = np.diff(time), record.helm
    once = _integral(time, helm)
    # Twice, with helm linear over each row: once h + h^2 (2 delta_k + delta_k+1) / 6.
    grown = steps * once[:-1] + steps**2 * (2.0 * helm[:-1] + helm[1:]) / 6.0
    twice = np.concatenate(([0.0], np.cumsum(grown)))
    return np.column_stack((np.ones_like(time), time, -integral(time), twice, time**2 / 2.0))


def covariance(design: Array, residual: Array) -> Array:
    """Return the covariance (k, k) of a least-squares estimate with correlated residuals.

    ``design`` (n, k) and ``residual`` (n,); autocorrelation to lags of sqrt(n), Bartlett's weights.
    """
    scale = np.sqrt((design**2).sum(axis=0))
    design = design / scale
    rows, count = design.shape
    lags = math.isqrt(rows)
    scatter = np.zeros((count, count))
    for lag in range(lags + 1):
        correlation = float(residual[lag:] @ residual[: rows - lag]) / (rows - count)
        product = design[lag:].T @ design[: rows - lag]
        weight = 1.0 - lag / (lags + 1)
        scatter += weight * correlation * (product if lag == 0 else product + product.T)
    inverse = np.linalg.inv(design.T @ design)
    return np.asarray(inverse @ scatter @ inverse / np.outer(scale, scale))


_CERTAIN = 0.25
"""Largest standard deviation of a time constant, as a share of it."""
_SPREAD = 5.0
"""First guess of T1 / T2."""
_SHIFT = 1e-4
"""Relative step of differences by T1 and T2."""


@dataclass(frozen=True)
class SecondOrder:
    """T1 T2 r'' + (T1 + T2) r' + r = K (delta + delta_0 + T3 delta'), T1 > T2.

    r in rad/s and delta in rad, positive to starboard; K in 1/s, T1, T2, T3 in s.
    ``deviations`` are standard deviations of these four.
    """

    K: float
    T1: float
    T2: float
    T3: float
    deviations: tuple[float, float, float, float]


def nomoto_second(record: Record) -> SecondOrder:
    """Return Nomoto's second-order model of a record with helm angle ([Nomoto1957]).

    In partial fractions it is the sum of two lags of first order, A / (1 + T1 s) + B / (1 + T2 s),
    K = A + B, K T3 = A T2 + B T1, and the heading, linear in all but T1 and T2,

        psi(t) = c_0 + c_1 t + c_2 exp(-t/T1) + c_3 exp(-t/T2) + A g_T1(t) + B g_T2(t),

    with g_T the response of the lag T to the helm. T1 and T2 are those of the least sum of
    squares; the rest follows from them (variable projection, [Golub1973]).

    Raises InputError as `nomoto` does, and where a standard deviation of T1, T2 or T3 is above a
    quarter of the value: a vessel of first order, or a record that does not show more.
    """
    first, time = nomoto(record), record.time - record.start

    def left(logarithms: Array) -> Array:
        basis = _basis(time, record.helm, np.exp(logarithms))
        return np.asarray(record.heading - basis @ solved(basis, record.heading))

    start = np.log([first.T, first.T / _SPREAD])
    found = least_squares(left, start, x_scale=1.0)
    T1, T2 = sorted(np.exp(found.x).tolist(), reverse=True)
    basis = _basis(time, record.helm, np.array([T1, T2]))
    linear = solved(basis, record.heading)
    slopes = [
        (_basis(time, record.helm, shifted) - basis) @ linear / (_SHIFT * T)
        for T, shifted in ((T1, np.array([T1 * (1.0 + _SHIFT), T2])),
                           (T2, np.array([T1, T2 * (1.0 + _SHIFT)])))
    ]  # fmt: skip
    residual = record.heading - basis @ linear
    spread = covariance(np.column_stack((basis, *slopes)), residual)[4:, 4:]
    A, B = linear[4:]
    K, T3 = A + B, (A * T2 + B * T1) / (A + B)
    gradients = np.array([
        [1.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [(T2 - T3) / K, (T1 - T3) / K, B / K, A / K],
    ])  # fmt: skip
    variances = np.einsum("ij,jk,ik->i", gradients, spread, gradients)
    deviations = tuple(math.sqrt(max(each, 0.0)) for each in variances)
    for name, value, deviation in zip(("T1", "T2", "T3"), (T1, T2, T3), deviations[1:],
                                      strict=True):  # fmt: skip
        if not deviation <= _CERTAIN * abs(value):
            raise InputError(
                f"Nomoto's model of second order: {name} is {value:.3g} s with a standard "
                f"deviation of {deviation:.2g} s: the record shows a vessel of first order"
            )
    return SecondOrder(float(K), T1, T2, float(T3), deviations)  # type: ignore[arg-type]


def _basis(time: Array, helm: Array, lags: Array) -> Array:
    """Return the columns (n, 6) of the heading."""
    decays = [np.exp(-time / T) for T in lags]
    responses = [helm_response(time, helm, T)[0] for T in lags]
    return np.column_stack((np.ones_like(time), time, *decays, *responses))
