"""A multirotor that comes down on a moving deck and stands there on four legs."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from seatrial.model.component import Input, Parameter, terminal
from seatrial.model.plant import Plant, State
from seatrial.model.ports import Output
from seatrial.physics.craft.symbolic import euler_rate_matrix, rotation_matrix

from .legs import Legs, inside

_EULER = ("phi", "theta", "psi")
_DOWN = ca.DM([0, 0, 1])
_TILT = 0.35
"""The controller tilts the drone to this at most, rad."""


class LeggedDrone(Plant):
    """Rigid multirotor in six degrees of freedom, with friction between four feet and a deck.

    Body axes x bow, y starboard, z down at the CG; feet at (+-a, +-b, c) with ``feet`` (a, b, c).
    With mass m, inertia I, R from body to {n}, thrust T, foot i at r_i with force F_i:

        m v' = m g e3 - T R e3 + sum F_i          v over ground, {n}
        I w' + w x I w = M + sum r_i x R^T F_i    w in body axes

    **Legs.** The deck is the rectangle ``deck_size`` in the craft's axes, at the height of ``pad``.
    With penetration delta of a foot below it, and v_t its velocity along the deck, against it:

        N = k delta max(0, 1 + d delta')           [Hunt1975], exponent 1
        F_t = -mu N v_t / sqrt(|v_t|^2 + v_s^2)    Coulomb, regularised by ``slip_speed``

    k = ``stiffness`` and d = ``damping`` of one leg. ``force`` and ``moment`` on the craft are
    the same forces with the other sign, and the wake. So at rest the craft carries the drone's
    weight; the drone slides where tan(tilt) > mu and tips where its CG is beyond its feet,
    tan(tilt) > b / c. The parked drone creeps by v_s r / sqrt(1 - r^2), r = tan(tilt) / mu.

    **Descent.** Thrust and moments are limited by nothing but the tilt and 2 m g:

        T = s m (g + k_v (v_down - v_descent)) / cos(tilt)
        M = s I (w_n^2 (wanted - attitude) - 2 w_n w)

    ``descent`` gives v_descent over ground; the wanted tilt is that of the horizontal acceleration
    w_h^2 (pad - position) + 2 w_h (velocity of the pad - velocity). The share s of the motors is 1
    in flight and falls by s' = -s / ``spool_down`` while the legs carry more than a tenth of the
    weight: it does not rise again. It waits at ``position_start`` until ``descent_start``.

    **Wake.** exp(-(h / wake_length)^2) T acts on the deck below the rotors, h the height of the
    feet over it, along the deck's normal. ``wake_length`` as of `Downwash`. No ground effect.

    **Step.** The motion of the deck is held while the drone moves: take a step of at most 2 ms. The
    sub-steps of ``max_step`` carry friction as stiff as mu m g / v_s (1 / m + c^2 / I).

    Not modelled: rotors, wind on the drone, aerodynamic drag, compliance of the deck.
    """

    max_step = Parameter(2.5e-4, "s", "longest integration sub-step", min=1e-6, max=1e-3)
    mass = Parameter(10.0, "kg", "mass of the drone", min=1e-3)
    inertia = Parameter((0.25, 0.25, 0.4), "kg.m2", "principal moments", axes="xyz", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    feet = Parameter(
        (0.2, 0.2, 0.25),
        "m",
        "half length and breadth of the legs; below the CG",
        axes="xyz",
        min=0.0,
    )
    stiffness = Parameter(6131.0, "N/m", "stiffness k of a leg", min=1e-9)
    damping = Parameter(1.0, "s/m", "damping d of a leg", min=0.0)
    friction = Parameter(0.6, "1", "coefficient of friction mu", min=0.0)
    slip_speed = Parameter(0.005, "m/s", "speed v_s below which friction is viscous", min=1e-4)
    pad = Parameter((0.0, 0.0, -0.2), "m", "landing point from the craft's origin", axes="xyz")
    deck_size = Parameter(
        (1.276, 1.0), "m", "length and breadth of the deck about the origin", axes="xy", min=0.0
    )
    descent = Parameter(0.4, "m/s", "speed of descent", min=0.0)
    descent_start = Parameter(1.0, "s", "when the descent begins")
    vertical_gain = Parameter(4.0, "1/s", "k_v of the thrust", min=0.0)
    horizontal_bandwidth = Parameter(1.5, "rad/s", "w_h of the position hold", min=0.0)
    attitude_bandwidth = Parameter(10.0, "rad/s", "w_n of the attitude hold", min=0.0)
    spool_down = Parameter(0.1, "s", "time constant of the motors after touch-down", min=1e-3)
    wake_length = Parameter(1.0, "m", "height at which 1/e of the wake meets the deck", min=1e-3)

    deck_position = Input("m", "origin of the craft in {n}", axes="xyz", frame="n")
    deck_velocity = Input("m/s", "velocity of the craft's origin, its body axes", axes="uvw")
    deck_attitude = Input("rad", "Euler angles of the craft", axes=_EULER)
    deck_rates = Input("rad/s", "angular velocity of the craft, its body axes", axes="pqr")

    position = State("m", "CG of the drone in north-east-down", axes="xyz", frame="n")
    velocity = State("m/s", "velocity of the CG over ground, {n}", axes=("north", "east", "down"))
    attitude = State("rad", "Euler angles of the drone, ZYX", axes=_EULER)
    rates = State("rad/s", "angular velocity of the drone, its body axes", axes="pqr")
    clock = State("s", "time since the start")
    stopped = State("1", "logarithm of what the motors have lost since touch-down")

    force = Output("N", "force on the craft, its body axes", axes="xyz", frame="b")
    moment = Output("N.m", "moment on the craft about its origin", axes="xyz", frame="b")
    contact_force = Output(
        "N",
        "of each foot, along the deck's normal: fore port and starboard, aft",
        axes=("fp", "fs", "ap", "as"),
    )
    load = Output("N", "on the deck along its normal: legs and wake")
    thrust = Output("N", "thrust of the rotors")
    place = Output("m", "CG of the drone from the craft's origin, the craft's axes", axes="xyz")
    slip = Output("m/s", "velocity of the middle of the feet along the deck", axes="xy")
    legs_down = Output("1", "how many feet press on the deck")

    terminals: ClassVar = {
        "motion": terminal(
            position="deck_position",
            velocity="deck_velocity",
            attitude="deck_attitude",
            rates="deck_rates",
        ),
        "wrench": terminal("force", "moment"),
    }
    exercised: ClassVar = {"position_start": [0.02, 0.01, -0.449]}

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of the drone's states, and the forces on drone and deck."""
        own, deck = rotation_matrix(x.attitude), rotation_matrix(u.deck_attitude)
        place = deck.T @ (x.position - u.deck_position)
        legs = Legs(x, u, p, own, deck, place)
        share = ca.exp(-x.stopped)
        thrust, torque = _controller(x, u, p, deck, share)
        height = ca.fmax(p.pad[2] - p.feet[2] - place[2], 0)
        over = inside(place, p.deck_size)
        wake = over * ca.exp(-((height / p.wake_length) ** 2)) * thrust
        weight = p.mass * p.gravity
        turning = ca.cross(x.rates, p.inertia * x.rates)
        derivatives = {
            "position": x.velocity,
            "velocity": p.gravity * _DOWN + (deck @ legs.force - thrust * own @ _DOWN) / p.mass,
            "attitude": euler_rate_matrix(x.attitude) @ x.rates,
            "rates": (torque + legs.moment - turning) / p.inertia,
            "clock": 1,
            "stopped": (legs.total > 0.1 * weight) / p.spool_down,
        }
        under = ca.vertcat(place[0], place[1], p.pad[2])
        return derivatives, {
            "force": wake * _DOWN - legs.force,
            "moment": ca.cross(under, wake * _DOWN) - legs.on_deck,
            "contact_force": ca.vertcat(*legs.normals),
            "load": legs.total + wake,
            "thrust": thrust,
            "place": place,
            "slip": legs.slip[:2],
            "legs_down": sum(normal > 0 for normal in legs.normals),
        }


def _controller(x: Any, u: Any, p: Any, deck: Any, share: Any) -> tuple[Any, Any]:
    """Return thrust, N, and moment, N.m in the drone's axes."""
    pad = u.deck_position + deck @ p.pad
    pad_velocity = deck @ (u.deck_velocity + ca.cross(u.deck_rates, p.pad))
    w = p.horizontal_bandwidth
    wanted = w**2 * (pad - x.position) + 2 * w * (pad_velocity - x.velocity)
    c, s = ca.cos(x.attitude[2]), ca.sin(x.attitude[2])
    ahead, starboard = c * wanted[0] + s * wanted[1], c * wanted[1] - s * wanted[0]
    tilt = ca.vertcat(_limited(starboard / p.gravity), -_limited(ahead / p.gravity), 0)
    w = p.attitude_bandwidth
    torque = share * p.inertia * (w**2 * (tilt - x.attitude) - 2 * w * x.rates)
    down = p.descent * (x.clock >= p.descent_start)
    upright = ca.fmax(ca.cos(x.attitude[0]) * ca.cos(x.attitude[1]), 0.5)
    rise = p.gravity + p.vertical_gain * (x.velocity[2] - down)
    thrust = share * p.mass * ca.fmin(ca.fmax(rise / upright, 0), 2 * p.gravity)
    return thrust, torque


def _limited(angle: Any) -> Any:
    return ca.fmin(ca.fmax(angle, -_TILT), _TILT)
