"""Sonar with a fan beam that is turned step by step, or stands still."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from seatrial.devices.sensor import Derived, Measured, Value, full_circle
from seatrial.model.component import Parameter, terminal

from .seabed.vectors import Vector, dot
from .sounding import Sounding

BINS = 64
"""Intensities of a ping, from the transducer to the greatest range."""
_DEG = math.radians(1.0)
_ACROSS, _UP = 3, 15
"""Rays of the beam, in its width and its height."""
_BINS = tuple(f"i{number}" for number in range(1, BINS + 1))


class ScanningSonar(Sounding):
    """Echo intensity over range in one direction after the other.

    The head turns about the body's z axis: ping k looks to ``angle`` from the bow, to starboard,
    which goes through ``sector`` from ``angle_start`` in steps of ``step_angle``, round and round
    for a full circle, else to and fro. A ``step_angle`` of 0 is a fixed single-beam sonar. The
    beam is ``width`` by ``height`` (full angles) about that direction in the plane of the deck,
    as 3 x 15 equal rays. A ray that first meets something at range r, at the angle g from its
    normal, adds

        s cos(g)^2 / 45

    to the bin of (assumed_sound_speed / sound_speed) r: Lambert's law, with s the strength of
    what it meets; spreading and absorption are made up for by the gain over time. So 1 is a
    wall that fills the beam face to face, and behind an obstacle there is shadow. `Sensor` adds
    its errors, and what is left is held between 0 and 1. ``distance`` is the middle of the first
    bin above ``threshold``.

    Defaults: Blue Robotics Ping360, as its maker has it: beam 2 x 25 degrees, up to 50 m, here
    20 m in 64 bins; assumed: 1.8 degrees every 0.1 s, strength 1 of obstacles, 0.3 of the
    bottom, 0.5 of the surface, noise 0.01.

    Not modelled: side lobes, reflections by more than one face, time of travel, speckle.
    """

    exercised: ClassVar = {
        "seabed_depth": 4.0,
        "place": [0.2, 0.1, 0.3],
        "height": 2.0,
        "range_max": 10.0,
        "intensity_noise": 0.0,
        "step_angle": 0.5,
    }

    period = Parameter(0.1, "s", "time from ping to ping", min=1e-6)
    range_max = Parameter(20.0, "m", "greatest range", min=1e-3)
    width = Parameter(2.0 * _DEG, "rad", "beam in the plane of the deck, full angle", min=0.0)
    height = Parameter(25.0 * _DEG, "rad", "beam across that plane, full angle", min=0.0, max=3.1)
    angle_start = Parameter(0.0, "rad", "first direction, from the bow to starboard")
    sector = Parameter(math.tau, "rad", "sector that is scanned", min=0.0, max=6.283186)
    step_angle = Parameter(
        1.8 * _DEG, "rad", "angle from ping to ping, 0: it stands still", min=0.0
    )
    threshold = Parameter(0.05, "1", "intensity that is an echo", min=0.0)
    obstacle_strength = Parameter(1.0, "1", "strength of obstacles", min=0.0, max=1.0)
    bottom_strength = Parameter(0.3, "1", "strength of the bottom", min=0.0, max=1.0)
    surface_strength = Parameter(0.5, "1", "strength of the surface", min=0.0, max=1.0)

    intensity = Measured(
        "1",
        "intensity in equal bins from the transducer to the greatest range",
        axes=_BINS,
        span=(0.0, 1.0),
        noise=0.01,
    )
    angle = Measured(
        "rad", "direction of the ping, from the bow to starboard, 0 to 2 pi", span=(0.0, math.tau)
    )
    distance = Derived("m", "range of the first echo", validity="whole")

    terminals: ClassVar = {"motion": terminal("position", "attitude")}

    def measure(self) -> Sequence[Value]:
        """Return the intensities of a ping, and where it looks."""
        origin = self.transducer()
        if origin[2] < 0.0:
            return [None] * (BINS + 1)
        strength = {"bottom": self.bottom_strength, "surface": self.surface_strength}
        angle, scene, bins = self._angle(self._next), self.scene(), [0.0] * BINS
        for ray in self._rays(angle):
            hit = scene.ray(origin, ray, self.range_max)
            if hit is None:
                continue
            place = int(BINS * self.shown * hit.distance / self.range_max)
            if place < BINS:
                part = strength.get(hit.target, self.obstacle_strength)
                bins[place] += part * dot(hit.normal, ray) ** 2 / (_ACROSS * _UP)
        return [*bins, angle]

    def finish(self, values: list[float]) -> list[float]:
        """Return intensities from 0 to 1 and the angle in [0, 2 pi)."""
        *bins, angle = values
        return [*(min(max(each, 0.0), 1.0) for each in bins), full_circle(angle)]

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return the range of the first echo."""
        for place, found in enumerate(values[:BINS]):
            if found is not None and found > self.threshold:
                return [(place + 0.5) * self.range_max / BINS]
        return [None]

    def _angle(self, k: int) -> float:
        """Return the direction of ping ``k``, rad."""
        turned: float = k * self.step_angle
        if self.sector < math.tau - 1e-6:
            turned = (
                self.sector - abs(turned % (2.0 * self.sector) - self.sector)
                if self.sector
                else 0.0
            )
        return full_circle(self.angle_start + turned)

    def _rays(self, angle: float) -> list[Vector]:
        """Return the rays of a ping, {n}: those in the middle of equal parts of the beam."""
        rays = []
        for i in range(_ACROSS):
            turn = angle + self.width * ((i + 0.5) / _ACROSS - 0.5)
            for j in range(_UP):
                dive = self.height * ((j + 0.5) / _UP - 0.5)
                c, s = math.cos(dive), math.sin(dive)
                rays.append(self.turned((c * math.cos(turn), c * math.sin(turn), s)))
        return rays
