"""Wind a few metres above the water, with gusts along, across and upwards."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Noise, Output, Parameter
from seatrial.model.sampled import Sampled
from seatrial.model.waypoints import NED

_FOOT = 0.3048
_HEIGHT = 20.0  # ft
_SHAPE = 0.177 + 0.000823 * _HEIGHT


class LowAltitudeWind(Noise, Sampled):
    """Mean wind W and first-order gusts with the intensities of MIL-F-8785C at h = 20 ft.

        sigma_w = 0.1 W,    sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4
        L_w = h,            L_u = L_v = h / (0.177 + 0.000823 h)^1.2             h, L in ft
        a_k = c a_(k-1) + sigma sqrt(1 - c^2) w_k,    c = exp(-W period / L)

    for each axis, stationary from the start, w standard normal; the vertical one times
    ``vertical_share``. Gusts are carried by W and the same at every height. ``direction`` is where
    the wind blows **to**, clockwise from north; ``direction_by`` = "seed" draws it uniformly.

    Below 10 ft the specification does not hold. Not modelled: Dryden's second order across the
    wind, shear, the lee of the craft.
    """

    views: ClassVar = {"wind": {"velocity": "velocity"}}
    exercised: ClassVar = {"mean_speed": 5.0, "direction": 0.4}

    period = Parameter(0.02, "s", "time between two values of the gusts", min=1e-6)
    mean_speed = Parameter(0.0, "m/s", "mean speed W", min=0.0)
    direction = Parameter(0.0, "rad", "direction that it blows to, clockwise from north")
    direction_by = Parameter("value", "1", "where the direction is from", choices=("value", "seed"))
    vertical_share = Parameter(0.3, "1", "of the vertical gusts", min=0.0)

    velocity = Output("m/s", "velocity of the air over ground, {n}", axes=NED)

    def reset(self, t: float) -> None:
        """Draw the direction and the first gusts."""
        W = self.mean_speed
        across = 0.1 * W / _SHAPE**0.4
        self._sigma = [across, across, 0.1 * W * self.vertical_share]
        lengths = [_HEIGHT / _SHAPE**1.2 * _FOOT] * 2 + [_HEIGHT * _FOOT]
        self._kept = [math.exp(-W * self.period / length) for length in lengths]
        draw = float(self.generator(0, 1).random())
        self._to = math.tau * draw if self.direction_by == "seed" else self.direction
        normal = self.generator(0).standard_normal(3).tolist()
        self._gust = [s * v for s, v in zip(self._sigma, normal, strict=True)]

    def sample(self, t: float, k: int) -> None:
        """Publish mean and gusts in {n}."""
        c, s = math.cos(self._to), math.sin(self._to)
        along, aside, down = self._gust[0] + self.mean_speed, self._gust[1], self._gust[2]
        self.velocity = c * along - s * aside, s * along + c * aside, down

    def update(self, t: float, k: int) -> None:
        """Go on to the next gusts."""
        normal = self.generator(k + 1).standard_normal(3).tolist()
        parts = zip(self._gust, self._sigma, self._kept, normal, strict=True)
        self._gust = [c * a + s * math.sqrt(1.0 - c * c) * v for a, s, c, v in parts]
