"""Contact of a craft with bottom, walls and other obstacles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from ..component import Component, Input, Output, Parameter, terminal
from ..contact import friction, hunt_crossley
from ..craft.kinematics import Vector3, cross, to_body, to_ned
from ..errors import InputError
from ..seabed.parameters import OverSeabed
from ..seabed.vectors import dot

MOST = 8
_MOTION = ("position", "attitude", "velocity", "rates")


class ContactPoints(Component):
    """Mix-in: spheres that stand for the outside of a craft, up to 8; places in body axes, m."""

    count = Parameter(1.0, "1", "number of points", min=1.0, max=float(MOST))
    point_1 = Parameter(0.0, "m", "first point, body axes", axes="xyz")
    point_2 = Parameter(0.0, "m", "second point, body axes", axes="xyz")
    point_3 = Parameter(0.0, "m", "third point, body axes", axes="xyz")
    point_4 = Parameter(0.0, "m", "fourth point, body axes", axes="xyz")
    point_5 = Parameter(0.0, "m", "fifth point, body axes", axes="xyz")
    point_6 = Parameter(0.0, "m", "sixth point, body axes", axes="xyz")
    point_7 = Parameter(0.0, "m", "seventh point, body axes", axes="xyz")
    point_8 = Parameter(0.0, "m", "eighth point, body axes", axes="xyz")
    radius = Parameter(0.0, "m", "radius of each point's sphere", min=0.0)

    def points(self) -> list[Vector3]:
        """Return them. Raises InputError for a number of points that is not whole."""
        if self.count % 1.0:
            raise InputError(f"{self.name}.count is {self.count!r}, a whole number is needed")
        return [tuple(getattr(self, f"point_{n + 1}")) for n in range(int(self.count))]


class Contact(ContactPoints, OverSeabed):
    """Penalty forces of bottom and obstacles on the points of a craft.

    For each point, a sphere about r in body axes, with the nearest face of the scene at the
    distance s along its normal n, out of it, {n}:

        delta = radius - s,   rate = -v . n
        F = N n + T,  N = k delta max(0, 1 + d rate) for delta > 0  (Hunt and Crossley)
        T = -mu N v_t / sqrt(|v_t|^2 + v_s^2)

    at the place of contact r_c = r - s R^T n, whose velocity is v = R (v_o + omega x r_c), with
    v_t = v - (v . n) n. ``force`` and ``moment`` are the sum over the points, body axes, about
    the body origin. It never pulls.

    The force is held while the craft takes its step. It is that of the points half of a step
    ahead, at their velocity: a spring that is held at its value before would push back later
    than it should, and give energy, k h / 2 per unit of speed. Choose k so that the craft
    does not sink deeper than it may, k = m (v / delta)^2 of an impact at v, and k h^2 below a
    tenth of the mass; m is with added mass. The friction creeps (`friction`): on a slope with
    tan(slope) = r mu by v_s r / sqrt(1 - r^2); held for h it needs v_s above mu N h / (2 m).

    ``touches`` counts how often a touch began, ``penetration`` is the greatest delta of all
    points, ``normal_force`` the sum of N.

    Defaults, assumed: 2 kN/m, 1 s/m (restitution 0.59 at 1 m/s), mu 0.4.

    Not modelled: mud, breakage, faces and edges between the points, contact with the surface.
    Raises InputError at the start for a number of points that is not whole.
    """

    exercised: ClassVar = {"seabed_depth": 0.5, "point_1": [0.2, 0.1, 0.4], "radius": 0.3}

    stiffness = Parameter(2000.0, "N/m", "k of each point", min=0.0)
    damping = Parameter(1.0, "s/m", "d", min=0.0)
    friction_coefficient = Parameter(0.4, "1", "mu", min=0.0)
    slip_speed = Parameter(0.02, "m/s", "speed below which friction fades", min=1e-6)

    position = Input("m", "body origin, north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "roll, pitch, yaw", axes=("phi", "theta", "psi"))
    velocity = Input("m/s", "velocity of the body origin, body axes", axes="uvw", frame="b")
    rates = Input("rad/s", "angular rates, body axes", axes="pqr", frame="b")

    force = Output("N", "force on the craft, body axes", axes="xyz", frame="b")
    moment = Output(
        "N.m", "moment on the craft about the body origin, body axes", axes="xyz", frame="b"
    )
    touching = Output("1", "whether any point touches", type=bool)
    touches = Output("1", "touches that have begun", type=int)
    penetration = Output("m", "greatest penetration of a point")
    normal_force = Output("N", "sum of the normal forces")

    terminals: ClassVar = {
        "motion": terminal(*_MOTION),
        "wrench": terminal("force", "moment", rule="plug"),
    }
    feedthrough: ClassVar = dict.fromkeys(
        ("force", "moment", "normal_force"), _MOTION
    ) | dict.fromkeys(("touching", "penetration"), _MOTION[:2])

    def start(self, t: float) -> None:
        """Read points and scene. Raises InputError."""
        super().start(t)
        self._points = self.points()
        self._ahead, self._count, self._was = 0.0, 0, False

    def step(self, t: float, h: float) -> None:
        """Count the touches, and remember how long the next force is held."""
        touches = self._loads()[2] > 0.0
        self._count += touches and not self._was
        self._ahead, self._was = h / 2, touches

    def outputs(self, t: float) -> None:
        """Sum the points."""
        self.force, self.moment, deepest, self.normal_force = self._loads()
        self.penetration, self.touching = deepest, deepest > 0.0
        self.touches = self._count

    def _loads(self) -> tuple[list[float], list[float], float, float]:
        """Return force and moment, body axes, the greatest penetration and the normal forces."""
        scene, deepest, pressed = self.scene(), 0.0, 0.0
        total = [0.0] * 6
        for r in self._points:
            place = _plus(self.position, to_ned(self.attitude, r))
            face = scene.nearest(place)
            if face is None:
                continue
            deepest = max(deepest, self.radius - face.distance)
            face = scene.nearest(_plus(place, self._velocity(r), self._ahead)) or face
            if face.distance >= self.radius:
                continue
            delta, normal = self.radius - face.distance, face.normal
            arm = _plus(r, to_body(self.attitude, normal), -face.distance)
            v = self._velocity(arm)
            rate = -dot(v, normal)
            push = hunt_crossley(delta, rate, self.stiffness, self.damping)
            along = _plus(v, normal, rate)
            drag = friction(push, along, self.friction_coefficient, self.slip_speed)
            load = to_body(self.attitude, _plus(drag, normal, push))
            for i, part in enumerate((*load, *cross(arm, load))):
                total[i] += part
            pressed += push
        return total[:3], total[3:], deepest, pressed

    def _velocity(self, r: Sequence[float]) -> Vector3:
        """Return the velocity, {n}, of a point of the craft."""
        return to_ned(self.attitude, _plus(self.velocity, cross(self.rates, r)))


def _plus(a: Sequence[float], b: Sequence[float], factor: float = 1.0) -> Vector3:
    """Return a + factor b."""
    x, y, z = (p + factor * q for p, q in zip(a, b, strict=True))
    return x, y, z
