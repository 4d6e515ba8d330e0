"""Figures of a landing on a moving deck, from the truth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from seatrial.model.component import Component, Input, Output, Parameter, terminal
from seatrial.physics.craft.kinematics import Vector3, cross, rotation, to_body, to_ned

_EULER = ("phi", "theta", "psi")
_AIRBORNE = 0.1
"""Height of the feet from which a contact is a landing, m."""


class TouchDown(Component):
    """First contact of a drone's legs with a deck, held from then on, and whether it landed.

    At the first instant at which ``legs_down`` is above 0, after the feet were 0.1 m over the deck
    (a drone that takes off from it has not landed), with the middle of the feet f from
    the pad in the deck's axes, and its velocity v over the deck:

        touch_error = sqrt(f_x^2 + f_y^2)      touch_speed = v_z, into the deck
        touch_aside = sqrt(v_x^2 + v_y^2)      touch_tilt  = angle between the z axes

    It lands if these are within ``radius``, ``speed_limit``, ``aside_limit`` and ``tilt_limit``,
    and if ``settled_after`` contact it is within ``rest_tilt`` of the deck, has moved along it
    by ``rest_move`` at most and stands on the deck with a leg. ``landed`` is 1 from then on,
    -1 once it did not, 0 while open; ``failure`` is the first limit that it missed: 1 no contact by
    ``time_limit``, 2 radius, 3 speed, 4 speed aside, 5 tilt, 6 rest. ``energy`` is the
    integral of ``power`` up to contact, J; ``touch_time`` its time, s, ``peak_load`` the largest
    load on the deck, N, ``deck_tilt`` the deck's tilt at contact, rad.
    """

    feet = Parameter((0.2, 0.2, 0.25), "m", "feet from the CG", axes="xyz", min=0.0)
    pad = Parameter((0.0, 0.0, -0.2), "m", "landing point from the craft's origin", axes="xyz")
    radius = Parameter(0.30, "m", "largest error", min=0.0)
    speed_limit = Parameter(1.0, "m/s", "largest speed into the deck", min=0.0)
    aside_limit = Parameter(0.6, "m/s", "largest speed along the deck", min=0.0)
    tilt_limit = Parameter(math.radians(12.0), "rad", "largest tilt against the deck", min=0.0)
    settled_after = Parameter(4.0, "s", "time from contact to the check at rest", min=0.0)
    rest_tilt = Parameter(math.radians(15.0), "rad", "largest tilt against the deck", min=0.0)
    rest_move = Parameter(0.15, "m", "largest way along the deck since contact", min=0.0)
    time_limit = Parameter(120.0, "s", "by when it has to touch", min=0.0)

    position = Input("m", "CG of the drone in north-east-down", axes="xyz", frame="n")
    velocity = Input("m/s", "velocity of the CG over ground, body axes", axes="uvw")
    attitude = Input("rad", "Euler angles of the drone", axes=_EULER)
    rates = Input("rad/s", "angular velocity of the drone, body axes", axes="pqr")
    deck_position = Input("m", "origin of the craft in {n}", axes="xyz", frame="n")
    deck_velocity = Input("m/s", "velocity of the craft's origin, its body axes", axes="uvw")
    deck_attitude = Input("rad", "Euler angles of the craft", axes=_EULER)
    deck_rates = Input("rad/s", "angular velocity of the craft, its body axes", axes="pqr")
    legs_down = Input("1", "how many feet press on the deck")
    load = Input("N", "on the deck", optional=True)
    power = Input("W", "electrical power of the motors", optional=True)

    touched = Output("1", "whether it has touched the deck", type=bool)
    touch_time = Output("s", "time of the first contact")
    touch_error = Output("m", "middle of the feet from the pad, along the deck")
    touch_speed = Output("m/s", "speed into the deck")
    touch_aside = Output("m/s", "speed along the deck")
    touch_tilt = Output("rad", "angle between the axes of drone and deck")
    deck_tilt = Output("rad", "tilt of the deck at contact")
    landed = Output("1", "1 landed, -1 not, 0 open")
    failure = Output("1", "first limit that was missed, 0 none")
    energy = Output("J", "drawn until contact")
    peak_load = Output("N", "largest load on the deck")
    height = Output("m", "middle of the feet over the deck, along its normal")

    terminals: ClassVar = {
        "motion": terminal("position", "velocity", "attitude", "rates"),
        "deck": terminal(
            position="deck_position",
            velocity="deck_velocity",
            attitude="deck_attitude",
            rates="deck_rates",
        ),
    }
    views: ClassVar = {
        "state": {
            "attitude": "attitude",
            "value": "landed",
            "first": "-1",
            "words": "landing failed, , rests on the deck",
        },
        "target": {"attitude": "deck_attitude", "place": "pad", "radius": "radius"},
    }
    _LATCHED = ("touch_error", "touch_speed", "touch_aside", "touch_tilt", "deck_tilt")
    _KEPT = (*_LATCHED, "touched", "touch_time", "landed", "failure", "energy", "peak_load")
    feedthrough: ClassVar = {
        **dict.fromkeys(_KEPT, ()),
        "height": ("position", "attitude", "deck_position", "deck_attitude"),
    }

    def start(self, t: float) -> None:
        """Start with nothing touched."""
        self._at, self._figures = -1.0, [0.0] * 5
        self._place = [0.0, 0.0]
        self._landed = self._failure = self._energy = self._peak = 0.0
        self._began, self._flew = t, False

    def step(self, t: float, h: float) -> None:
        """Latch the first contact, and decide when it has come to rest."""
        foot, speed, tilt = self._over_deck()
        self._peak = max(self._peak, self.load)
        self._flew = self._flew or foot[2] < -_AIRBORNE
        if self._at < 0.0:
            self._energy += self.power * h
            if self._flew and self.legs_down > 0.0:
                self._touch(t, foot, speed, tilt)
            elif t - self._began >= self.time_limit and not self._landed:
                self._landed, self._failure = -1.0, 1.0
        elif not self._landed and t - self._at >= self.settled_after:
            moved = math.dist(foot[:2], self._place)
            rests = tilt <= self.rest_tilt and moved <= self.rest_move and self.legs_down > 0.0
            self._landed = 1.0 if rests and not self._failure else -1.0
            self._failure = self._failure or (0.0 if rests else 6.0)

    def outputs(self, t: float) -> None:
        """Publish what has been latched."""
        self.touched, self.touch_time = self._at >= 0.0, max(self._at, 0.0)
        for name, value in zip(self._LATCHED, self._figures, strict=True):
            setattr(self, name, value)
        self.landed, self.failure = self._landed, self._failure
        self.energy, self.peak_load = self._energy, self._peak
        self.height = -self._over_deck()[0][2]

    def _touch(self, t: float, foot: Vector3, speed: Vector3, tilt: float) -> None:
        error, aside = math.hypot(foot[0], foot[1]), math.hypot(speed[0], speed[1])
        deck = rotation(*self.deck_attitude)[2][2]
        self._at, self._place = t, [foot[0], foot[1]]
        self._figures = [error, speed[2], aside, tilt, math.acos(max(-1.0, min(1.0, deck)))]
        limits = (self.radius, self.speed_limit, self.aside_limit, self.tilt_limit)
        for number, (value, limit) in enumerate(zip(self._figures, limits, strict=False)):
            if value > limit:
                self._failure = number + 2.0
                break

    def _over_deck(self) -> tuple[Vector3, Vector3, float]:
        """Return the middle of the feet from the pad, its velocity over the deck, the tilt."""
        arm = (0.0, 0.0, self.feet[2])
        foot = _added(self.position, to_ned(self.attitude, arm))
        place = to_body(self.deck_attitude, _less(foot, self.deck_position))
        own = _added(self.velocity, cross(self.rates, arm))
        over = to_body(self.deck_attitude, to_ned(self.attitude, own))
        deck = _added(self.deck_velocity, cross(self.deck_rates, place))
        up, normal = rotation(*self.attitude), rotation(*self.deck_attitude)
        cosine = sum(up[i][2] * normal[i][2] for i in range(3))
        return _less(place, self.pad), _less(over, deck), math.acos(max(-1.0, min(1.0, cosine)))


def _added(a: Sequence[float], b: Sequence[float]) -> Vector3:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _less(a: Sequence[float], b: Sequence[float]) -> Vector3:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])
