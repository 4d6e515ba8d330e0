"""Attitude and rates of a quadrotor held by the speeds of its rotors."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled
from seatrial.physics.craft.kinematics import cross, rotation

_ROTORS = ("r1", "r2", "r3", "r4")
_PLACES = ((1, 1), (-1, -1), (1, -1), (-1, 1))
_SPINS = (1, 1, -1, -1)
_EULER = ("phi", "theta", "psi")


class MultirotorAttitude(Sampled):
    """Rotor speeds for a thrust and an attitude, from attitude and rates of the drone.

    With R and R_w the rotations from body axes to {n} of the drone and of the attitude wanted,
    e the axis of R^T R_w times the sine of its angle, I the inertia and w the rates:

        M = I (w_n^2 e - 2 zeta w_n w) + w x I w                     N.m, body axes
        k_T O_i^2 = T / 4 - s_y L / (4 b) + s_x M / (4 a) + s_i N k_T / (4 k_Q)

    for hubs at (s_x a, s_y b), s_i the turn of rotor i, w_n ``bandwidth`` and zeta ``damping``; in
    yaw the bandwidth is ``yaw_bandwidth``. Where speeds are at a limit, yaw is given up first:
    N is cut to what the rotors have left. While ``motors`` is false all speeds are 0. Order of
    rotors, k_T, and k_Q as of `Multirotor`.
    """

    exercised: ClassVar = {
        "thrust": 90.0,
        "motors": True,
        "attitude": [0.1, -0.1, 0.2],
        "rates": [0.1, 0.2, -0.1],
    }

    period = Parameter(0.004, "s", "sample period", min=1e-6)
    inertia = Parameter((0.25, 0.25, 0.4), "kg.m2", "principal moments", axes="xyz", min=1e-6)
    density = Parameter(1.225, "kg/m3", "density of the air", min=1e-3)
    rotor_diameter = Parameter(0.40, "m", "diameter of a rotor", min=1e-3)
    hub = Parameter((0.25, 0.25, -0.05), "m", "hub front right; the others mirror it", axes="xyz")
    thrust_coefficient = Parameter(0.10, "1", "C_T = T / (rho n^2 D^4)", min=1e-6)
    power_coefficient = Parameter(0.045, "1", "C_P = P / (rho n^3 D^5)", min=1e-6)
    max_speed = Parameter(785.7987745754486, "rad/s", "highest speed of a rotor", min=0.0)
    bandwidth = Parameter(11.0, "rad/s", "w_n of roll and pitch", min=0.0)
    yaw_bandwidth = Parameter(3.0, "rad/s", "w_n of yaw", min=0.0)
    damping = Parameter(0.8, "1", "zeta", min=0.0)

    thrust = Input("N", "thrust wanted")
    attitude_wanted = Input("rad", "Euler angles wanted, ZYX", axes=_EULER)
    motors = Input("1", "whether the motors turn", type=bool)
    attitude = Input("rad", "Euler angles of the drone, ZYX", axes=_EULER)
    rates = Input("rad/s", "angular velocity, body axes", axes="pqr")

    command = Output("rad/s", "speed wanted of each rotor", axes=_ROTORS)

    terminals: ClassVar = {
        "motion": terminal("attitude", "rates"),
        "wanted": terminal("thrust", "attitude_wanted", "motors"),
    }

    def sample(self, t: float, k: int) -> None:
        """Set the speeds."""
        if not self.motors:
            self.command = [0.0] * 4
            return
        factor = self.density * self.rotor_diameter**4 / (4.0 * math.pi**2)
        k_thrust = self.thrust_coefficient * factor
        arm = self.power_coefficient * self.rotor_diameter / math.tau / self.thrust_coefficient
        a, b, _ = self.hub
        L, M, N = self._moments()
        level = max(self.thrust, 0.0) / 4.0
        held = [
            level - y * L / (4.0 * b) + x * M / (4.0 * a)  # thrusts without yaw, N
            for x, y in _PLACES
        ]
        most = k_thrust * self.max_speed**2
        left = min(min(f, most - f) for f in held)
        yaw = N / (4.0 * arm)
        yaw = max(-max(left, 0.0), min(yaw, max(left, 0.0)))
        self.command = [
            math.sqrt(min(max(f + s * yaw, 0.0), most) / k_thrust)
            for f, s in zip(held, _SPINS, strict=True)
        ]

    def _moments(self) -> tuple[float, float, float]:
        own, wanted = rotation(*self.attitude), rotation(*self.attitude_wanted)
        # D = R^T R_w; half of its skew part is the axis times the sine of the angle.
        d = [[sum(own[k][i] * wanted[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
        error = ((d[2][1] - d[1][2]) / 2, (d[0][2] - d[2][0]) / 2, (d[1][0] - d[0][1]) / 2)
        inertia, w = self.inertia, self.rates
        speeds = (self.bandwidth, self.bandwidth, self.yaw_bandwidth)
        spun = cross(w, [i * r for i, r in zip(inertia, w, strict=True)])
        L, M, N = (
            i * (n * n * e - 2.0 * self.damping * n * r) + s
            for i, n, e, r, s in zip(inertia, speeds, error, w, spun, strict=True)
        )
        return L, M, N
