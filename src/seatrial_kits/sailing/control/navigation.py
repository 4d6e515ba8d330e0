"""Velocity and true wind of a sailing boat, from its sensors."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled

_NED = ("north", "east", "down")


class SailingNavigation(Sampled):
    """Velocity in body axes and true wind, from GNSS, compass, IMU and anemometer.

        u = c V_north + s V_east,  v = (-s V_north + c V_east) / cos(heel)
        wind = V + (c a - s b / cos(heel), s a + c b / cos(heel)),   (a, b) = V_aw (cos, sin) angle

    with c, s of the heading, V the velocity over ground (``velocity_n``), V_aw and angle the
    apparent wind and where it blows to from the bow; [Silva2018], eqs 2.3 and 2.5, which have
    no heave: velocity and wind are taken to lie in the horizontal plane. The true wind passes a
    first-order lag of ``time_constant``, from its first value on; without a valid velocity it
    stays as it is, 0 at first. (p, r) are the gyro's.

    ``nu`` is velocity over ground: in a current the water's is another. Not modelled: an
    estimate between two fixes, lever arms of antenna and anemometer, which the rates of a
    rolling boat make into wind that is not there: the lag is for that.
    """

    period = Parameter(0.02, "s", "sample period", min=1e-6)
    time_constant = Parameter(4.0, "s", "lag of the true wind", min=1e-6)

    velocity_n = Input("m/s", "velocity over ground, north-east-down", axes=_NED)
    velocity_valid = Input("1", "whether the velocity is valid", type=bool, start=True)
    heading = Input("rad", "heading, clockwise from north")
    heel = Input("rad", "heel, starboard down")
    gyro = Input("rad/s", "angular velocity, body axes", axes="xyz", frame="b")
    apparent_wind = Input(
        ("m/s", "rad"),
        "apparent wind, and where it blows to from the bow, to starboard positive",
        axes=("speed", "angle"),
    )

    nu = Output(
        ("m/s", "m/s", "rad/s", "rad/s"),
        "velocity over ground and rates, body axes",
        axes=("u", "v", "p", "r"),
    )
    wind = Output("m/s", "true wind over ground: where it blows to, {n}", axes=("north", "east"))

    terminals: ClassVar = {
        "sensors": terminal(
            "velocity_n",
            "heading",
            "heel",
            "gyro",
            position_valid="velocity_valid",
            wind_speed="apparent_wind__speed",
            wind_angle="apparent_wind__angle",
        ),
        "estimate": terminal("nu", "wind"),
    }

    def reset(self, t: float) -> None:
        """Start without a wind."""
        self._wind: list[float] = []
        self._share = -math.expm1(-self.period / self.time_constant)

    def sample(self, t: float, k: int) -> None:
        """Publish motion and wind."""
        north, east, _ = self.velocity_n
        c, s = math.cos(self.heading), math.sin(self.heading)
        across = (c * east - s * north) / math.cos(self.heel)
        self.nu = c * north + s * east, across, self.gyro[0], self.gyro[2]
        self.wind = self._lagged() or (0.0, 0.0)

    def update(self, t: float, k: int) -> None:
        """Remember the wind."""
        self._wind = self._lagged()

    def _lagged(self) -> list[float]:
        if not self.velocity_valid:
            return list(self._wind)
        now = self._measured()
        if not self._wind:
            return now
        return [old + self._share * (new - old) for old, new in zip(self._wind, now, strict=True)]

    def _measured(self) -> list[float]:
        """Return the true wind of this instant, north and east, m/s."""
        north, east, _ = self.velocity_n
        c, s = math.cos(self.heading), math.sin(self.heading)
        speed, angle = self.apparent_wind
        ahead, across = speed * math.cos(angle), speed * math.sin(angle) / math.cos(self.heel)
        return [north + c * ahead - s * across, east + s * ahead + c * across]
