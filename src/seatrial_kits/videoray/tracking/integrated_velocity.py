"""Velocities from an accelerometer and a compass by integration and difference."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled
from seatrial.physics.craft.kinematics import to_body


class IntegratedVelocity(Sampled):
    """Estimate u, v and r as [Paulino2015], section 6.2, has it: integrate, and take differences.

    At each sample, with the specific force f, the attitude and the offset b that is taken off,

        a   = f - b + R^T (0, 0, gravity)          inertial acceleration, body axes
        r_k = (psi_k - psi_(k-1)) / period         by the shorter way across north
        v_k = Rz(r_k period)^T v_(k-1) + period a

    ``nu`` is the mean of the samples of the last ``average``, which the source
    asks for because commands change more slowly than sensors are read. It does not mention
    gravity, without which a tilt of 0.1 degrees is an acceleration of 1.7 cm/s2, nor the turning
    of the axes, Rz; both are in here. Velocities are zero at the start.

    Nothing bounds what noise and offsets add up to: white noise s of the acceleration makes
    s sqrt(period t) m/s after t, an offset b makes b t. `VelocityFilter` is bounded.

    While the readings are not valid the velocities stay as they are and r is 0.
    """

    exercised: ClassVar = {"average": 0.3}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    offset = Parameter((0.0, 0.0, 0.0), "m/s2", "offset of the accelerometer", axes="xyz")
    average = Parameter(1.0, "s", "time over which samples are averaged", min=1e-6)

    accelerometer = Input("m/s2", "specific force, body axes", axes="xyz", frame="b")
    euler = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    imu_valid = Input("1", "whether the readings are valid", type=bool, start=True, optional=True)

    nu = Output(("m/s", "m/s", "rad/s"), "velocity ahead and to starboard and yaw rate", axes="uvr")

    terminals: ClassVar = {
        "sensors": terminal("accelerometer", "euler", "imu_valid"),
    }

    def reset(self, t: float) -> None:
        """Start at rest, with nothing read."""
        self._velocity = [0.0, 0.0, 0.0]
        self._heading = math.nan
        self._recent: list[list[float]] = []

    def sample(self, t: float, k: int) -> None:
        """Publish the mean of the last samples."""
        samples = self._samples(self._advanced())
        self.nu = [math.fsum(column) / len(samples) for column in zip(*samples, strict=True)]

    def update(self, t: float, k: int) -> None:
        """Remember this sample."""
        velocity, r = self._advanced()
        self._recent = self._samples((velocity, r))
        self._velocity = velocity
        self._heading = self.euler[2] if self.imu_valid else math.nan

    def _advanced(self) -> tuple[list[float], float]:
        """Return the velocity, m/s, and yaw rate, rad/s, of this sample."""
        if not self.imu_valid:
            return list(self._velocity), 0.0
        first = math.isnan(self._heading)
        turned = 0.0 if first else math.remainder(self.euler[2] - self._heading, math.tau)
        r = turned / self.period
        before = to_body((0.0, 0.0, turned), self._velocity)
        gravity = to_body(self.euler, (0.0, 0.0, self.gravity))
        terms = zip(before, self.accelerometer, self.offset, gravity, strict=True)
        return [v + self.period * (f - b + g) for v, f, b, g in terms], r

    def _samples(self, advanced: tuple[list[float], float]) -> list[list[float]]:
        (u, v, _w), r = advanced
        return [*self._recent, [u, v, r]][-max(1, round(self.average / self.period)) :]
