"""Control allocation of two fixed thrusters: force and moment to pulses."""

from __future__ import annotations

import math
from typing import ClassVar

from ...model.component import Input, terminal
from .twin_thrusters import TwinThrusters


class PulseAllocation(TwinThrusters):
    """Pulses of two fixed thrusters that give a surge force X and a yaw moment N, as they can.

    Allocation and thrust to pulse as in `TwinThrusters`. X N, positive ahead; N N.m, positive
    to starboard; pulses s. Static. Defaults: the Hydrone's two T200.

    Raises InputError at the start if the pulses do not rise.
    """

    surge = Input("N", "surge force wanted, positive ahead")
    yaw_moment = Input("N.m", "yaw moment wanted, positive to starboard")

    terminals: ClassVar = {
        **TwinThrusters.terminals,
        "demand": terminal("surge", "yaw_moment"),
    }

    def start(self, t: float) -> None:
        """Check the pulses; raises InputError if they do not rise."""
        self.check_pulses()

    def outputs(self, t: float) -> None:
        """Allocate."""
        self._drive(*self._possible(self.surge, self.yaw_moment, math.inf, math.inf))
