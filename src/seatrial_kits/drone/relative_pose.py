"""Camera on a drone that measures where the mark of a landing pad is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from seatrial.devices.sensor import Derived, Measured, Sensor, Value
from seatrial.model.component import Input, Parameter, terminal
from seatrial.model.waypoints import NED
from seatrial.physics.craft.kinematics import Vector3, cross, to_body, to_ned

_DEG = math.pi / 180.0
_CHAIN, _PLACE, _ERROR = 3, 4, 5
"""Streams of the dropouts, of the errors of a measurement, and of those of a run."""


class RelativePose(Sensor):
    """Position of a landing pad from a drone's CG, by a camera that looks along the drone's z.

    With b the pad from the CG in the drone's body axes, and (x, y, z) the same from the lens, which
    is ``lens`` below the CG, the mark is seen where

        sqrt(x^2 + y^2) < z tan(half_angle) + mark_reach,   least < z,   |b| < reach

    Each component of b has white noise of ``noise_floor`` + ``noise_share`` |b| + ``exposure`` |w|
    |b|: resolution, which falls with distance, and blur while the drone turns with w. The
    drone's own error of attitude, constant in a run, turns the line of sight: ``attitude_error``
    is the standard deviation of its roll and pitch. With a the attitude and e that error:

        offset = R(a) (b + e x b + noise)     m, {n}, from the CG to the pad

    Dropouts are a two-state chain: lost for ``lost_time`` on average, then seen for
    ``seen_time``; ``lost_time`` 0 for none. ``exposed`` is the time of exposure; offset and
    exposure come ``delay`` later, and stay while ``valid`` is false.

    Not modelled: images, occlusion by the drone's legs, glare, false marks, heading of the pad.
    """

    exercised: ClassVar = {
        "deck_position": [0.2, 0.1, 3.0],
        "rates": [0.2, 0.1, 0.0],
        "exposure": 0.02,
    }

    period = Parameter(0.05, "s", "time from frame to frame", min=1e-6)
    delay = Parameter(0.06, "s", "time from exposure to output", min=0.0)
    lens = Parameter(0.10, "m", "height of the CG over the lens", min=0.0)
    half_angle = Parameter(40.0 * _DEG, "rad", "half of the field of view", min=0.0, max=1.5)
    mark_reach = Parameter(0.15, "m", "half size of the bundle of marks", min=0.0)
    least = Parameter(0.05, "m", "least distance along the axis", min=0.0)
    reach = Parameter(12.0, "m", "largest distance", min=0.0)
    noise_floor = Parameter(0.01, "m", "white noise of each component, close by", min=0.0)
    noise_share = Parameter(0.005, "1", "white noise by the distance", min=0.0)
    exposure = Parameter(0.0, "s", "time of exposure, that blurs a turning image", min=0.0)
    attitude_error = Parameter(
        0.5 * _DEG, "rad", "error of the drone's roll and pitch, constant in a run", min=0.0
    )
    seen_time = Parameter(5.0, "s", "mean time between dropouts", min=1e-6)
    lost_time = Parameter(0.25, "s", "mean time of a dropout; 0: there are none", min=0.0)
    pad = Parameter((0.0, 0.0, -0.2), "m", "landing point from the craft's origin", axes="xyz")

    position = Input("m", "CG of the drone in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles of the drone, ZYX", axes=("phi", "theta", "psi"))
    rates = Input("rad/s", "angular velocity, body axes", axes="pqr")
    deck_position = Input("m", "origin of the craft in {n}", axes="xyz", frame="n")
    deck_attitude = Input("rad", "Euler angles of the craft", axes=("phi", "theta", "psi"))

    offset = Measured("m", "pad from the CG of the drone, {n}", axes=NED, span=(-12.0, 12.0))
    exposed = Derived("s", "time of the exposure")

    terminals: ClassVar = {
        "motion": terminal("position", "attitude", "rates"),
        "deck": terminal(position="deck_position", attitude="deck_attitude"),
        "sight": terminal("offset", "exposed", sight_valid="valid", sight_count="count"),
    }

    views: ClassVar = {
        "field-of-view": {
            "attitude": "attitude",
            "height": "lens",
            "angle": "half_angle",
            "reach": "reach",
            "seen": "valid",
        }
    }

    _SEEN = ("position", "attitude", "deck_position", "deck_attitude", "fault")
    feedthrough: ClassVar = {
        "valid": _SEEN,
        "count": _SEEN,
        "offset": (*_SEEN, "rates"),
        "exposed": (),
    }

    def reset(self, t: float) -> None:
        """Start with the mark unhindered, and with the attitude's error of the run."""
        normal = self.generator(0, _ERROR).standard_normal(2).tolist()
        self._turned = [self.attitude_error * v for v in normal]
        self._hidden = False
        super().reset(t)

    def update(self, t: float, k: int) -> None:
        """Go on to the next state of the dropouts."""
        super().update(t, k)
        mean = self.lost_time if self._hidden else self.seen_time
        leaves = float(self.generator(k, _CHAIN).random())
        if self.lost_time and leaves < -math.expm1(-self.period / mean):
            self._hidden = not self._hidden

    def measure(self) -> Sequence[Value]:
        """Return the pad from the CG, None where the mark is not seen."""
        b = self._sight()
        x, y, z = b[0], b[1], b[2] - self.lens
        distance = math.hypot(*b)
        within = math.hypot(x, y) < z * math.tan(self.half_angle) + self.mark_reach
        if self._hidden or not within or z <= self.least or distance >= self.reach:
            return [None] * 3
        turning = math.hypot(*self.rates)
        noise = self.noise_floor + (self.noise_share + self.exposure * turning) * distance
        normal = self.generator(self._next, _PLACE).standard_normal(3).tolist()
        swung = cross((self._turned[0], self._turned[1], 0.0), b)
        return list(
            to_ned(
                self.attitude, [p + s + noise * v for p, s, v in zip(b, swung, normal, strict=True)]
            )
        )

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return the time of exposure."""
        return [self._instant_ns() * 1e-9]

    def _sight(self) -> Vector3:
        """Return the pad from the CG in the drone's body axes."""
        arm = to_ned(self.deck_attitude, self.pad)
        away = [d + a - p for d, a, p in zip(self.deck_position, arm, self.position, strict=True)]
        return to_body(self.attitude, away)
