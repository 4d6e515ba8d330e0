"""Base of a sailing boat's heading controllers: ports, and the rudder for a yaw moment."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled

_LEAST_SPEED = 0.1  # m/s: below it the direction of the flow at the rudder means nothing
_LEAST_EFFECT = 0.01  # m2/s2: V^2 cos(beta) that the inversion divides by at least


class SailingHeading(Sampled):
    """Base of heading controllers that command a rudder by the yaw moment it should give.

    **Inversion** ([Silva2018], eqs 3.5 and 3.6, lift of a thin foil C_L = 2 pi alpha). With the
    flow (a, b) at the rudder, beta = atan2(b, a), V^2 = a^2 + b^2:

        rudder = wrap(beta - pi) + yaw_moment / (l density area pi V^2 cos(beta))

    where l is the rudder's distance aft of the origin. Ahead V^2 cos(beta) is negative, not
    positive as the source has it, and at rest 0: below 0.1 m/s beta is taken as pi, and a divisor
    smaller than 0.01 m2/s2 as -0.01. The result is limited to +-``rudder_limit``, without which
    it winds up to thousands of degrees; a foil stalls at 10 deg. `saturated`: this was so
    at the instant before: then the integral is frozen.

    A positive ``rudder`` (trailing edge to port) turns to port, a positive ``yaw_moment`` to
    starboard. ``nu`` is the velocity through the water and the rates (u, v, p, r) in body axes.
    SI, rad.

    Not modelled by the inversion: stall, drag of the rudder, current.
    """

    period = Parameter(0.02, "s", "sample period", min=1e-6)
    rudder_place = Parameter((-1.0, 0.0), "m", "centre of effort, body axes", axes="xz")
    rudder_area = Parameter(0.01, "m2", "area of the rudder", min=1e-9)
    water_density = Parameter(1000.0, "kg/m3", "density of the water", min=1e-9)
    rudder_limit = Parameter(
        math.radians(12.0), "rad", "greatest rudder angle", min=0.0, tunable=True
    )

    heading_wanted = Input("rad", "heading to hold, clockwise from north")
    heading = Input("rad", "heading, clockwise from north")
    nu = Input(
        ("m/s", "m/s", "rad/s", "rad/s"),
        "velocity through the water and rates, body axes",
        axes=("u", "v", "p", "r"),
    )

    rudder = Output("rad", "rudder wanted, trailing edge to port positive")
    yaw_moment = Output("N.m", "yaw moment asked of the rudder, to starboard positive")

    terminals: ClassVar = {
        "wanted": terminal("heading_wanted"),
        "sensors": terminal("heading"),
        "estimate": terminal("nu"),
        "held": terminal("rudder"),
    }

    _ACTING: ClassVar[tuple[str, ...]] = ("heading_wanted", "heading", "nu")

    def moment(self) -> float:
        """Return the yaw moment wanted at this instant, N.m."""
        raise TypeError(f"{type(self).__name__} does not define what moment it wants")

    def reset(self, t: float) -> None:
        """Start unsaturated."""
        self.saturated = False

    def sample(self, t: float, k: int) -> None:
        """Command the rudder."""
        self.yaw_moment = self.moment()
        wanted, limit = self._inverted(self.yaw_moment), self.rudder_limit
        self.rudder = min(max(wanted, -limit), limit)

    def update(self, t: float, k: int) -> None:
        """Remember whether the rudder was at its limit."""
        self.saturated = abs(self._inverted(self.yaw_moment)) > self.rudder_limit

    def _inverted(self, moment: float) -> float:
        """Return the rudder angle that gives ``moment`` (N.m), without limits, rad."""
        u, v, p, r = self.nu
        x, z = self.rudder_place
        a, b = -u, -v - r * x + p * z
        beta = math.atan2(b, a) if math.hypot(a, b) >= _LEAST_SPEED else math.pi
        effect = (a * a + b * b) * math.cos(beta)
        if abs(effect) < _LEAST_EFFECT:
            effect = -_LEAST_EFFECT
        per_angle = -x * self.water_density * self.rudder_area * math.pi * effect
        angle: float = math.remainder(beta - math.pi, math.tau) + moment / per_angle
        return angle
