"""Heading control of a sailing boat by integral backstepping."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.physics.foils import HIGH_ALPHA, SAIL_ENTRIES, foil_naca63010, sail_naca0015

from .heading import SailingHeading
from .sail_loads import foil_load, sail_place


class SailingHeadingBackstepping(SailingHeading):
    """Backstepping control of the heading, with the rudder of `SailingHeading`.

    [Silva2018], eqs 3.13 to 3.33. With e = wrap(heading - heading_wanted), z1 its integral and
    the rate of the heading taken for r:

        d1 = -K_i z1,  z2 = e - d1,  d1' = -K_i e
        d2 = d1' - K_p z2 - z1,  z3 = r - d2,  d2' = -K_i r - K_p (r - d1') - e
        yaw_moment = inertia (d2' - z2 - K_d z3) - N_sail - N_keel + N_Coriolis + N_damping

    so that V = (z1^2 + z2^2 + z3^2) / 2 (output ``lyapunov``) decays by K_i z1^2 + K_p z2^2 +
    K_d z3^2 in the model that 3.30 takes for the boat: no sway from yaw, heel 0, a rudder that
    gives what is asked of it. z1 grows after it is used, and not at an instant after one at
    which the rudder was at its limit. With the source's gains the z have damping 0.083.

    The loads are a model's: sail and keel by 2.18 to 2.29 (`foil_load`), Coriolis moment of
    the added mass by 2.12, damping by 2.13, in the velocity through the water ``nu``.
    ``sail`` and ``flap`` are the angles of the servos as they were at the instant before, for
    what they are moved to at this one is not known yet.

    ``apparent_wind`` is the flow at the centre of effort of the sail amidships: speed, and the
    direction it blows to from the bow, to starboard positive.
    """

    exercised: ClassVar = {
        "rudder_limit": 100.0,
        "sail_area": 0.9,
        "sail_arm": 0.2,
        "keel_area": 0.07,
        "sail_start": 0.7,
        "Y_vdot": -20.0,
        "N_r": -48.0,
    }

    K_p = Parameter(0.2, "1/s", "gain of z2", tunable=True)
    K_i = Parameter(0.001, "1/s", "gain of z1", tunable=True)
    K_d = Parameter(0.07, "1/s", "gain of z3", tunable=True)
    inertia = Parameter(1.0, "kg.m2", "inertia in yaw with added inertia", min=0.0)
    X_udot = Parameter(0.0, "kg", "added mass in surge, negative")
    Y_vdot = Parameter(0.0, "kg", "added mass in sway, negative")
    Y_rdot = Parameter(0.0, "kg.m", "added mass, sway from yaw and yaw from sway")
    N_v = Parameter(0.0, "N.s", "yaw moment per speed of sway")
    N_r = Parameter(0.0, "N.m.s/rad", "damping of yaw, negative")
    air_density = Parameter(1.225, "kg/m3", "density of the air", min=0.0)
    sail_area = Parameter(0.0, "m2", "area of the sail", min=0.0)
    sail_axis = Parameter(
        (0.0, 0.0), "m", "axis of the sail at its centre of effort, body axes", axes="xz"
    )
    sail_arm = Parameter(0.0, "m", "centre of effort of the sail behind its axis")
    keel_area = Parameter(0.0, "m2", "area of the keel", min=0.0)
    keel_place = Parameter((0.0, 0.0), "m", "centre of effort of the keel, body axes", axes="xz")
    sail_entry = Parameter(
        "patched", "1", "C_L of the sail at flap 15, alpha 175 deg", choices=SAIL_ENTRIES
    )
    high_alpha = Parameter(
        "physical", "1", "C_L beyond 90 deg: as in the tables, or negated", choices=HIGH_ALPHA
    )
    sail_start = Parameter(0.0, "rad", "angle of the sail before the first instant")
    flap_start = Parameter(0.0, "rad", "angle of the flap before the first instant")

    apparent_wind = Input(
        ("m/s", "rad"),
        "apparent wind at the sail, and where it blows to from the bow, to starboard positive",
        axes=("speed", "angle"),
    )
    sail = Input("rad", "angle of the sail, boom to port positive")
    flap = Input("rad", "size of the flap's angle")

    lyapunov = Output("1", "V, with z1 in rad.s, z2 in rad and z3 in rad/s")

    _ALL = (*SailingHeading._ACTING, "apparent_wind")
    terminals: ClassVar = {
        **SailingHeading.terminals,
        "sensors": terminal(
            "heading", wind_speed="apparent_wind__speed", wind_angle="apparent_wind__angle"
        ),
    }

    def reset(self, t: float) -> None:
        """Start with an empty integral."""
        super().reset(t)
        self._z1 = 0.0
        self._sail, self._flap = self.sail_start, self.flap_start

    def sample(self, t: float, k: int) -> None:
        """Command the rudder and publish V."""
        super().sample(t, k)
        z1, z2, z3, _ = self._errors()
        self.lyapunov = 0.5 * (z1 * z1 + z2 * z2 + z3 * z3)

    def moment(self) -> float:
        """Return the moment that makes V decay, N.m."""
        _, z2, z3, slope = self._errors()
        moment: float = self.inertia * (slope - z2 - self.K_d * z3) - self._loads()
        return moment

    def update(self, t: float, k: int) -> None:
        """Remember the integral and where sail and flap are."""
        if not self.saturated:
            self._z1 += self._error() * self.period
        self._sail, self._flap = self.sail, self.flap
        super().update(t, k)

    def _error(self) -> float:
        return math.remainder(self.heading - self.heading_wanted, math.tau)

    def _errors(self) -> tuple[float, float, float, float]:
        """Return z1, z2, z3 and d2'."""
        e, r, z1 = self._error(), self.nu[3], self._z1
        z2 = e + self.K_i * z1
        d1_dot = -self.K_i * e
        d2 = d1_dot - self.K_p * z2 - z1
        d2_dot = -self.K_i * r - self.K_p * (r - d1_dot) - e
        return z1, z2, r - d2, d2_dot

    def _loads(self) -> float:
        """Return the yaw moment on the boat, apart from the rudder's, N.m."""
        u, v, p, r = self.nu
        h_u = self.X_udot * u
        h_v = self.Y_vdot * v + self.Y_rdot * r
        coriolis = -h_v * u + h_u * v
        damping = -self.N_v * v - self.N_r * r
        keel_x, keel_z = self.keel_place
        keel = foil_load(
            foil_naca63010(self.high_alpha),
            (keel_x, 0.0, keel_z),
            (-u, -v - r * keel_x + p * keel_z),
            0.0,
            0.5 * self.water_density * self.keel_area,
        )
        moment: float = self._sail_moment() + keel[3] - coriolis - damping
        return moment

    def _sail_moment(self) -> float:
        """Return the yaw moment of the sail where it was at the instant before, N.m."""
        speed, angle = self.apparent_wind
        r, arm = self.nu[3], self.sail_arm
        # From the sail amidships to the sail where it is: only yaw makes a difference.
        flow = (
            speed * math.cos(angle) - r * arm * math.sin(self._sail),
            speed * math.sin(angle) - r * arm * (1.0 - math.cos(self._sail)),
        )
        place = sail_place(self.sail_axis, arm, self._sail)
        table = sail_naca0015(self.sail_entry, self.high_alpha)
        half = 0.5 * self.air_density * self.sail_area
        return foil_load(table, place, flow, self._sail, half, self._flap)[3]
