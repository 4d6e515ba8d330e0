"""Dynamic positioning: a ship held in place and heading by forces in all three directions."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled

from .wave_filter import WaveFiltered, unwrapped

_UNITS = ("N", "N", "N.m")
_Three = list[float]


class DynamicPositioning(WaveFiltered, Sampled):
    """PID control of position and heading with surge force, sway force and yaw moment.

    With e the error of position, station - position, turned into body axes, and of heading,
    wrapped to +-pi, and nu = (u, v, r), each axis by itself:

        tau = clip(Kp e) - Kd nu + I,    I' = Ki e where Kp e is not clipped, else 0

    with clip(x) = x held within +-``capacity``, as tau itself is; back-calculation at the rate
    Ki / Kp removes from I what that cuts off. On a long way to a new station the ship thus goes
    at no more than capacity / Kd, from which its thrusters can stop it. I of surge and sway is
    kept in north and east, so that the integral of wind and current stays valid when the
    ship turns.

    **Gains.** An axis of mass m has, with these gains and forces without lag, the poles of
    (s + sigma) (s^2 + 2 zeta w s + w^2), w = ``natural_frequency``, zeta = ``damping_ratio``,
    sigma = ``integral_pole`` (0 for no integral action):

        Kd = m (2 zeta w + sigma),   Kp = m (w^2 + 2 zeta w sigma),   Ki = m w^2 sigma

    A load F that comes suddenly pushes the ship away by less than F / Kp.

    **Thrusters with a lag.** If ``thruster_time_constant`` T is more than
    ``thruster_response`` T_r, the demand is f + (T / T_r) (tau - f), held to ``capacity``, with
    f the force that thrusters of first order have by then, computed from the demands: they
    then answer with T_r, as far as their capacity goes. A lag left over costs damping: with
    zeta = 1 and w T_r = 0.35 the least damping ratio is 0.5.

    With ``wave_frequency`` the measured position, heading, velocity and rate go through a notch
    (`WaveFiltered`), so that thrusters do not answer what waves do.

    A ship without the truth about its motion has it from its sensors (`SensedMotion`).

    Inputs: position and station in {n} (x north, y east), m; headings rad clockwise from
    north, any number of turns; velocity in body axes as a Doppler log or an observer gives it,
    m/s; rates rad/s. ``demand`` in body axes, N and N.m about the body origin, the moment
    positive to starboard.

    Defaults: masses with added mass of the ship of [ShipScript], and what it calls 100 % as
    capacity. Coupling of sway and yaw and Coriolis forces are left out.
    """

    exercised: ClassVar = {"capacity": [1e12, 1e12, 1e12], "thruster_time_constant": 5.0}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    mass = Parameter(
        (7.88e6, 1.364e7, 4.31e9),
        ("kg", "kg", "kg.m2"),
        "mass and inertia with added mass",
        axes="uvr",
        min=1e-9,
    )
    natural_frequency = Parameter((0.2, 0.2, 0.35), "rad/s", "w", axes="uvr", min=1e-9)
    damping_ratio = Parameter(1.0, "1", "zeta", axes="uvr", min=0.0)
    integral_pole = Parameter((0.02, 0.02, 0.035), "rad/s", "sigma", axes="uvr", min=0.0)
    capacity = Parameter(
        (2.5e5, 2.5e5, 1e7), _UNITS, "largest forces and moment", axes="XYN", min=0.0
    )
    thruster_time_constant = Parameter(0.0, "s", "T, lag of the thrusters, 0 for none", min=0.0)
    thruster_response = Parameter(1.0, "s", "T_r, lag that is wanted instead", min=1e-3)

    station = Input("m", "position to hold", axes=("north", "east"))
    station_heading = Input("rad", "heading to hold, clockwise from north")
    position = Input("m", "position, north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    velocity = Input("m/s", "velocity over ground, body axes", axes=("u", "v", "w"))
    rates = Input("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))

    demand = Output(_UNITS, "forces and moment asked of the thrusters, body axes", axes="XYN")

    terminals: ClassVar = {
        "truth": terminal("position", "attitude", "velocity", "rates"),
        "held": terminal(surge="demand__X", sway="demand__Y", yaw_moment="demand__N"),
    }

    def reset(self, t: float) -> None:
        """Start with no integral and thrusters at rest."""
        axes = zip(
            self.mass, self.natural_frequency, self.damping_ratio, self.integral_pole, strict=True
        )
        self._gains = [_gains(*axis) for axis in axes]
        self._learnt_ned = [0.0, 0.0, 0.0]
        self._force = [0.0, 0.0, 0.0]
        self.prepare_filter()
        # The heading counts turns from the one at the start.
        self._motion = [self.settled(value) for value in self._measured(self.attitude[2])]

    def sample(self, t: float, k: int) -> None:
        """Command the thrusters."""
        self.demand = self._demanded(self._limited(self._wanted()))

    def update(self, t: float, k: int) -> None:
        """Advance the integral and the thrusters' model."""
        wanted = self._wanted()
        given = self._limited(wanted)
        stiff, clipped = self._stiffness()
        grown = [
            self.period * (ki / kp) * ((push if push == held else 0.0) + tau - asked)
            for (kp, _kd, ki), push, held, tau, asked in zip(
                self._gains, stiff, clipped, given, wanted, strict=True
            )
        ]
        to_ned = _turned(grown, self.attitude[2])
        self._learnt_ned = [a + b for a, b in zip(self._learnt_ned, to_ned, strict=True)]
        if self.thruster_time_constant > 0.0:
            kept = math.exp(-self.period / self.thruster_time_constant)
            demands = zip(self._demanded(given), self._force, strict=True)
            self._force = [demand + (force - demand) * kept for demand, force in demands]
        if self.wave_frequency > 0.0:
            measured = self._measured(self._motion[2][2])
            self._motion = [
                self.advanced(state, value)
                for state, value in zip(self._motion, measured, strict=True)
            ]

    def _measured(self, near: float) -> list[float]:
        """Return position and heading, with turns counted to ``near``, and their velocities."""
        (x, y, _z), psi, (u, v, _w) = self.position, self.attitude[2], self.velocity
        return [x, y, unwrapped(psi, near), u, v, self.rates[2]]

    def _seen(self) -> list[float]:
        """Return the same without what waves do."""
        if not self.wave_frequency > 0.0:
            (x, y, _z), psi, (u, v, _w) = self.position, self.attitude[2], self.velocity
            return [x, y, psi, u, v, self.rates[2]]
        measured = self._measured(self._motion[2][2])
        return [
            self.filtered(state, value) for state, value in zip(self._motion, measured, strict=True)
        ]

    def _error(self) -> _Three:
        """Return the error in body axes: m, m, rad."""
        (north, east), (x, y, psi) = self.station, self._seen()[:3]
        heading_error = math.remainder(self.station_heading - psi, math.tau)
        return _turned([north - x, east - y, heading_error], -psi)

    def _stiffness(self) -> tuple[_Three, _Three]:
        """Return Kp e, and the same held to the capacity."""
        axes = zip(self._gains, self._error(), strict=True)
        stiff = [kp * error for (kp, _kd, _ki), error in axes]
        return stiff, self._limited(stiff)

    def _wanted(self) -> _Three:
        """Return tau before it is held to the capacity."""
        speeds = self._seen()[3:]
        learnt = _turned(self._learnt_ned, -self.attitude[2])
        axes = zip(self._gains, self._stiffness()[1], speeds, learnt, strict=True)
        return [push - kd * speed + i for (_kp, kd, _ki), push, speed, i in axes]

    def _limited(self, load: _Three) -> _Three:
        return [min(max(x, -most), most) for x, most in zip(load, self.capacity, strict=True)]

    def _demanded(self, tau: _Three) -> _Three:
        """Return the demand that makes thrusters with a lag give tau sooner."""
        quicker = self.thruster_time_constant / self.thruster_response
        if quicker <= 1.0:
            return tau
        pairs = zip(tau, self._force, strict=True)
        return self._limited([force + quicker * (goal - force) for goal, force in pairs])


def _gains(mass: float, w: float, zeta: float, sigma: float) -> tuple[float, float, float]:
    """Return (Kp, Kd, Ki) that place the poles of an axis."""
    return (
        mass * (w * w + 2.0 * zeta * w * sigma),
        mass * (2.0 * zeta * w + sigma),
        mass * w * w * sigma,
    )


def _turned(three: _Three, psi: float) -> _Three:
    """Return a horizontal vector turned by psi about z; the third element stays."""
    x, y, about_z = three
    c, s = math.cos(psi), math.sin(psi)
    return [c * x - s * y, s * x + c * y, about_z]
