"""A quadrotor by its rotors, body drag and legs, over a deck that moves."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from seatrial.model.component import Input, Parameter, terminal
from seatrial.model.plant import Plant, State
from seatrial.model.ports import Output
from seatrial.model.terminals import MOTION
from seatrial.physics.craft.symbolic import rotation_matrix

from .legs import Legs, inside

ROTORS = ("r1", "r2", "r3", "r4")
PLACES = ((1, 1), (-1, -1), (1, -1), (-1, 1))
"""Ahead and to starboard of each hub: front right, rear left, front left, rear right."""
SPINS = (1, 1, -1, -1)
"""+1 of a rotor that turns counter-clockwise seen from above."""
_EULER = ("phi", "theta", "psi")
_DOWN = ca.DM([0, 0, 1])


class Multirotor(Plant):
    """Rigid quadrotor with four rotors of their own speed, drag, ground effect and four feet.

    Body axes x bow, y starboard, z down at the CG; {n} north-east-down; hubs at (+-a, +-b, c) with
    ``hub`` (a, b, c), in the order front right, rear left (s = +1, counter-clockwise seen from
    above), front left, rear right (s = -1): ArduCopter's frame QUAD, type X. With R from body to
    {n}, rotor i at r_i with speed O_i (rad/s), T the thrusts, F and M of the legs:

        O_i' = (min(max(command_i, 0), O_max) - O_i) / tau
        T_i  = max(k_T O_i^2 - k_in O_i w_i, 0) G_i,  Q_i = k_Q O_i^2 + J_r O_i'
        m v' = m g e3 + R (F_drag + push - sum T_i e3) + F             v over ground, {n}
        I w' = sum r_i x (-T_i e3) + sum s_i Q_i e3 + M - w x (I w - J_r sum s_i O_i e3)
        k_T  = C_T rho D^4 / (4 pi^2),      k_Q = C_P rho D^5 / (8 pi^3)
        F_drag = -1/2 rho CdA |v_a| v_a - c_r (mean O / O_hover) (v_ax, v_ay, 0)

    v_a = R^T (v - wind) is the velocity through the air, w_i how fast hub i climbs through it
    along its axis: ``inflow`` k_in (N s2/m/rad) takes thrust from a rotor that climbs, by
    momentum and blade elements linear in w_i O_i. O_max falls with ``supply_voltage`` below
    ``nominal_voltage``. ``hover`` is sqrt(m g / (4 k_T)).

    **Ground effect.** G_i = 1 / (1 - (D / (8 z_i))^2), z_i the distance of hub i from the deck's
    plane along its normal, D / 4 at least: I. C. Cheeseman and W. E. Bennett, ARC R&M 3021
    (1955), whose ratio is at constant power, here at constant speed. G_i = 1 where the foot of
    the perpendicular is beside the deck, below it, and over a deck that is upside down: so a
    rotor beyond the edge makes a moment.

    **Legs** and **wake** as of `LeggedDrone`: Hunt and Crossley's force and regularised friction at
    four feet; exp(-(h / wake_length)^2) sum T_i on the deck along its normal, h the height of
    the feet, where the CG is over the deck. ``force`` and ``moment`` on the craft are both.

    **Attitude.** The state ``turn`` is the quaternion (w, x, y, z) from ``attitude_start`` on, so
    that no attitude is singular; ``attitude`` has the Euler angles ZYX of both.

    ``power`` is the shaft power sum Q_i O_i, never below 0, over ``drive_efficiency``.

    **Step.** Motion of the deck, wind and commands are held over a step: take 2 ms at most. The
    sub-steps of ``max_step`` carry friction as stiff as mu m g / v_s (1 / m + c^2 / I).

    Not modelled: flapping, vortex ring, rotors in each other's wake, flexible arms, the deck's
    reflected wake on the body, more ground effect of four rotors than of one.
    """

    max_step = Parameter(2.5e-4, "s", "longest integration sub-step", min=1e-6, max=1e-3)
    mass = Parameter(10.0, "kg", "mass of the drone", min=1e-3)
    inertia = Parameter((0.25, 0.25, 0.4), "kg.m2", "principal moments", axes="xyz", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=1e-3)
    density = Parameter(1.225, "kg/m3", "density of the air", min=1e-3)
    rotor_diameter = Parameter(0.40, "m", "diameter D of a rotor", min=1e-3)
    hub = Parameter((0.25, 0.25, -0.05), "m", "hub front right; the others mirror it", axes="xyz")
    thrust_coefficient = Parameter(0.10, "1", "C_T = T / (rho n^2 D^4)", min=1e-6)
    power_coefficient = Parameter(0.045, "1", "C_P = P / (rho n^3 D^5)", min=0.0)
    inflow = Parameter(
        0.0, "N.s2/m", "k_in: thrust lost per rad/s of speed and m/s of climb", min=0
    )
    rotor_lag = Parameter(0.05, "s", "time constant tau of a rotor's speed", min=1e-4)
    rotor_inertia = Parameter(3.0e-4, "kg.m2", "J_r of a rotor about its axis", min=0.0)
    max_speed = Parameter(785.7987745754486, "rad/s", "highest speed O_max of a rotor", min=0.0)
    nominal_voltage = Parameter(22.2, "V", "supply with which a rotor has O_max", min=1e-3)
    drive_efficiency = Parameter(0.8, "1", "of motors and controllers", min=0.01, max=1.0)
    drag_area = Parameter((0.12, 0.12, 0.25), "m2", "CdA of the body", axes="xyz", min=0.0)
    rotor_drag = Parameter(0.30, "N.s/m", "in-plane drag c_r of all rotors at hover", min=0.0)
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
    wake_length = Parameter(1.0, "m", "height at which 1/e of the wake meets the deck", min=1e-3)
    attitude_start = Parameter(0.0, "rad", "Euler angles at the start, ZYX", axes=_EULER)

    command = Input("rad/s", "speed wanted of each rotor", axes=ROTORS)
    wind = Input("m/s", "velocity of the air, {n}", axes=("north", "east", "down"), optional=True)
    push = Input("N", "further force at the CG, body axes", axes="xyz", frame="b", optional=True)
    supply_voltage = Input("V", "voltage at the motors", start=1000.0, optional=True)
    deck_position = Input("m", "origin of the craft in {n}", axes="xyz", frame="n")
    deck_velocity = Input("m/s", "velocity of the craft's origin, its body axes", axes="uvw")
    deck_attitude = Input("rad", "Euler angles of the craft", axes=_EULER)
    deck_rates = Input("rad/s", "angular velocity of the craft, its body axes", axes="pqr")

    position = State("m", "CG of the drone in north-east-down", axes="xyz", frame="n")
    velocity_n = State("m/s", "velocity of the CG over ground", axes=("north", "east", "down"))
    turn = State("1", "quaternion of the turn since the start", axes="wxyz", start=(1, 0, 0, 0))
    rates = State("rad/s", "angular velocity of the drone, its body axes", axes="pqr")
    rotor_speed = State("rad/s", "speed of each rotor", axes=ROTORS, start=555.6436421503789)

    attitude = Output("rad", "Euler angles of the drone, ZYX", axes=_EULER)
    velocity = Output("m/s", "velocity of the CG over ground, body axes", axes="uvw")
    acceleration = Output(
        "m/s2", "inertial acceleration of the CG, body axes", axes="xyz", frame="b"
    )
    force = Output("N", "force on the craft, its body axes", axes="xyz", frame="b")
    moment = Output("N.m", "moment on the craft about its origin", axes="xyz", frame="b")
    contact_force = Output(
        "N",
        "of each foot, along the deck's normal: fore port and starboard, aft",
        axes=("fp", "fs", "ap", "as"),
    )
    load = Output("N", "on the deck along its normal: legs and wake")
    thrust = Output("N", "thrust of the rotors")
    torque = Output("N.m", "torque of each rotor on the body, clockwise positive", axes=ROTORS)
    power = Output("W", "electrical power of the motors")
    place = Output("m", "CG of the drone from the craft's origin, the craft's axes", axes="xyz")
    slip = Output("m/s", "velocity of the middle of the feet along the deck", axes="xy")
    legs_load = Output("N", "of all feet along the deck's normal")
    legs_down = Output("1", "how many feet press on the deck")

    terminals: ClassVar = {
        "motion": MOTION,
        "deck": terminal(
            position="deck_position",
            velocity="deck_velocity",
            attitude="deck_attitude",
            rates="deck_rates",
        ),
        "wrench": terminal("force", "moment"),
    }
    views: ClassVar = {"deck": {"attitude": "deck_attitude", "place": "pad", "size": "deck_size"}}
    exercised: ClassVar = {
        "position_start": [0.02, 0.01, -0.449],
        "command": [500.0, 520.0, 540.0, 560.0],
        "inflow": 1e-3,
        "wind": [2.0, -1.0, 0.3],
        "push": [0.5, -0.3, 0.2],
    }

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of the drone's states, and the forces on drone and deck."""
        own = rotation_matrix(p.attitude_start) @ _of_quaternion(x.turn)
        deck = rotation_matrix(u.deck_attitude)
        place = deck.T @ (x.position - u.deck_position)
        legs = Legs(SimpleNamespace(velocity=x.velocity_n, rates=x.rates), u, p, own, deck, place)
        air = own.T @ (x.velocity_n - u.wind)
        rotors = _Rotors(x, u, p, deck.T @ own, deck, place, air)
        height = ca.fmax(p.pad[2] - p.feet[2] - place[2], 0)
        over = inside(place, p.deck_size)
        wake = over * ca.exp(-((height / p.wake_length) ** 2)) * rotors.thrust
        pull = own @ (_drag(air, x, p, rotors.hover) + u.push - rotors.thrust * _DOWN)
        acceleration = p.gravity * _DOWN + (pull + deck @ legs.force) / p.mass
        momentum = p.inertia * x.rates + rotors.momentum * _DOWN
        turning = rotors.moment + legs.moment - ca.cross(x.rates, momentum)
        under = ca.vertcat(place[0], place[1], p.pad[2])
        return {
            "position": x.velocity_n,
            "velocity_n": acceleration,
            "turn": _quaternion_rate(x.turn, x.rates),
            "rates": turning / p.inertia,
            "rotor_speed": rotors.spin_up,
        }, {
            "attitude": _euler(own),
            "velocity": own.T @ x.velocity_n,
            "acceleration": own.T @ acceleration,
            "force": wake * _DOWN - legs.force,
            "moment": ca.cross(under, wake * _DOWN) - legs.on_deck,
            "contact_force": ca.vertcat(*legs.normals),
            "load": legs.total + wake,
            "thrust": rotors.thrust,
            "torque": rotors.torque,
            "power": ca.fmax(ca.dot(rotors.torques, x.rotor_speed), 0) / p.drive_efficiency,
            "place": place,
            "slip": legs.slip[:2],
            "legs_load": legs.total,
            "legs_down": sum(normal > 0 for normal in legs.normals),
        }


class _Rotors:
    """Loads of four rotors on the body: ``thrust``, N, and ``moment``, N.m.

    ``momentum``, N.m.s, is about its z; ``torques`` of each shaft, ``torque`` of each on the body,
    N.m; ``spin_up``, rad/s2.
    """

    def __init__(self, x: Any, u: Any, p: Any, over: Any, deck: Any, place: Any, air: Any) -> None:
        k_thrust = p.thrust_coefficient * p.density * p.rotor_diameter**4 / (4 * math.pi**2)
        k_torque = p.power_coefficient * p.density * p.rotor_diameter**5 / (8 * math.pi**3)
        self.hover = ca.sqrt(p.mass * p.gravity / (4 * k_thrust))
        limit = p.max_speed * ca.fmin(ca.fmax(u.supply_voltage / p.nominal_voltage, 0), 1)
        wanted = ca.fmin(ca.fmax(u.command, 0), limit)
        self.spin_up = (wanted - x.rotor_speed) / p.rotor_lag
        self.torques = k_torque * x.rotor_speed**2 + p.rotor_inertia * self.spin_up
        self.torque = ca.DM(SPINS) * self.torques
        self.momentum = -p.rotor_inertia * ca.dot(ca.DM(SPINS), x.rotor_speed)
        self.thrust, self.moment = 0, ca.sum1(self.torque) * _DOWN
        for i, (ahead, aside) in enumerate(PLACES):
            arm = ca.vertcat(ahead * p.hub[0], aside * p.hub[1], p.hub[2])
            speed = x.rotor_speed[i]
            climb = -(air + ca.cross(x.rates, arm))[2]
            gain = _ground_effect(place + over @ arm, p, deck)
            thrust = ca.fmax(k_thrust * speed**2 - p.inflow * speed * climb, 0) * gain
            self.thrust += thrust
            self.moment += ca.cross(arm, -thrust * _DOWN)


def _ground_effect(hub: Any, p: Any, deck: Any) -> Any:
    """Return G of a hub at ``hub`` in the deck's axes."""
    height = p.pad[2] - hub[2]
    near = p.rotor_diameter / (8 * ca.fmax(height, p.rotor_diameter / 4))
    acts = inside(hub, p.deck_size) * (height > 0) * (deck[2, 2] > 0)
    return 1 + acts * (1 / (1 - near**2) - 1)


def _drag(air: Any, x: Any, p: Any, hover: Any) -> Any:
    """Return the drag of body and rotors, N, body axes."""
    speed = ca.sqrt(ca.dot(air, air))
    share = ca.sum1(x.rotor_speed) / 4 / hover
    along = ca.vertcat(air[0], air[1], 0)
    return -0.5 * p.density * p.drag_area * speed * air - p.rotor_drag * share * along


def _of_quaternion(q: Any) -> Any:
    """Return R of a quaternion (w, x, y, z), of any length but 0."""
    w, x, y, z = ca.vertsplit(q / ca.sqrt(ca.dot(q, q)))
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def _quaternion_rate(q: Any, rates: Any) -> Any:
    """Return q' = q (0, w) / 2, with what brings its length back to 1."""
    w, v = q[0], q[1:]
    turning = ca.vertcat(-ca.dot(v, rates), w * rates + ca.cross(v, rates)) / 2
    return turning + (1 - ca.dot(q, q)) * q


def _euler(own: Any) -> Any:
    """Return (phi, theta, psi) of a rotation matrix, ZYX."""
    return ca.vertcat(
        ca.atan2(own[2, 1], own[2, 2]),
        ca.asin(ca.fmin(ca.fmax(-own[2, 0], -1), 1)),
        ca.atan2(own[1, 0], own[0, 0]),
    )
