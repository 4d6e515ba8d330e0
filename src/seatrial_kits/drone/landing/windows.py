"""Windows in which a deck will be quiet: where to touch down, and how to get there."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from seatrial.model.component import Component, Parameter

from . import laws, prediction
from .deck_estimate import DeckEstimate

_SEARCH = 0.1
"""Time between two searches, s."""
_TIMES = 29
"""Times that a search compares."""
_ENOUGH = 70
"""Samples from which on a window is looked for."""
_LEVEL, _HEAVE_RATE, _LATE = math.radians(4.0), 0.8, 0.35
_GOOD, _PATIENCE, _RISE = 0.5, 10.0, 0.1
_TILT = math.radians(9.0)
_TOUCH = 0.35
"""Speed into the deck that the rendezvous aims at, m/s."""


class Windows(DeckEstimate, Component):
    """Mix-in: choice of the touch-down's time by a prediction of the deck.

    Every 0.1 s, of the times T ahead from max(0.9 s, 1.1 s sqrt(height / 1 m)) to one peak period
    T_p more, that with the least

        (tilt / 4 deg)^2 + (heave rate / 0.8 m/s)^2 + (0.35 T / T_p)^2

    of the predicted deck is taken; it is committed to where that is below 0.5, a limit that rises
    by 0.1 per s after 10 s. ``predictor`` is "autoregressive", fitted every T_p / 4, or
    "harmonic" (`prediction`).
    """

    predictor = Parameter(
        "autoregressive", "1", "of the deck", choices=("autoregressive", "harmonic")
    )

    def reset_windows(self, t: float) -> None:
        """Have nothing fitted and no window."""
        self._fitted = [[0.0] * prediction.ORDER] * 3
        self._past = [[0.0] * prediction.ORDER] * 3
        self._means = [0.0] * 3
        self._fitted_at = self._searched = -math.inf
        self._future: list[Sequence[float]] = []
        self._future_of = -1
        self._target = -1.0
        self._foreseen = [0.0] * 3

    def forget_window(self) -> None:
        """Commit to nothing."""
        self._target = -1.0

    def finds_window(self, t: float, waited: float, height: float) -> bool:
        """Return whether there is a window now, and commit to it."""
        if t < self._searched + _SEARCH - 1e-9 or len(self._samples) < _ENOUGH:
            return False
        self._searched = t
        least = max(0.9, 1.1 * math.sqrt(max(height, 0.0)))
        cheapest, best = math.inf, least
        for place in range(_TIMES):
            T = least + place / (_TIMES - 1.0) * self.wave_period
            cost = self._cost(t, T)
            if cost < cheapest:
                cheapest, best = cost, T
        if cheapest >= _GOOD + _RISE * max(0.0, waited - _PATIENCE):
            return False
        self._target = t + best
        self._foreseen = self.predicted(self._target)
        return True

    def tilts_too_far(self, t: float) -> bool:
        """Return whether the deck is predicted to tilt by more than 9 degrees at touch-down."""
        if self._target <= t or len(self._samples) < _ENOUGH:
            return False
        self._foreseen = self.predicted(self._target)
        return _tilt(self._foreseen) > _TILT

    def meets(self, t: float, down: float, velocity: float, left: float) -> float:
        """Return the acceleration downwards that meets the predicted deck at the window.

        ``down`` and ``velocity`` are those of the feet, ``left`` the time to go.
        """
        at = self.predicted(self._target)
        half = 0.5 * self.sample_step()
        rising = self.predicted(self._target + half)[0] - self.predicted(self._target - half)[0]
        meeting = -rising / (2.0 * half) + _TOUCH
        return laws.rendezvous(-at[0] - down, velocity, meeting, left)

    def predicted(self, t: float) -> list[float]:
        """Return heave upwards, m, and slopes to north and east at ``t``."""
        newest, step = self._grid - 1, self.sample_step()
        steps = t / step - newest
        if len(self._samples) >= _ENOUGH and newest != self._future_of:
            self._future_of = newest
            self._future = []
            if self.predictor == "autoregressive":
                self._fit(newest * step)
        if self.predictor == "harmonic":
            self._foresee()
        while len(self._future) < min(steps + 1.0, prediction.FARTHEST):
            self._step()
        return prediction.at(self._future, steps)

    def _foresee(self) -> None:
        """Predict as far as ever, where that is not done."""
        if not self._future:
            samples = np.array(self._samples)
            for row in prediction.harmonic(samples, prediction.FARTHEST).tolist():
                self._future.append(row)

    def _fit(self, newest: float) -> None:
        """Begin a prediction at ``newest``, s; coefficients older than T_p / 4 are fitted again."""
        self._means = [prediction.mean(self._samples, column) for column in range(3)]
        self._past = [
            [self._samples[-1 - i][column] - mean for i in range(prediction.ORDER)]
            for column, mean in enumerate(self._means)
        ]
        if newest - self._fitted_at > 0.25 * self.wave_period:
            self._fitted_at = newest
            self._fitted = [
                prediction.coefficients(self._samples, column, mean)
                for column, mean in enumerate(self._means)
            ]

    def _step(self) -> None:
        """Predict one sample more."""
        new = [prediction.step(c, y) for c, y in zip(self._fitted, self._past, strict=True)]
        self._past = [[own, *y[:-1]] for own, y in zip(new, self._past, strict=True)]
        self._future.append([own + mean for own, mean in zip(new, self._means, strict=True)])

    def _cost(self, t: float, T: float) -> float:
        half = 0.5 * self.sample_step()
        at, before = self.predicted(t + T + half), self.predicted(t + T - half)
        rate = (at[0] - before[0]) / (2.0 * half)
        late = _LATE * T / self.wave_period
        tilted = _tilt([0.5 * (a + b) for a, b in zip(at, before, strict=True)]) / _LEVEL
        return float(tilted**2 + (rate / _HEAVE_RATE) ** 2 + late**2)


def _tilt(row: Sequence[float]) -> float:
    return math.atan(math.hypot(row[1], row[2]))
