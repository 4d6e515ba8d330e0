"""Sliding, tipping and a wet bow: limits of a deck with a drone on it."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from seatrial.model.component import Component, Input, Output, Parameter, terminal
from seatrial.physics.craft.kinematics import Vector3, cross, specific_force, to_ned


class DeckLimits(Component):
    """Forces on the landing gear of a drone that is carried at ``pad``, and immersion of the bow.

    With the specific force f of the pad in body axes,

        f = a + alpha x r + omega x (omega x r) - R^T g,    r = pad, m/s2

    the gear presses the drone with m f: N = -m f_z across the deck, F = m (f_x, f_y) along it.
    To first order F_y = -m (g sin(phi) + phi'' z_pad), [Timm2026], eq. 77. The drone slides where
    |F| > friction N, and tips where |F| c > b N, with c = ``height`` of its CG above the deck and
    b = ``half_breadth`` of its legs: ``sliding`` and ``tipping`` are these shares of the limits,
    1 at the limit. Off the deck (``on_deck`` false, or N <= 0: the deck falls away) all are 0.

    ``bow_immersion`` is how far ``bow`` is below where it floats unloaded, m,
    z + (R bow)_z - bow_z: -bow_x sin(theta) by pitch alone (eq. 73).

    alpha is the change of ``rates`` over the last communication step, over that: half a step late.
    The drone moves with the deck; its own inertia is not the craft's. Limits: quasi-static gear, no
    wake, no wind.
    """

    mass = Parameter(10.0, "kg", "mass of the drone", min=0.0)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    pad = Parameter((0.0, 0.0, -0.2), "m", "landing point from the body origin", axes="xyz")
    friction = Parameter(0.6, "1", "coefficient of friction of legs and deck", min=1e-6)
    height = Parameter(0.25, "m", "CG of the drone above the deck", min=1e-6)
    half_breadth = Parameter(0.2, "m", "of its legs", min=1e-6)
    bow = Parameter(0.0, "m", "bow from the body origin", axes="xyz")

    position = Input("m", "body origin, {n}", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    rates = Input("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))
    acceleration = Input(
        "m/s2", "inertial acceleration of the body origin, body axes", axes="xyz", frame="b"
    )
    on_deck = Input("1", "the drone stands on the deck", type=bool, start=True, optional=True)

    gear_force = Output("N", "force of the gear on the drone, body axes", axes="xyz", frame="b")
    lateral_share = Output("1", "its part along the deck over the weight")
    sliding = Output("1", "share of the friction that there is")
    tipping = Output("1", "share of the moment at which it tips")
    bow_immersion = Output("m", "bow below where it floats unloaded")

    exercised: ClassVar = {"bow": [0.6, 0.0, 0.0]}
    terminals: ClassVar = {"motion": terminal("position", "attitude", "rates", "acceleration")}

    def start(self, t: float) -> None:
        """Start without angular acceleration."""
        self._before: Vector3 | None = None
        self._step = 0.0

    def step(self, t: float, h: float) -> None:
        """Keep the rates at the beginning of the step."""
        self._before, self._step = _vector(self.rates), h

    def outputs(self, t: float) -> None:
        """Publish the forces of the gear, the shares and the immersion."""
        immersed = to_ned(self.attitude, self.bow)[2] - self.bow[2]
        self.bow_immersion = self.position[2] + immersed
        x, y, z = (self.mass * f for f in self._specific_force())
        if not self.on_deck or z >= 0.0:
            self.gear_force = (0.0, 0.0, 0.0)
            self.lateral_share = self.sliding = self.tipping = 0.0
            return
        along, across = math.hypot(x, y), -z
        self.gear_force = (x, y, z)
        self.lateral_share = along / (self.mass * self.gravity)
        self.sliding = along / (self.friction * across)
        self.tipping = along * self.height / (self.half_breadth * across)

    def _specific_force(self) -> Vector3:
        rates, pad = _vector(self.rates), _vector(self.pad)
        turned = (0.0, 0.0, 0.0)
        if self._before is not None:
            change = [now - before for now, before in zip(rates, self._before, strict=True)]
            turned = cross([part / self._step for part in change], pad)
        whirled = cross(rates, cross(rates, pad))
        at_pad = [a + b + c for a, b, c in zip(self.acceleration, turned, whirled, strict=True)]
        return specific_force(_vector(self.attitude), at_pad, self.gravity)


def _vector(values: Any) -> Vector3:
    x, y, z = values
    return (x, y, z)
