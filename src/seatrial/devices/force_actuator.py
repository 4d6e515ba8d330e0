"""Thrusters of a ship as seen from outside: one force and one moment that follow demands."""

from __future__ import annotations

import math
from typing import ClassVar

from ..component import Component, Input, Output, Parameter


class ForceActuator(Component):
    """Surge force, sway force and yaw moment, each with a limit and a first-order lag.

        T y' = clip(demand, capacity) - y,    clip(x, a) = x held between -a and a

    exact for a demand held over the step. With ``time_constant`` T = 0 it is ideal: the output
    is the limited demand at the same instant. X, Y in N and N in N.m in body axes (x bow,
    y starboard, z down), about the body origin; the moment is positive to starboard.

    Defaults are the ideal thrusters of source 003, with what it calls 100 % as capacity.

    Not modelled: single thrusters and how a demand is allocated to them; the capacity of one
    axis does not depend on what the others use.
    """

    time_constant = Parameter(0.0, "s", "lag of forces behind demands, 0 for none", min=0.0)
    capacity = Parameter(
        (2.5e5, 2.5e5, 1e7), ("N", "N", "N.m"), "largest forces and moment", axes="XYN", min=0.0
    )

    demand = Input(("N", "N", "N.m"), "forces and moment asked for, body axes", axes="XYN")
    force = Output("N", "force on the ship, body axes", axes="xy")
    moment = Output("N.m", "yaw moment on the ship, positive to starboard")

    feedthrough: ClassVar = {"force": ("demand",), "moment": ("demand",)}

    def start(self, t: float) -> None:
        """Start without force."""
        self._load = [0.0, 0.0, 0.0]

    def step(self, t: float, h: float) -> None:
        """Follow the demand as it is."""
        if self.time_constant > 0.0:
            kept = math.exp(-h / self.time_constant)
            self._load = [
                goal + (load - goal) * kept
                for goal, load in zip(self._limited(), self._load, strict=True)
            ]

    def outputs(self, t: float) -> None:
        """Publish force and moment."""
        x, y, self.moment = self._load if self.time_constant > 0.0 else self._limited()
        self.force = x, y

    def _limited(self) -> list[float]:
        pairs = zip(self.demand, self.capacity, strict=True)
        return [min(max(demand, -most), most) for demand, most in pairs]
