"""Base of control laws that hold a vessel on its nominal trajectory."""

from __future__ import annotations

from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal

from .nominal_trajectory import NominalTrajectory

_UVR = ("m/s", "m/s", "rad/s")


class VesselTracking(NominalTrajectory):
    """Base of laws that hold the velocities of a `SurfaceVessel` on a `NominalTrajectory`.

    A subclass returns from `demand` which commands it wants; ``command`` is that, each thruster's
    held to +-``command_limit``. ``shares`` are the deflections of a topside whose thrusters get
    surge + yaw and surge - yaw: (t1 + t2) / 2 and (t1 - t2) / 2.

    ``nu_bias`` is added to ``nu`` before the law sees it: an error of the sensors, set by a
    trial to see what it does. [Paulino2015], table 8.1, has its disturbances there and not in the
    forces.
    """

    command_limit = Parameter(1.0, "1", "largest command of each thruster", min=0.0)

    nu = Input(_UVR, "measured velocity ahead and to starboard and yaw rate", axes="uvr")
    nu_bias = Input(_UVR, "error of the sensors that a trial adds to nu", axes="uvr")

    command = Output("1", "share of each thruster's full thrust", axes=("t1", "t2"))

    shares = Output("1", "deflections of a topside that give it", axes=("surge", "yaw"))

    terminals: ClassVar = {"deflections": terminal(surge="shares__surge", yaw="shares__yaw")}

    def demand(self, k: int) -> tuple[float, float]:
        """Return the commands (t1, t2) wanted at instant ``k``, without limits."""
        raise TypeError(f"{type(self).__name__} does not define what it demands")

    def sample(self, t: float, k: int) -> None:
        """Command the thrusters."""
        super().sample(t, k)
        limit = self.command_limit
        first, second = (min(max(share, -limit), limit) for share in self.demand(k))
        self.command = [first, second]
        self.shares = [(first + second) / 2.0, (first - second) / 2.0]

    def _measured(self) -> tuple[float, float, float]:
        (u, v, r), (bias_u, bias_v, bias_r) = self.nu, self.nu_bias
        return u + bias_u, v + bias_v, r + bias_r

    def _saturated(self, k: int) -> bool:
        """Return whether a thruster is at its limit at instant ``k``."""
        return any(abs(share) > self.command_limit for share in self.demand(k))
