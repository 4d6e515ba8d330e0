"""Base of the sensors that look at bottom and obstacles by sound."""

from __future__ import annotations

from collections.abc import Sequence

from seatrial.devices.sensor import Sensor
from seatrial.model.component import Input, Parameter
from seatrial.physics.craft.kinematics import Vector3, to_ned

from .seabed.parameters import OverSeabed


class Sounding(OverSeabed, Sensor):
    """Base of the sensors with a transducer at ``place``, over a seabed by parameters.

    An instrument takes time for distance with the speed of sound that it is set to: it shows
    distances and velocities times ``assumed_sound_speed / sound_speed``. Out of the water there
    is nothing to measure.
    """

    place = Parameter(0.0, "m", "transducer from the body origin, body axes", axes="xyz")
    sound_speed = Parameter(1500.0, "m/s", "speed of sound in the water", min=1.0)
    assumed_sound_speed = Parameter(1500.0, "m/s", "speed that the instrument is set to", min=1.0)

    position = Input("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))

    @property
    def shown(self) -> float:
        """What the instrument shows of a distance or a velocity, as a share of it."""
        return float(self.assumed_sound_speed / self.sound_speed)

    def transducer(self) -> Vector3:
        """Return where the transducer is, {n}, m."""
        arm = to_ned(self.attitude, self.place)
        x, y, z = (p + a for p, a in zip(self.position, arm, strict=True))
        return (x, y, z)

    def turned(self, direction: Sequence[float]) -> Vector3:
        """Return a direction of body axes in {n}."""
        return to_ned(self.attitude, direction)
