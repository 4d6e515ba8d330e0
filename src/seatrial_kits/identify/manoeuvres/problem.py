"""Least-squares problem of several passes: weighted residual and Jacobian."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from seatrial.errors import InputError
from seatrial.model.expressions import Vector

from .craft import Craft
from .prediction import CURRENT, READINGS, STARTS, Motion, Predictor

_ROUNDS, _EVALUATIONS = 2, 30
ROUGH, FINE = 1e-3, 1e-7
"""Relative accuracy of a solution that is compared or shown alone, and of the result."""
_SPREAD = (0.01, 0.01, 0.01)
"""First scale of the residual of each reading, as a share of what the reading covers."""
_LEAST_SPREAD = 1e-9


@dataclass(frozen=True)
class Solution:
    """Unknowns at the least sum, with what is left."""

    unknowns: Vector
    """(k,): relative changes of the parameters, current over speed, states of each pass."""
    scales: Vector
    """(passes, 3): root mean square of the residual of each reading, m, m, rad."""
    residual: Vector
    """(n,) over ``scales``; pass by pass, reading by reading, row by row."""
    jacobian: Vector
    """(n, k) of the residual, by all unknowns."""


class Problem:
    """Passes of one craft, each in a current of its own, with the parameters looked for.

    Residuals are readings less those predicted, each divided by the scale of its own, which
    rounds of least squares find. Unknowns are the relative changes of the parameters, the
    currents over ``speed``, and the states at the first rows, pass by pass.
    """

    def __init__(self, craft: Craft, motions: Sequence[Motion], free: Sequence[str]) -> None:
        self.craft, self.motions, self.free = craft, motions, tuple(free)
        self.speed = max(_speed(motion) for motion in motions)
        self._predictors = [Predictor(craft, motion, free, self.speed) for motion in motions]
        self.currents = [[f"{name} {i + 1}" for name in CURRENT] for i in range(len(motions))]
        """Names of north and east of the current of each pass."""
        self.named = (*self.free, *(name for pair in self.currents for name in pair))
        """Names of the unknowns that may be kept: all but the states."""
        self.stretches = [len(motion.record.time) for motion in motions for _ in READINGS]
        """Lengths of the parts of the residual: readings of passes."""

    def guess(self) -> Vector:
        """Return the unknowns to start from: the file's parameters, no current."""
        places = self.craft.places(STARTS)
        starts = [motion.start[places] for motion in self.motions]
        return np.concatenate((np.zeros(len(self.named)), *starts))

    def readings(self, unknowns: Vector) -> list[Vector]:
        """Return what is predicted of each pass (3, n)."""
        return [predict(unknowns[self._places(i)])[0] for i, predict in enumerate(self._predictors)]

    def solve(
        self,
        looked_for: Sequence[str],
        start: Vector,
        *,
        scales: Vector | None = None,
        prior: float | None = None,
        accuracy: float = FINE,
    ) -> Solution:
        """Return the least sum over the unknowns ``looked_for`` and all states.

        The others keep what ``start`` has; the states start from there, or from `guess` if that is
        nearer to the logs. ``scales`` are those of the first round, None: a
        hundredth of what each reading covers. ``prior`` is the standard deviation that relative
        changes are held to, None: nothing holds them. ``accuracy`` is that of the sum and of the
        unknowns, relative. Raises InputError if the equations do not follow the orders.
        """
        places = [i for i, name in enumerate(self.named) if name in looked_for]
        places += range(len(self.named), len(start))
        scales = self._first_scales() if scales is None else scales
        unknowns = self._nearer(start, scales)
        for _ in range(_ROUNDS):
            unknowns = self._round(unknowns, places, scales, prior, accuracy)
            residual, jacobian = self._weighted(unknowns, scales)
            used, scales = scales, self._scales(residual, scales)
        ratio = np.repeat((used / scales).ravel(), self.stretches)
        return Solution(unknowns, scales, residual * ratio, jacobian * ratio[:, None])

    def _nearer(self, start: Vector, scales: Vector) -> Vector:
        """Return a copy of ``start``, with guessed states if these are nearer to the logs."""
        other = np.concatenate((start[: len(self.named)], self.guess()[len(self.named) :]))
        sums = [np.nan_to_num((self._weighted(each, scales)[0] ** 2).sum(), nan=np.inf)
                for each in (start, other)]  # fmt: skip
        return (start if sums[0] <= sums[1] else other).copy()

    def _round(
        self,
        start: Vector,
        places: list[int],
        scales: Vector,
        prior: float | None,
        accuracy: float,
    ) -> Vector:
        from scipy.optimize import least_squares

        unknowns, held = start.copy(), [p for p in places if p < len(self.named)]
        weight = 0.0 if prior is None else 1.0 / prior
        rows = np.zeros((len(held), len(places)))
        rows[np.arange(len(held)), [places.index(p) for p in held]] = weight
        last: list[Vector] = []

        def residual(z: Vector) -> Vector:
            unknowns[places] = z
            found, jacobian = self._weighted(unknowns, scales)
            last[:] = [np.vstack((jacobian[:, places], rows))]
            return np.concatenate((found, weight * unknowns[held]))

        try:
            found = least_squares(
                residual, start[places], jac=lambda _: last[0], x_scale="jac", ftol=accuracy,
                xtol=accuracy, gtol=accuracy, max_nfev=_EVALUATIONS,
            )  # fmt: skip
        except ValueError as error:  # what SciPy says of a first residual that is not finite
            raise InputError(
                f"the equations of {self.craft.name} do not follow the recorded orders: {error}"
            ) from None
        unknowns[places] = found.x
        return unknowns

    def _weighted(self, unknowns: Vector, scales: Vector) -> tuple[Vector, Vector]:
        residuals, jacobians = [], []
        for i, (motion, predict) in enumerate(zip(self.motions, self._predictors, strict=True)):
            readings, slopes = predict(unknowns[self._places(i)])
            weights = 1.0 / scales[i][:, None]
            residuals.append(((motion.measured - readings) * weights).ravel())
            whole = np.zeros((*readings.shape, len(unknowns)))
            whole[..., self._places(i)] = slopes
            jacobians.append(-(whole * weights[..., None]).reshape(-1, len(unknowns)))
        return np.concatenate(residuals), np.concatenate(jacobians)

    def _places(self, number: int) -> list[int]:
        """Return where the unknowns of a pass are, in the order of its predictor."""
        shared, named = len(self.free), len(self.named)
        current = [shared + len(CURRENT) * number + i for i in range(len(CURRENT))]
        own = [named + len(STARTS) * number + i for i in range(len(STARTS))]
        return [*range(shared), *current, *own]

    def _first_scales(self) -> Vector:
        spans = [np.ptp(motion.measured, axis=1) * _SPREAD for motion in self.motions]
        # North and east cover one place: a straight course along one has a span across, too.
        return np.array([[max(s[:2]), max(s[:2]), max(s[2], _SPREAD[2])] for s in spans])

    def _scales(self, residual: Vector, scales: Vector) -> Vector:
        edges = np.concatenate(([0], np.cumsum(self.stretches)))
        rms = [np.sqrt(np.mean(residual[a:b] ** 2)) for a, b in pairwise(edges)]
        found = np.reshape(rms, scales.shape) * scales
        return np.maximum(found, _LEAST_SPREAD * self._first_scales() / _SPREAD)


def _speed(motion: Motion) -> float:
    record = motion.record
    return record.track(record.start, record.end) / (record.end - record.start)
