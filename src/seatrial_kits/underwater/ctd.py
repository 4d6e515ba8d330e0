"""CTD: conductivity, temperature and depth of the water."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import ClassVar

import numpy as np

from seatrial.devices.sensor import Derived, Measured, Sensor, Value
from seatrial.errors import InputError
from seatrial.model.component import Input, Parameter, terminal
from seatrial.physics.craft.kinematics import to_ned

from .seawater import CELSIUS, conductivity, salinity, sound_speed

_LEVELS = tuple(f"d{number}" for number in range(1, 9))


class Ctd(Sensor):
    """Conductivity, temperature and pressure of the water at the sensor, and what follows.

    Temperature T and practical salinity S are given at up to eight depths (``profile_depth``,
    rising; the first ``profile_points`` of them), linear in between and constant outside. At the
    depth d of the sensor it measures, with the errors of `Sensor`,

        temperature = T(d),   pressure = density gravity d,   conductivity = C(S(d), T(d), pressure)

    with the salinity scale of 1978 solved for C. From what it measured, errors and all, it
    computes ``salinity`` (the same scale), ``depth`` = pressure / (density gravity) and
    ``speed_of_sound`` ([Mackenzie1981]). Pressure is that above the air's. Out of the water there
    is nothing to measure.

    Defaults: one level of 10 degrees Celsius and salinity 35. Errors, all assumed: a
    small instrument of an underwater vehicle, 0.3 mS/m, 2 mK, 200 Pa of noise; slow errors of
    1 mS/m, 5 mK, 1 kPa; 8 Hz.

    Not modelled: lag of the sensors, flow through the cell, density that changes with depth.
    """

    exercised: ClassVar = {
        "profile_points": 2.0,
        "profile_depth": [0.0, 4.0, *[0.0] * 6],
        "profile_temperature": [290.0, 280.0, *[0.0] * 6],
        "profile_salinity": [35.0, 30.0, *[0.0] * 6],
        "place": [0.2, 0.1, 0.3],
    }

    period = Parameter(0.125, "s", "sample period", min=1e-6)
    place = Parameter(0.0, "m", "sensor from the body origin, body axes", axes="xyz")
    density = Parameter(1025.0, "kg/m3", "density of the water", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=1e-6)
    structural: ClassVar = ("profile_points",)

    profile_points = Parameter(1.0, "1", "depths of the profile in use", min=1.0, max=len(_LEVELS))
    profile_depth = Parameter(0.0, "m", "depths of the profile, rising", axes=_LEVELS)
    profile_temperature = Parameter(
        CELSIUS + 10.0, "K", "temperature at these depths", axes=_LEVELS
    )
    profile_salinity = Parameter(
        35.0, "1", "practical salinity at these depths", axes=_LEVELS, min=0.0, max=42.0
    )

    position = Input("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))

    conductivity = Measured(
        "S/m", "conductivity", span=(0.0, 7.0), noise=3e-4, instability=1e-3, resolution=1e-4
    )
    temperature = Measured(
        "K", "temperature", span=(CELSIUS - 2.0, CELSIUS + 35.0), noise=0.002, instability=0.005
    )
    pressure = Measured(
        "Pa", "pressure above that of the air", span=(0.0, 1e7), noise=200.0, instability=1e3
    )
    salinity = Derived("1", "practical salinity")
    depth = Derived("m", "depth of the sensor, positive down")
    speed_of_sound = Derived("m/s", "speed of sound")

    terminals: ClassVar = {
        "motion": terminal("position", "attitude"),
        "reading": terminal(
            "depth",
            depth_valid="valid",
            water_temperature="temperature",
            water_temperature_valid="valid",
        ),
    }

    def reset(self, t: float) -> None:
        """Raise InputError for a profile that cannot be."""
        points = self.profile_points
        if points % 1.0:
            raise InputError(f"{self.name}.profile_points is {points!r}, a whole number is needed")
        depths = self.profile_depth[: int(points)]
        if any(b <= a for a, b in pairwise(depths)):
            raise InputError(f"{self.name}.profile_depth is {depths} m: depths must rise")
        super().reset(t)

    def measure(self) -> Sequence[Value]:
        """Return conductivity, temperature and pressure at the sensor."""
        depth = self.position[2] + to_ned(self.attitude, self.place)[2]
        if depth < 0.0:
            return [None] * 3
        temperature, salt = (self._at(depth, "temperature"), self._at(depth, "salinity"))
        pressure = self.density * self.gravity * depth
        return [conductivity(salt, temperature, pressure), temperature, pressure]

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return salinity, depth and speed of sound from what was measured."""
        measured, temperature, pressure = (value or 0.0 for value in values)
        salt = salinity(measured, temperature, pressure)
        depth = pressure / (self.density * self.gravity)
        return [salt, depth, sound_speed(temperature, salt, depth)]

    def _at(self, depth: float, quantity: str) -> float:
        points = int(self.profile_points)
        values = getattr(self, f"profile_{quantity}")[:points]
        return float(np.interp(depth, self.profile_depth[:points], values))
