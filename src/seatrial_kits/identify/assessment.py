"""Assessment of an identified model: fit, whiteness, rules of rejection."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seatrial.model.expressions import Vector

from .output_error import Estimate, autocovariance

LONGEST_DELAY = 0.5
LEAST_FIT = 0.70
MASS_RATIO = (1.0, 3.0)


@dataclass(frozen=True)
class Verdict:
    """A rule, whether the model keeps it, and what was found."""

    name: str
    passed: bool
    detail: str


@dataclass(frozen=True)
class Whiteness:
    """Autocorrelation of a residual at lags 1, 2, ..., and the bound of white noise."""

    correlation: Vector
    bound: float
    """95 % of the values are within it if the residual is white: 1.96 / sqrt(n)."""
    outside: int
    white: bool


def fit(measured: Vector, simulated: Vector) -> float:
    """Return 1 - |measured - simulated| / |measured - mean|: 1 is exact, 0 is the mean's."""
    spread = float(np.linalg.norm(measured - measured.mean()))
    return 1.0 - float(np.linalg.norm(measured - simulated)) / spread if spread else -np.inf


def whiteness(residual: Vector, lags: int = 25) -> Whiteness:
    """Return the normalised autocorrelation of a residual (n,) and whether it passes for white.

    White: at most 4 of 25 lags outside the bound, which white noise exceeds in 1 case of 140.
    """
    covariance = autocovariance(residual, lags)
    correlation = covariance[1:] / covariance[0]
    bound = 1.96 / float(np.sqrt(len(residual)))
    outside = int((np.abs(correlation) > bound).sum())
    return Whiteness(correlation, bound, outside, outside <= 4 * lags / 25)


def verdicts(
    estimate: Estimate, period: float, free_run_fit: float, mass: float, thrust: float
) -> list[Verdict]:
    """Return the rules that a model must keep, each with what was found.

    (a) thrust acts in the direction of its command; (b) the delay is at most 0.5 s; (c) a free
    run fits data that was held out to more than 70 %; (d) mass with added mass, or inertia with
    added inertia, is 1 to 3 times ``mass``, if the full command gives ``thrust`` (N and kg, N.m
    and kg.m2). ``period`` in s.
    """
    ratio = thrust / estimate.values["thrust"] / mass if estimate.values["thrust"] else np.inf
    delay, (least, most) = estimate.delay * period, MASS_RATIO
    return [
        Verdict(
            "thrust acts as commanded",
            estimate.values["thrust"] > 0.0,
            f"E/A = {estimate.values['thrust']:.4g}, above 0 is needed",
        ),
        Verdict(
            "the delay is short",
            delay <= LONGEST_DELAY + 1e-9,
            f"{delay:.4g} s, at most {LONGEST_DELAY:g} s",
        ),
        Verdict(
            "a free run fits data held out",
            free_run_fit > LEAST_FIT,
            f"{100.0 * free_run_fit:.1f} %, above {100.0 * LEAST_FIT:g} % is needed",
        ),
        Verdict(
            "mass with added mass is plausible",
            least <= ratio <= most,
            f"{ratio:.4g} times the mass without, {least:g} to {most:g} is needed",
        ),
    ]
