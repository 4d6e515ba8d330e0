"""Wind over the water: a mean, coloured gusts, and one gust of a given shape."""

from __future__ import annotations

import math
from typing import ClassVar

from ...model.component import Noise, Output, Parameter
from ...model.sampled import Sampled
from ..sea.parameters import MeetsWind


class Wind(MeetsWind, Noise, Sampled):
    """Uniform horizontal wind with gusts, by speed and the direction it blows to.

        speed     = mean_speed max(0, 1 + intensity a_k + g(t))                   m/s
        direction = mean_direction + direction_deviation b_k                      rad
        velocity  = speed (cos direction, sin direction)                          {n}, m/s
        g(t)      = gust_size (1 - cos(2 pi (t - gust_start) / gust_duration)) / 2

    within ``gust_duration`` of ``gust_start``, else g = 0. a and b are first-order
    Gauss-Markov sequences of mean 0 and standard deviation 1, stationary from the start, drawn
    every ``period`` and held in between:

        a_k = c a_(k-1) + sqrt(1 - c^2) w_k,   c = exp(-period / correlation_time)

    with w standard normal (b alike): noise of constant spectral density through a first-order
    lag, sampled. g is exact at every communication point. Instants are counted from the start
    of the run, so that wind does not depend on the communication step; two runs with one
    ``seed`` have the same wind.

    Direction rad, clockwise from north, where the wind blows **to**: 0 is a southerly wind.

    The wind of a trial (`MeetsWind`) takes the place of all this, at ``height``: its mean there,
    its spectrum and its gust.

    Not modelled: shear over what meets the wind, wind that differs from place to place, gusts
    that travel.
    """

    transient = Sampled.transient | {"_of_trial"}
    views: ClassVar = {"wind": {"velocity": "velocity"}}

    period = Parameter(0.1, "s", "time between two values of the gusts", min=1e-6)
    mean_speed = Parameter(5.0, "m/s", "mean speed", min=0.0)
    mean_direction = Parameter(0.0, "rad", "mean direction that it blows to, from north")
    intensity = Parameter(0.0, "1", "standard deviation of the speed over its mean", min=0.0)
    direction_deviation = Parameter(0.0, "rad", "standard deviation of the direction", min=0.0)
    correlation_time = Parameter(8.0, "s", "correlation time of the gusts", min=1e-6)
    gust_size = Parameter(0.0, "1", "peak of the single gust over the mean speed")
    gust_start = Parameter(60.0, "s", "time at which the single gust begins")
    gust_duration = Parameter(10.0, "s", "duration of the single gust", min=1e-6)

    height = Parameter(10.0, "m", "height above the water at which a trial's wind is met", min=0.0)

    velocity = Output(
        "m/s", "velocity of the air over ground: where it blows to, {n}", axes=("north", "east")
    )
    speed = Output("m/s", "speed")
    direction = Output("rad", "direction that it blows to, clockwise from north")

    def reset(self, t: float) -> None:
        """Start the gusts anywhere in their distribution."""
        self._of_trial = self.wind_state()
        self._kept = math.exp(-self.period / self.correlation_time)
        self._gusts = self._held = self._drawn(0)

    def sample(self, t: float, k: int) -> None:
        """Let the gusts of this instant blow."""
        self._held = list(self._gusts)

    def update(self, t: float, k: int) -> None:
        """Draw the next gusts."""
        grown = math.sqrt(1.0 - self._kept**2)
        self._gusts = [
            self._kept * old + grown * new
            for old, new in zip(self._gusts, self._drawn(k + 1), strict=True)
        ]

    def hold(self, t: float) -> None:
        """Publish the wind at ``t``."""
        if not hasattr(self, "_of_trial"):  # restored from a saved state
            self._of_trial = self.wind_state()
        if not self._of_trial.is_absent:
            north, east = self._of_trial.velocity(t, self.height).tolist()
            self.velocity = north, east
            self.speed, self.direction = math.hypot(north, east), self.wind_direction
            return
        fast, turned = self._held
        share = 1.0 + self.intensity * fast + self._single_gust(t)
        speed = self.mean_speed * max(0.0, share)
        direction = self.mean_direction + self.direction_deviation * turned
        self.speed, self.direction = speed, direction
        self.velocity = speed * math.cos(direction), speed * math.sin(direction)

    def _drawn(self, k: int) -> list[float]:
        if not (self.intensity or self.direction_deviation):
            return [0.0, 0.0]
        drawn: list[float] = self.generator(k).standard_normal(2).tolist()
        return drawn

    def _single_gust(self, t: float) -> float:
        passed = (t - self.gust_start) / self.gust_duration
        if not 0.0 < passed < 1.0:
            return 0.0
        gust: float = 0.5 * self.gust_size * (1.0 - math.cos(math.tau * passed))
        return gust
