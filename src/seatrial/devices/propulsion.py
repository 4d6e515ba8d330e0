"""Force and moment of fixed thrusters on their craft."""

from __future__ import annotations

import math
from typing import ClassVar

from ..component import Component, Input, Output, Parameter
from ..craft.kinematics import cross
from ..errors import InputError

_NUMBERS = (1, 2, 3, 4)


class Propulsion(Component):
    """Sum of up to four fixed thrusters: force = sum d_i T_i, moment = sum r_i x d_i T_i.

    T_i is the thrust of thruster i, N, positive along its direction d_i, a unit vector in body
    axes (x bow, y starboard, z down); r_i is its position from the body origin, m. A direction
    of (0, 0, 0) is no thruster. Static: outputs follow the thrusts at the same instant.

    Two thrusters ahead at y = -d and +d, z = z_T give N = (T_1 - T_2) d, so that the port one
    turns the bow to starboard, and M = +z_T (T_1 + T_2). (Source 004, eq. 57, has both with the
    opposite sign, which is not r x F in axes with z down.)

    Raises InputError at the start for a direction that is neither zero nor of length 1 within
    1e-6.
    """

    exercised: ClassVar = {"direction_1": [1, 0, 0], "position_1": [-0.45, -0.4, 0.15]}

    position_1 = Parameter(0.0, "m", "position of thruster 1 from the body origin", axes="xyz")
    position_2 = Parameter(0.0, "m", "position of thruster 2 from the body origin", axes="xyz")
    position_3 = Parameter(0.0, "m", "position of thruster 3 from the body origin", axes="xyz")
    position_4 = Parameter(0.0, "m", "position of thruster 4 from the body origin", axes="xyz")
    direction_1 = Parameter(0.0, "1", "direction of thruster 1's positive thrust", axes="xyz")
    direction_2 = Parameter(0.0, "1", "direction of thruster 2's positive thrust", axes="xyz")
    direction_3 = Parameter(0.0, "1", "direction of thruster 3's positive thrust", axes="xyz")
    direction_4 = Parameter(0.0, "1", "direction of thruster 4's positive thrust", axes="xyz")

    thrust = Input(
        "N", "thrust of each thruster along its direction", axes=("t1", "t2", "t3", "t4")
    )
    force = Output("N", "force on the craft, body axes", axes="xyz")
    moment = Output("N.m", "moment on the craft about the body origin, body axes", axes="xyz")

    feedthrough: ClassVar = {"force": ("thrust",), "moment": ("thrust",)}

    def start(self, t: float) -> None:
        """Work out each thruster's force and moment; raises InputError for a bad direction."""
        self._effects = [self._effect(number) for number in _NUMBERS]

    def outputs(self, t: float) -> None:
        """Sum the thrusters."""
        total = [0.0] * 6
        for thrust, effect in zip(self.thrust, self._effects, strict=True):
            for i, part in enumerate(effect):
                total[i] += part * thrust
        self.force, self.moment = total[:3], total[3:]

    def _effect(self, number: int) -> list[float]:
        """Return force and moment per newton of a thruster's thrust: (d, r x d)."""
        position = getattr(self, f"position_{number}")
        direction = getattr(self, f"direction_{number}")
        length = math.hypot(*direction)
        if length != 0.0 and abs(length - 1.0) > 1e-6:
            raise InputError(
                f"{self.name}.direction_{number} is {direction}, of length {length:.6g}: give a "
                "unit vector, or (0, 0, 0) for no thruster"
            )
        return [*direction, *cross(position, direction)]
