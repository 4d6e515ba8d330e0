"""Positioning of a vehicle by range and direction from one station: USBL."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from seatrial.devices.sensor import Derived, Measured, Sensor, Value, full_circle
from seatrial.model.component import NS, Input, Parameter, terminal
from seatrial.physics.craft.kinematics import Vector3, to_body, to_ned

_DEG = math.radians(1.0)
_NOTHING = (None, None, None)


class Usbl(Sensor):
    """Ultra-short baseline: a station asks, the vehicle's transponder answers.

    With r the vector from transceiver to transponder in the station's body axes, it measures

        range      = (assumed_sound_speed / sound_speed) |r|                      m
        bearing    = atan2(r_y, r_x)          from the station's bow, [0, 2 pi)   rad
        depression = atan2(r_z, sqrt(r_x^2 + r_y^2))       below its horizontal   rad

    with the errors of `Sensor`. ``position_n`` is that of the transponder from these, with the
    station's own pose, which is taken as known, at the time of asking. Where the station is and
    how it lies are inputs: connect a ship's motion, or leave them for one that is fixed.

    With probability ``outlier`` what is received is a reflection: up to ``outlier_range`` too far
    and from any bearing. The next question follows at the next ``period``; an answer arrives
    2 |r| / sound_speed and ``delay`` after it. Beyond ``range_max``, and with either end out of
    the water, there is none; that is known when the time for the farthest answer is over.

    Defaults, all assumed: a small system for ROVs of 500 m, every second, with 0.1 m and 1 degree
    of noise and 1 degree of slow error, transceiver 1 m below the station.

    Not modelled: rays that bend, noise that grows with the range, shadow by the hull, motion
    while the sound travels.
    """

    exercised: ClassVar = {"outlier": 0.3, "outlier_range": 5.0, "place": [0.2, 0.1, 0.3]}

    period = Parameter(1.0, "s", "time from question to question", min=1e-6)
    delay = Parameter(0.1, "s", "time from an answer to its output", min=0.0)
    place = Parameter(0.0, "m", "transponder from the vehicle's origin, body axes", axes="xyz")
    transceiver = Parameter(
        (0.0, 0.0, 1.0), "m", "transceiver from the station's origin, its axes", axes="xyz"
    )
    sound_speed = Parameter(1500.0, "m/s", "mean speed of sound on the way", min=1.0)
    assumed_sound_speed = Parameter(1500.0, "m/s", "speed that the station is set to", min=1.0)
    range_max = Parameter(500.0, "m", "greatest range", min=0.0)
    outlier = Parameter(0.0, "1", "probability of a reflection", min=0.0, max=1.0)
    outlier_range = Parameter(20.0, "m", "most that a reflection is too far", min=0.0)

    position = Input("m", "vehicle's origin in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "vehicle's Euler angles, ZYX", axes=("phi", "theta", "psi"))
    station_position = Input(
        "m", "station's origin in north-east-down", axes="xyz", frame="n", optional=True
    )
    station_attitude = Input(
        "rad", "station's Euler angles, ZYX", axes=("phi", "theta", "psi"), optional=True
    )

    range = Measured("m", "slant range to the transponder", span=(0.0, 500.0), noise=0.1)
    bearing = Measured(
        "rad",
        "bearing of the transponder from the station's bow, 0 to 2 pi",
        span=(0.0, math.tau),
        noise=_DEG,
        instability=_DEG,
    )
    depression = Measured(
        "rad",
        "angle of the transponder below the station's horizontal",
        span=(-math.pi / 2, math.pi / 2),
        noise=_DEG,
        instability=_DEG,
    )
    position_n = Derived(
        "m", "position of the transponder, north-east-down", axes=("north", "east", "down")
    )

    # Sound takes its time: nothing arrives at the instant of the question.
    feedthrough: ClassVar = dict.fromkeys(
        ("valid", "count", "range", "bearing", "depression", "position_n"), ()
    )
    terminals: ClassVar = {
        "motion": terminal("position", "attitude"),
        "station": terminal(position="station_position", attitude="station_attitude"),
        "reading": terminal("position_n", position_valid="valid"),
    }

    def measure(self) -> Sequence[Value]:
        """Return range, bearing and depression of what is received."""
        if not self._answers():
            return _NOTHING
        x, y, z = to_body(self.station_attitude, self._away())
        found = self.assumed_sound_speed / self.sound_speed * math.hypot(x, y, z)
        bearing = math.atan2(y, x)
        if self.outlier:
            reflected, farther, turned = self.generator(self._next, 2).random(3).tolist()
            if reflected < self.outlier:
                found += farther * self.outlier_range
                bearing += math.tau * turned
        return [found, bearing, math.atan2(z, math.hypot(x, y))]

    def finish(self, values: list[float]) -> list[float]:
        """Return a range that is not negative and the bearing in [0, 2 pi)."""
        found, bearing, depression = values
        return [max(0.0, found), full_circle(bearing), depression]

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return the transponder's position from what was measured."""
        found, bearing, depression = (value or 0.0 for value in values)
        level = found * math.cos(depression)
        own = (level * math.cos(bearing), level * math.sin(bearing), found * math.sin(depression))
        away = to_ned(self.station_attitude, own)
        return [s + a for s, a in zip(self._transceiver(), away, strict=True)]

    def travel_ns(self) -> int:
        """Return the time of question and answer, or that after which none is waited for, ns."""
        away = math.hypot(*self._away()) if self._answers() else self.range_max
        taken: int = round(NS * 2.0 * away / self.sound_speed)
        return taken

    def _transceiver(self) -> Vector3:
        arm = to_ned(self.station_attitude, self.transceiver)
        x, y, z = (p + a for p, a in zip(self.station_position, arm, strict=True))
        return (x, y, z)

    def _transponder(self) -> Vector3:
        arm = to_ned(self.attitude, self.place)
        x, y, z = (p + a for p, a in zip(self.position, arm, strict=True))
        return (x, y, z)

    def _away(self) -> Vector3:
        """Return the vector from transceiver to transponder, {n}, m."""
        x, y, z = (a - b for a, b in zip(self._transponder(), self._transceiver(), strict=True))
        return (x, y, z)

    def _answers(self) -> bool:
        submerged = self._transponder()[2] >= 0.0 and self._transceiver()[2] >= 0.0
        return submerged and math.hypot(*self._away()) <= self.range_max
