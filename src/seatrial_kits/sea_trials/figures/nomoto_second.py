"""Nomoto's second-order model of steering from a record, where it is identifiable."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from seatrial.errors import InputError

from .nomoto import covariance, helm_response, nomoto, solved
from .record import Array, Record

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
