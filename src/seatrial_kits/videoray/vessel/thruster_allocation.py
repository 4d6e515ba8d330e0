"""Control allocation of two horizontal thrusters and a vertical one."""

from __future__ import annotations

from typing import ClassVar

from seatrial.model.component import Component, Input, Output, Parameter, terminal


class ThrusterAllocation(Component):
    """Commands from -1 to 1 that give a surge force X, a yaw moment N and a heave force Z.

        port = (X / 2 + N / (2 d)) / E,   starboard = (X / 2 - N / (2 d)) / E,   vertical = Z / E_v

    with thrust linear in the command ([Paulino2015], eq. 5.18, with a lever arm); d =
    ``lever_arm``, E = ``horizontal_thrust``, E_v = ``vertical_thrust``. Where both do not fit the
    moment comes first and the force gets what is left: a vehicle that cannot turn goes astray.
    X ahead and Z down positive, N; N to starboard positive, N.m; body axes. Static.

    Defaults: the VideoRay Pro 4, half of its 93.4 N (5.8) for each horizontal thruster.
    """

    horizontal_thrust = Parameter(46.7, "N", "thrust of a horizontal thruster", min=1e-9)
    lever_arm = Parameter(0.1, "m", "horizontal thrusters from the centre line", min=1e-9)
    vertical_thrust = Parameter(25.0, "N", "thrust of the vertical thruster", min=1e-9)

    surge = Input("N", "surge force wanted, positive ahead")
    yaw_moment = Input("N.m", "yaw moment wanted, positive to starboard")
    heave = Input("N", "heave force wanted, positive down")

    port = Output("1", "command of the port thruster, -1 to 1, positive ahead")
    starboard = Output("1", "command of the starboard thruster, -1 to 1, positive ahead")
    vertical = Output("1", "command of the vertical thruster, -1 to 1, positive down")

    terminals: ClassVar = {
        "demand": terminal("surge", "yaw_moment", "heave"),
        "actuators": terminal("port", "starboard", "vertical"),
    }

    def outputs(self, t: float) -> None:
        """Allocate."""
        most = self.horizontal_thrust
        turning = _held(self.yaw_moment / (2.0 * self.lever_arm * most), 1.0)
        ahead = _held(self.surge / (2.0 * most), 1.0 - abs(turning))
        self.port, self.starboard = ahead + turning, ahead - turning
        self.vertical = _held(self.heave / self.vertical_thrust, 1.0)


def _held(x: float, most: float) -> float:
    return min(max(x, -most), most)
