"""Contact of two craft."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Component, Input, Output, Parameter, terminal
from seatrial.physics.contact import friction, hunt_crossley
from seatrial.physics.craft.kinematics import Vector3, cross, to_body, to_ned

from .seabed.vectors import along, dot, minus

_EULER = ("phi", "theta", "psi")


class Collision(Component):
    """Contact of two craft, each a capsule: a cylinder along its x axis with round ends.

    Of each: ``length`` over all, ``radius``, and ``center`` from the body origin, body axes. With
    delta how far the capsules overlap where their axes are nearest, n the unit vector between
    those places, v the difference of the velocities of the two hulls there:

        N = k delta max(0, 1 + d delta')           [Hunt1975], exponent 1
        F_t = -mu N v_t / sqrt(|v_t|^2 + v_s^2)    Coulomb, regularised by ``slip_speed``

    Both craft have the same force at the same place with opposite signs: momentum is conserved.
    It is that of the overlap half a step ahead, as of `Contact`, where the limits of the step
    stand too. ``touching``, ``touches`` and ``impact_speed`` are for the record, as there.

    Not modelled: edges, bows that are sharp, hulls that dent. Capsules side by side touch in one
    place, which jumps along them as they yaw.

    Raises InputError at the start for a capsule that is shorter than it is thick.
    """

    exercised: ClassVar = {
        "second_position": [0.9, 0.2, 0.1],
        "second_attitude": [0.1, 0.2, 0.5],
        "first_velocity": [0.5, 0.1, 0.0],
    }

    first_length = Parameter(1.0, "m", "length of the first capsule", min=0.0)
    first_radius = Parameter(0.25, "m", "its radius", min=1e-6)
    first_center = Parameter(0.0, "m", "its middle from the body origin", axes="xyz")
    second_length = Parameter(1.0, "m", "length of the second capsule", min=0.0)
    second_radius = Parameter(0.25, "m", "its radius", min=1e-6)
    second_center = Parameter(0.0, "m", "its middle from the body origin", axes="xyz")
    stiffness = Parameter(20000.0, "N/m", "stiffness k", min=1e-9)
    damping = Parameter(1.0, "s/m", "damping d", min=0.0)
    friction = Parameter(0.3, "1", "coefficient of friction mu", min=0.0)
    slip_speed = Parameter(0.01, "m/s", "speed v_s below which friction is viscous", min=1e-9)

    first_position = Input("m", "origin of the first in {n}", axes="xyz", frame="n")
    first_velocity = Input("m/s", "velocity of its origin over ground, body axes", axes="uvw")
    first_attitude = Input("rad", "its Euler angles, ZYX", axes=_EULER)
    first_rates = Input("rad/s", "its angular velocity, body axes", axes="pqr")
    second_position = Input("m", "origin of the second in {n}", axes="xyz", frame="n")
    second_velocity = Input("m/s", "velocity of its origin over ground, body axes", axes="uvw")
    second_attitude = Input("rad", "its Euler angles, ZYX", axes=_EULER)
    second_rates = Input("rad/s", "its angular velocity, body axes", axes="pqr")

    first_force = Output("N", "force on the first, its body axes", axes="xyz", frame="b")
    first_moment = Output("N.m", "moment on the first about its origin", axes="xyz", frame="b")
    second_force = Output("N", "force on the second, its body axes", axes="xyz", frame="b")
    second_moment = Output("N.m", "moment on the second about its origin", axes="xyz", frame="b")
    distance = Output("m", "between the hulls, negative where they overlap")
    normal_force = Output("N", "normal force")
    touching = Output("1", "they touch", type=bool)
    touches = Output("1", "how often they touched", type=int)
    impact_speed = Output("m/s", "closing speed when they touched last")

    terminals: ClassVar = {
        "first_motion": terminal(
            position="first_position",
            velocity="first_velocity",
            attitude="first_attitude",
            rates="first_rates",
        ),
        "first_wrench": terminal(force="first_force", moment="first_moment"),
        "second_motion": terminal(
            position="second_position",
            velocity="second_velocity",
            attitude="second_attitude",
            rates="second_rates",
        ),
        "second_wrench": terminal(force="second_force", moment="second_moment"),
    }
    _POSES: ClassVar = ("first_position", "first_attitude", "second_position", "second_attitude")
    _MOTIONS: ClassVar = (
        *_POSES,
        "first_velocity",
        "first_rates",
        "second_velocity",
        "second_rates",
    )
    feedthrough: ClassVar = dict.fromkeys(("distance", "touching"), _POSES)

    def start(self, t: float) -> None:
        """Start without contact; raises InputError as the class says."""
        for craft, length, radius in (
            ("first", self.first_length, self.first_radius),
            ("second", self.second_length, self.second_radius),
        ):
            if length < 2.0 * radius:
                raise InputError(
                    f"{self.name}: {craft}_length is {length!r} m: a capsule with {craft}_radius "
                    f"{radius!r} m is at least twice that long"
                )
        self._ahead = 0.0
        self._was_touching = False
        self._touches = 0
        self._closing = 0.0
        self._impact_speed = 0.0

    def step(self, t: float, h: float) -> None:
        """Note whether they touch at ``t``, and how long a force acts."""
        overlap, rate, *_ = self._meeting()
        if overlap > 0.0 and not self._was_touching:
            self._touches += 1
            # The force begins half a step ahead, and may have slowed them already.
            self._impact_speed = max(rate, self._closing)
        self._was_touching = overlap > 0.0
        self._closing = rate
        self._ahead = 0.5 * h

    def outputs(self, t: float) -> None:
        """Publish the force that each has from the other."""
        overlap, rate, normal, velocity, place = self._meeting()
        press = hunt_crossley(overlap + rate * self._ahead, rate, self.stiffness, self.damping)
        drag = friction(press, along(velocity, normal, rate), self.friction, self.slip_speed)
        on_first = along(drag, normal, press)
        on_second = (-on_first[0], -on_first[1], -on_first[2])
        self.first_force = to_body(self.first_attitude, on_first)
        self.first_moment = to_body(
            self.first_attitude, cross(minus(place, self.first_position), on_first)
        )
        self.second_force = to_body(self.second_attitude, on_second)
        self.second_moment = to_body(
            self.second_attitude, cross(minus(place, self.second_position), on_second)
        )
        self.distance, self.normal_force, self.touching = -overlap, press, overlap > 0.0
        self.touches, self.impact_speed = self._touches, self._impact_speed

    def _meeting(self) -> tuple[float, float, Vector3, Vector3, Vector3]:
        """Return overlap, its rate, the normal to the first, its relative velocity, the place."""
        first = _axis(
            self.first_position,
            self.first_attitude,
            self.first_center,
            self.first_length - 2.0 * self.first_radius,
        )
        second = _axis(
            self.second_position,
            self.second_attitude,
            self.second_center,
            self.second_length - 2.0 * self.second_radius,
        )
        one, other = nearest_points(*first, *second)
        apart = minus(one, other)
        distance = math.hypot(*apart)
        normal = along((0.0, 0.0, 0.0), apart, 1.0 / distance) if distance else (0.0, 0.0, -1.0)
        overlap = self.first_radius + self.second_radius - distance
        place = along(other, normal, self.second_radius - 0.5 * overlap)
        velocity = minus(
            _velocity(
                place,
                self.first_position,
                self.first_attitude,
                self.first_velocity,
                self.first_rates,
            ),
            _velocity(
                place,
                self.second_position,
                self.second_attitude,
                self.second_velocity,
                self.second_rates,
            ),
        )
        return overlap, -dot(velocity, normal), normal, velocity, place


def nearest_points(
    a: Sequence[float], b: Sequence[float], c: Sequence[float], d: Sequence[float]
) -> tuple[Vector3, Vector3]:
    """Return the places of the segments a-b and c-d, m, that are nearest to each other.

    Of parallel segments that overlap, those at one end of the overlap.
    """
    u, v, w = minus(b, a), minus(d, c), minus(a, c)
    uu, uv, vv, uw, vw = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    across = uu * vv - uv * uv
    s = _share(uv * vw - vv * uw, across) if across > 1e-12 * uu * vv else 0.0
    t = _share(uv * s + vw, vv)
    s = _share(uv * t - uw, uu)
    return along(a, u, s), along(c, v, t)


def _share(part: float, whole: float) -> float:
    return min(max(part / whole, 0.0), 1.0) if whole > 0.0 else 0.0


def _axis(
    position: Sequence[float], attitude: Sequence[float], center: Sequence[float], length: float
) -> tuple[Vector3, Vector3]:
    """Return the ends of a capsule's axis, {n}."""
    middle = along(position, to_ned(attitude, center), 1.0)
    ahead = to_ned(attitude, (1.0, 0.0, 0.0))
    return along(middle, ahead, -0.5 * length), along(middle, ahead, 0.5 * length)


def _velocity(
    place: Sequence[float],
    position: Sequence[float],
    attitude: Sequence[float],
    velocity: Sequence[float],
    rates: Sequence[float],
) -> Vector3:
    """Return the velocity, {n}, of a body's material at a place, {n}."""
    turning = cross(rates, to_body(attitude, minus(place, position)))
    return to_ned(attitude, along(velocity, turning, 1.0))
