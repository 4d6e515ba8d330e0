"""Load of a multirotor (HUAUV) that lands on a craft's deck, or takes off from it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from ...errors import InputError
from ...model.component import Component, Input, Output, Parameter, terminal
from ..craft.kinematics import Vector3, cross, to_body


class Downwash(Component):
    """Load of a hybrid aerial and underwater vehicle (HUAUV): rotor wake, then weight on deck.

    The load's magnitude Fz(t) (N, downwards) is a function of time alone. With mass m,
    gravity g, height of the rotors z_h, upward acceleration a_z:

    - thrust T_h = m (g + a_z), ground effect C_GE = 1 + k0 exp(-ground_effect_decay z_h / D_r)
      ([Timm2026], eqs 59 and 61; D_r = ``rotor_diameter``);
    - the share of the wake that meets the deck, kappa = exp(-(z_h / wake_length)^2). It is an
      addition to the source, whose C_GE tends to 1 and would leave the load for ever.

    ``phase`` = "landing": z_h = z0 (1 - 10 s^3 + 15 s^4 - 6 s^5) with s = t / contact_time,
    z0 = ``initial_height``; before contact Fz = kappa C_GE T_h, from contact on Fz = m g.

    ``phase`` = "takeoff": on deck Fz = m g; from ``spool_up_start`` on the thrust grows
    linearly within ``spool_up_time`` (0: at once) from 0 to m g, and Fz = m g + C_GE T_h;
    from ``lift_off_time`` on z_h = climb_acceleration (t - lift_off_time)^2 / 2 and
    Fz = kappa C_GE T_h.

    ``load_model`` = "source" is that ([Timm2026], section 3.1.6). "consistent" counts no force
    twice: while the thrust grows the landing gear gives back what the wake adds, so Fz = m g
    until lift-off, and no wake presses with more than its thrust (C_GE = 1).

    ``direction`` = "body-z" is the source's: force (0, 0, Fz) and moment (y_p Fz, -x_p Fz, 0),
    turning with the craft (eq. 64). "vertical": force Fz n, moment pad x Fz n, with n the
    vertical in body axes, which is right for a weight.

    Times are compared as snapped: at the instant of contact, spool-up or lift-off the load is
    the one after it.
    """

    phase = Parameter("landing", "1", "manoeuvre of the HUAUV", choices=("landing", "takeoff"))
    load_model = Parameter("source", "1", "load on the deck", choices=("source", "consistent"))
    direction = Parameter("body-z", "1", "direction of the load", choices=("body-z", "vertical"))
    mass = Parameter(10.0, "kg", "mass of the HUAUV", min=0.0)
    pad = Parameter((0.0, 0.0, -0.2), "m", "landing point from the body origin", axes="xyz")
    k0 = Parameter(0.6, "1", "gain of the ground effect at the deck", min=0.0)
    ground_effect_decay = Parameter(4.0, "1", "decay of the ground effect per diameter", min=0.0)
    rotor_diameter = Parameter(0.40, "m", "diameter of a rotor", min=1e-3)
    wake_length = Parameter(1.0, "m", "height at which 1/e of the wake meets the deck", min=1e-3)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    contact_time = Parameter(4.0, "s", "landing: time of contact", min=1e-3)
    initial_height = Parameter(2.0, "m", "landing: height at t = 0", min=0.0)
    spool_up_start = Parameter(10.0, "s", "take-off: time at which the rotors spool up")
    spool_up_time = Parameter(0.0, "s", "take-off: duration of the spool-up", min=0.0)
    lift_off_time = Parameter(10.5, "s", "take-off: time of lift-off")
    climb_acceleration = Parameter(1.0, "m/s2", "take-off: acceleration upwards", min=0.0)

    attitude = Input("rad", "Euler angles of the deck", axes=("phi", "theta", "psi"))
    force = Output("N", "force on the craft, body axes", axes="xyz", frame="b")
    moment = Output("N.m", "moment on the craft about its origin, body axes", axes="xyz", frame="b")
    load = Output("N", "magnitude of the load, downwards")
    height = Output("m", "height of the rotors above the deck")
    on_deck = Output("1", "the HUAUV stands on the deck", type=bool)

    exercised: ClassVar = {"direction": "vertical", "contact_time": 1e-3}
    views: ClassVar = {"landing-point": {"place": "pad", "phase": "phase"}}
    terminals: ClassVar = {"motion": terminal("attitude"), "wrench": terminal("force", "moment")}

    def start(self, t: float) -> None:
        """Check the times; raises InputError if the source's lift-off precedes its spool-up."""
        takes_off = self.phase == "takeoff" and self.load_model == "source"
        if takes_off and self.lift_off_time < self.spool_up_start:
            raise InputError(
                f"{self.name}: lift_off_time {self.lift_off_time!r} s comes before "
                f"spool_up_start {self.spool_up_start!r} s"
            )

    def outputs(self, t: float) -> None:
        """Publish the load at ``t`` on a deck with the present attitude."""
        self.force, self.moment = self.wrench(t, self.attitude)
        self.load = self.load_at(t)
        self.height = self.height_at(t)
        self.on_deck = self.is_on_deck(t)

    def breaks(self) -> list[float]:
        """Return the times (s), ascending, at which the load has a jump or a kink."""
        if self.phase == "landing":
            return [self.contact_time]
        if self.load_model == "consistent":
            return [self.lift_off_time]
        full_thrust = min(self.spool_up_start + self.spool_up_time, self.lift_off_time)
        return sorted({self.spool_up_start, full_thrust, self.lift_off_time})

    def is_on_deck(self, t: float) -> bool:
        """Return whether the HUAUV stands on the deck at ``t`` (s)."""
        return bool(t >= self.contact_time if self.phase == "landing" else t < self.lift_off_time)

    def height_at(self, t: float) -> float:
        """Return the height of the rotors above the deck (m) at ``t`` (s)."""
        return self._flight(t)[0]

    def load_at(self, t: float) -> float:
        """Return the magnitude of the load, Fz (N), at ``t`` (s)."""
        weight = self.mass * self.gravity
        height, climb = self._flight(t)
        amplification = self.ground_effect(height) if self.load_model == "source" else 1.0
        if not self.is_on_deck(t):
            wake_share = math.exp(-((height / self.wake_length) ** 2))
            return float(wake_share * amplification * self.mass * (self.gravity + climb))
        if self.phase == "takeoff" and self.load_model == "source":
            return float(weight + amplification * self._spool_up(t) * weight)
        return float(weight)

    def wrench(self, t: float, attitude: Sequence[float]) -> tuple[Vector3, Vector3]:
        """Return force (N) and moment about the body origin (N.m), both in body axes.

        ``t`` in s, ``attitude`` (phi, theta, psi) in rad.
        """
        force = (0.0, 0.0, self.load_at(t))
        if self.direction == "vertical":
            force = to_body(attitude, force)
        return force, cross(self.pad, force)

    def ground_effect(self, height: float) -> float:
        """Return C_GE of the rotors at ``height`` (m) above the deck ([Timm2026], eq. 61)."""
        decay = math.exp(-self.ground_effect_decay * height / self.rotor_diameter)
        return float(1.0 + self.k0 * decay)

    def _flight(self, t: float) -> tuple[float, float]:
        """Return height above the deck (m) and upward acceleration (m/s2)."""
        if self.is_on_deck(t):
            return 0.0, 0.0
        if self.phase == "takeoff":
            climb = self.climb_acceleration
            return 0.5 * climb * (t - self.lift_off_time) ** 2, climb
        s = max(0.0, t / self.contact_time)  # hovers at z0 until t = 0
        z0 = self.initial_height
        height = z0 * (1.0 - 10.0 * s**3 + 15.0 * s**4 - 6.0 * s**5)
        curvature = z0 * (-60.0 * s + 180.0 * s**2 - 120.0 * s**3)
        return height, curvature / self.contact_time**2

    def _spool_up(self, t: float) -> float:
        """Return the share of the weight that the rotors lift while still on deck."""
        since = t - self.spool_up_start
        if since < 0.0:
            return 0.0
        return 1.0 if since >= self.spool_up_time else since / self.spool_up_time
