"""Lumped thrusters of a ship: a force and a moment that follow demands."""

from __future__ import annotations

from typing import ClassVar

from seatrial.devices.actuators.lagged import LaggedActuator
from seatrial.model.component import Input, Output, Parameter, terminal


class ForceActuator(LaggedActuator):
    """Surge force, sway force and yaw moment, each with a limit and a first-order lag.

        T y' = clip(demand, capacity) - y,    clip(x, a) = x held between -a and a

    exact for a demand held over the step. With ``time_constant`` T = 0 it is ideal: the output
    is the limited demand at the same instant. X, Y in N and N in N.m in body axes (x bow,
    y starboard, z down), about the body origin; the moment is positive to starboard.

    Failures are those of `Actuator`, for all three axes together: a wrong one has half of its
    forces; a slow one has ten times its lag, and at least 1 s.

    Defaults are the ideal thrusters of [ShipScript], with what it calls 100 % as capacity.

    Not modelled: single thrusters and how a demand is allocated to them; the capacity of one
    axis does not depend on what the others use.
    """

    exercised: ClassVar = {"capacity": [2.0, 2.0, 2.0]}

    capacity = Parameter(
        (2.5e5, 2.5e5, 1e7), ("N", "N", "N.m"), "largest forces and moment", axes="XYN", min=0.0
    )

    demand = Input(("N", "N", "N.m"), "forces and moment asked for, body axes", axes="XYN")
    force = Output("N", "force on the ship, body axes", axes="xy", frame="b")
    moment = Output("N.m", "yaw moment on the ship, positive to starboard")

    terminals: ClassVar = {"wrench": terminal("force", "moment")}

    def start(self, t: float) -> None:
        """Start without force."""
        self.begin_lagged(3)

    def step(self, t: float, h: float) -> None:
        """Follow the demand as it is."""
        self.follow(t, h, self.demand, self.capacity)

    def outputs(self, t: float) -> None:
        """Publish force and moment."""
        x, y, self.moment = self.lagged(t, self.demand, self.capacity)
        self.force = x, y
