"""Contact of a craft with the bottom and with obstacles."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import ClassVar

from seatrial.model.component import Component, Input, Output, Parameter, terminal
from seatrial.physics.contact import friction, hunt_crossley
from seatrial.physics.craft.kinematics import Vector3, cross, to_body, to_ned

from .seabed.parameters import OverSeabed
from .seabed.vectors import along, dot

_CORNERS = tuple(itertools.product((0.5, -0.5), repeat=3))


class Contact(OverSeabed, Component):
    """Contact of a craft's corners with the seabed and the obstacles of its parameters.

    The craft touches with eight spheres of ``radius`` at the corners of a box of ``box_size``
    about ``box_center``. Of each, with penetration delta, m, and its rate, m/s, along the normal
    out of what is nearest (`seabed.scene.Scene.nearest`):

        N = k delta max(0, 1 + d delta')           [Hunt1975], exponent 1
        F_t = -mu N v_t / sqrt(|v_t|^2 + v_s^2)    Coulomb, regularised by ``slip_speed``

    with k = ``stiffness`` and d = ``damping`` of one corner. It never pulls. A craft of weight W
    in water on n corners stands W / (n k) deep, and creeps on a slope of r mu by
    v_s r / sqrt(1 - r^2). Forces act at the spheres' lowest places along the normal.

    **Step.** The force is held while the craft moves, which alone would add energy: it is that
    of the penetration half a step ahead, by the present velocity. Damping and friction are
    those of the present. For the effective mass m of the craft at a corner, with added mass, a
    step is short enough below 0.3 sqrt(m / k) and m v_s / (mu N). A bounce then loses energy from
    d v = 0.05 on, and without damping its speed is kept within 0.5 %.

    **Record.** ``touching`` changes at touch and release; ``touches`` counts the former, and
    ``impact_speed`` is how fast the corner that pressed hardest then went in. All three are of
    communication points.

    Not modelled: faces and edges between the corners, so that a pile thinner than the distance
    of two corners passes between them; soil that gives way or sucks; waves in shallow water.

    Raises InputError at the start for a seabed that cannot be.
    """

    exercised: ClassVar = {"seabed_depth": 1.0, "seabed_slope": 0.1, "box_size": [2.0, 2.0, 2.0]}

    box_size = Parameter((1.0, 1.0, 1.0), "m", "length, breadth and height of the box", axes="xyz")
    box_center = Parameter(0.0, "m", "middle of the box from the body origin", axes="xyz")
    radius = Parameter(0.0, "m", "radius of the spheres at the corners", min=0.0)
    stiffness = Parameter(5000.0, "N/m", "stiffness k of a corner", min=1e-9)
    damping = Parameter(2.0, "s/m", "damping d of a corner", min=0.0)
    friction = Parameter(0.4, "1", "coefficient of friction mu", min=0.0)
    slip_speed = Parameter(0.01, "m/s", "speed v_s below which friction is viscous", min=1e-9)

    position = Input("m", "body origin in north-east-down", axes="xyz", frame="n")
    velocity = Input("m/s", "velocity of the body origin over ground, body axes", axes="uvw")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    rates = Input("rad/s", "angular velocity, body axes", axes="pqr")

    force = Output("N", "force on the craft, body axes", axes="xyz", frame="b")
    moment = Output("N.m", "moment on the craft about its origin, body axes", axes="xyz", frame="b")
    normal_force = Output("N", "sum of the normal forces")
    penetration = Output("m", "of the deepest corner; 0 without contact")
    touching = Output("1", "something is touched", type=bool)
    touches = Output("1", "how often something was touched", type=int)
    impact_speed = Output("m/s", "speed into what was touched last, when it was")

    terminals: ClassVar = {
        "motion": terminal("position", "velocity", "attitude", "rates"),
        "wrench": terminal("force", "moment"),
    }
    feedthrough: ClassVar = {
        **dict.fromkeys(("penetration", "touching"), ("position", "attitude")),
        **dict.fromkeys(("touches", "impact_speed"), ()),
    }

    def start(self, t: float) -> None:
        """Start without contact; raises InputError as the class says."""
        super().start(t)
        self._ahead = 0.0
        self._was_touching = False
        self._touches = 0
        self._closing = 0.0
        self._impact_speed = 0.0

    def step(self, t: float, h: float) -> None:
        """Note whether something is touched at ``t``, and how long a force acts."""
        near = ((depth, rate) for depth, rate, *_ in self._near())
        depth, rate = max(near, default=(-1.0, 0.0))
        if depth > 0.0 and not self._was_touching:
            self._touches += 1
            # The force begins half a step ahead, and may have slowed it already.
            self._impact_speed = max(rate, self._closing)
        self._was_touching = depth > 0.0
        self._closing = rate
        self._ahead = 0.5 * h

    def outputs(self, t: float) -> None:
        """Publish the force of the corners that touch."""
        force = moment = (0.0, 0.0, 0.0)
        total = deepest = 0.0
        for depth, rate, normal, arm, velocity in self._near():
            press = hunt_crossley(depth + rate * self._ahead, rate, self.stiffness, self.damping)
            deepest = max(deepest, depth)
            if press <= 0.0:
                continue
            slip = along(velocity, normal, rate)
            drag = friction(press, slip, self.friction, self.slip_speed)
            total += press
            pushed = to_body(self.attitude, along(drag, normal, press))
            force = _sum(force, pushed)
            moment = _sum(
                moment, cross(along(arm, to_body(self.attitude, normal), -self.radius), pushed)
            )
        self.force, self.moment, self.normal_force = force, moment, total
        self.penetration, self.touching = deepest, deepest > 0.0
        self.touches, self.impact_speed = self._touches, self._impact_speed

    def _near(self) -> Iterator[tuple[float, float, Vector3, Vector3, Vector3]]:
        """Yield of each corner near something: penetration, rate, normal, arm, velocity in {n}."""
        scene = self.scene()
        reach = 0.5 * math.hypot(*self.box_size) + math.hypot(*self.box_center) + self.radius
        middle = scene.nearest(self.position)
        if middle is None or middle.distance > 2.0 * reach + 1.0:
            return
        for signs in _CORNERS:
            arm = _arm(self.box_center, signs, self.box_size)
            place = _sum(self.position, to_ned(self.attitude, arm))
            near = scene.nearest(place)
            assert near is not None  # the scene has something: its middle was near
            foot = along(arm, to_body(self.attitude, near.normal), -self.radius)
            own = _sum(self.velocity, cross(self.rates, foot))
            velocity = to_ned(self.attitude, own)
            yield (
                self.radius - near.distance,
                -dot(velocity, near.normal),
                near.normal,
                arm,
                velocity,
            )


def _sum(a: Sequence[float], b: Sequence[float]) -> Vector3:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _arm(center: Sequence[float], signs: Sequence[float], size: Sequence[float]) -> Vector3:
    x, y, z = (c + s * edge for c, s, edge in zip(center, signs, size, strict=True))
    return (x, y, z)
