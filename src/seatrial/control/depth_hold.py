"""Depth hold of an underwater vehicle by its vertical thruster."""

from __future__ import annotations

from typing import ClassVar

from ..model.component import Input, Output, Parameter, terminal
from .axis_hold import AxisHold


class DepthHold(AxisHold):
    """PID control of the depth, from a depth sensor: heave force, with the law of `AxisHold`.

    Depths m, positive down; ``heave`` N, positive down, along the vehicle's z axis: roll and
    pitch are taken to be small. The weight that buoyancy does not balance is found by the
    integral. [Paulino2015] has no control of depth; all of this is ours.

    Defaults: mass with added mass of the VideoRay Pro 4, and four fifths of its vertical thrust.
    """

    exercised: ClassVar = {"capacity": 1e12, "rate_limit": 1e9, "damping_per_speed": 0.7}

    mass = Parameter(10.45, "kg", "mass with added mass in heave", min=1e-9)
    capacity = Parameter(20.0, "N", "largest force", min=0.0, tunable=True)
    rate_limit = Parameter(0.3, "m/s", "largest rate of the target", min=1e-9, tunable=True)
    damping = Parameter(0.0, "N.s/m", "damping in heave at rest", min=0.0, tunable=True)
    damping_per_speed = Parameter(
        0.0, "N.s2/m2", "damping in heave per speed ahead", min=0.0, tunable=True
    )

    depth_wanted = Input("m", "depth to hold, positive down")
    depth = Input("m", "measured depth, positive down")
    depth_valid = Input("1", "whether the depth is one", type=bool, start=True, optional=True)

    heave = Output("N", "heave force asked of the thrusters, positive down")

    terminals: ClassVar = {
        "wanted": terminal("depth_wanted"),
        "sensors": terminal("depth", "depth_valid"),
        "demanded": terminal("surge"),
        "held": terminal("heave"),
    }

    def sample(self, t: float, k: int) -> None:
        """Command the heave force."""
        self.heave = self._limited(self._demanded())

    def _axis(self) -> tuple[float, float, float]:
        return self.mass, self.capacity, self.rate_limit

    def _is_valid(self) -> bool:
        valid: bool = self.depth_valid
        return valid

    def _places(self) -> tuple[float, float]:
        return self.depth_wanted, self.depth
