"""Roll or pitch hold of an underwater vehicle by its thrusters."""

from __future__ import annotations

from typing import ClassVar

from ..model.component import Input, Output, Parameter, terminal
from .axis_hold import AxisHold


class TiltHold(AxisHold):
    """PID control of roll or pitch, from an attitude sensor: a moment, with the law of `AxisHold`.

    Angles rad; ``moment`` N.m about the same axis. Near level roll and pitch rates are those of
    the angles; this is no control of a vehicle that stands on its nose. The moment of weight and
    buoyancy, and that of thrusters off the CG, is found by the integral. Not ``enabled``: moment
    and integral 0, and the target where the vehicle is.

    Defaults: pitch of a BlueROV2 Heavy.
    """

    exercised: ClassVar = {"capacity": 1e12, "rate_limit": 1e9, "damping_per_speed": 0.7}

    natural_frequency = Parameter(2.5, "rad/s", "w", min=1e-9, tunable=True)
    damping_ratio = Parameter(0.9, "1", "zeta", min=0.0, tunable=True)
    integral_pole = Parameter(0.5, "rad/s", "sigma", min=0.0, tunable=True)
    rate_filter = Parameter(0.05, "s", "time constant of the filtered rate", min=0.0, tunable=True)
    inertia = Parameter(0.365, "kg.m2", "inertia about the axis with added inertia", min=1e-9)
    capacity = Parameter(8.0, "N.m", "largest moment", min=0.0, tunable=True)
    rate_limit = Parameter(0.5, "rad/s", "largest rate of the target", min=1e-9, tunable=True)
    damping = Parameter(0.0, "N.m.s/rad", "damping at rest", min=0.0, tunable=True)
    damping_per_speed = Parameter(
        0.0, "N.m.s2/(rad.m)", "damping per speed ahead", min=0.0, tunable=True
    )

    enabled = Input("1", "whether to act", type=bool)
    angle_wanted = Input("rad", "roll or pitch to hold", optional=True)
    angle = Input("rad", "measured roll, starboard down, or pitch, bow up")

    moment = Output("N.m", "moment asked of the thrusters, about the same axis")

    terminals: ClassVar = {
        "wanted": terminal(heading_engaged="enabled"),
        "demanded": terminal("surge"),
    }

    def sample(self, t: float, k: int) -> None:
        """Command the moment."""
        self.moment = self._limited(self._demanded()) if self.enabled else 0.0

    def update(self, t: float, k: int) -> None:
        """Advance integral, filtered rate and target; forget them while not enabled."""
        super().update(t, k)
        if not self.enabled:
            self._integral, self._target = 0.0, None

    def _axis(self) -> tuple[float, float, float]:
        return self.inertia, self.capacity, self.rate_limit

    def _places(self) -> tuple[float, float]:
        return self.angle_wanted, self.angle
