"""Sensors of the profile: periods, places, covariances by their own noise."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from seatrial.devices.sensor import share_of_sample
from seatrial.links.vehicle_sensors import Sensors, axis, first_of, three

from .frames import TO_ENU, TO_FLU, turned

_PLACES = ("place", "antenna")
_LONGEST_S = 0.1
"""Period of what no sensor of the profile measures, s."""

SENSORS: Mapping[str, tuple[str, ...]] = {
    "imu": ("imu",),
    "compass": ("compass", "ahrs"),
    "fix": ("gnss",),
    "velocity": ("gnss",),
    "pressure": ("depth", "ctd"),
    "dvl": ("dvl",),
    "dvl_report": ("dvl",),
    "water_speed": ("speed-log",),
    "water_depth": ("echo-sounder", "dvl"),
    "wind": ("anemometer",),
    "wind_vector": ("anemometer",),
    "sonar": ("scanning-sonar",),
    "leak": ("leak-detector",),
    "temperature": ("ctd",),
}
"""Kinds of sensors that a topic may be of, by its key."""


class Instruments:
    """The vehicle's sensors, as its profile has them."""

    def __init__(self, sensors: Sensors) -> None:
        self._of = {
            key: next(filter(None, (first_of(sensors, kind)[1] for kind in kinds)), {})
            for key, kinds in SENSORS.items()
        }

        self._covariances: dict[tuple[str, str], list[float]] = {}

    def period_ns(self, key: str) -> int:
        """Return the sample period of a topic's sensor, ns."""
        return round(1e9 * axis(self._of.get(key, {}).get("period", _LONGEST_S)))

    def place(self, key: str) -> list[float]:
        """Return where the sensor is, from the body origin in {b}, m."""
        sensor = self._of.get(key, {})
        return next((three(sensor[name]) for name in _PLACES if name in sensor), [0.0] * 3)

    def covariance(self, key: str, quantity: str, *, world: bool = False) -> list[float]:
        """Return a covariance, row by row, in the axes of ROS; zeros where nothing is known.

        diag(noise^2 + instability^2) of the sensor's own axes, the noise of a sample, turned to
        ahead-left-up, or to east-north-up for a sensor whose axes are those of the ``world``.
        """
        known = key, quantity
        if known not in self._covariances:
            own = np.diag([v * v for v in self.deviations(key, quantity)])
            found = turned(own, TO_ENU if world else TO_FLU).ravel()
            self._covariances[known] = [float(v) for v in found]
        return self._covariances[known]

    def dvl_covariance(self) -> list[float]:
        """Return that of a DVL's velocity, in its own axes or ahead-left-up; zeros if unknown.

        One beam's noise s makes s / (sqrt(2) sin a) ahead and abeam, s / (2 cos a) down, with
        the angle a of the beams (`seatrial_kits.underwater.dvl.Dvl`).
        """
        (beam,) = self.deviations("dvl", "bottom", 1)
        angle = axis(self._of["dvl"].get("beam_angle", math.radians(22.5)))
        level, down = beam / (math.sqrt(2.0) * math.sin(angle)), beam / (2.0 * math.cos(angle))
        return [level**2, 0.0, 0.0, 0.0, level**2, 0.0, 0.0, 0.0, down**2]

    def deviations(self, key: str, quantity: str, count: int = 3) -> list[float]:
        """Return the standard deviations of a quantity: noise and slow error together."""
        sensor = self._of.get(key, {})
        noise, slow = (sensor.get(f"{quantity}_{kind}", 0.0) for kind in ("noise", "instability"))
        bandwidth = axis(sensor.get(f"{quantity}_bandwidth", 0.0))
        share = share_of_sample(self.period_ns(key) * 1e-9, bandwidth)
        return [math.hypot(share * axis(noise, i), axis(slow, i)) for i in range(count)]
