"""Force and moment of fixed thrusters on their craft."""

from __future__ import annotations

from typing import ClassVar

from ...model.component import Input, Output, terminal
from ...physics.thrusters import COUNT, FixedThrusters

_THRUSTS = tuple(f"t{number}" for number in range(1, COUNT + 1))


class Propulsion(FixedThrusters):
    """Sum of up to 16 fixed thrusters: force = sum d_i T_i, moment = sum r_i x d_i T_i.

    T_i is the thrust of thruster i, N, positive along its direction d_i, a unit vector in body
    axes (x bow, y starboard, z down); r_i is its position from the body origin, m. A direction
    of (0, 0, 0) is no thruster; the others are added by number. Static: outputs follow the
    thrusts at the same instant.

    Two thrusters ahead at y = -d and +d, z = z_T give N = (T_1 - T_2) d, so that the port one
    turns the bow to starboard, and M = +z_T (T_1 + T_2). ([Timm2026], eq. 57, has both with the
    opposite sign, which is not r x F in axes with z down.)

    Raises InputError at the start for a direction that is neither zero nor of length 1 within
    1e-6.
    """

    exercised: ClassVar = {"direction_1": [1, 0, 0], "position_1": [-0.45, -0.4, 0.15]}

    # Optional: most craft have fewer thrusters.
    thrust = Input("N", "thrust of each thruster along its direction", axes=_THRUSTS, optional=True)
    force = Output("N", "force on the craft, body axes", axes="xyz", frame="b")
    moment = Output(
        "N.m", "moment on the craft about the body origin, body axes", axes="xyz", frame="b"
    )

    terminals: ClassVar = {"wrench": terminal("force", "moment")}

    def start(self, t: float) -> None:
        """Work out each thruster's force and moment; raises InputError for a bad direction."""
        self._effects = self.effects()

    def outputs(self, t: float) -> None:
        """Sum the thrusters."""
        total = [0.0] * 6
        for thrust, effect in zip(self.thrust, self._effects, strict=True):
            if effect is not None:
                total = [load + part * thrust for load, part in zip(total, effect, strict=True)]
        self.force, self.moment = total[:3], total[3:]
