"""True motion of a craft, for links that send it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import SimulationError
from ..model.component import Component, Input, Parameter, terminal
from ..physics.craft.kinematics import specific_force, to_ned
from .geodesy import Ned

MOTION = terminal(
    position="true_position",
    velocity="true_velocity",
    attitude="true_attitude",
    rates="true_rates",
    acceleration="true_acceleration",
)
"""Terminal of `TrueMotion`'s inputs."""

_LIMITS = {
    "position_n": (1e6, "m"),
    "velocity_n": (100.0, "m/s"),
    "attitude": (10.0, "rad"),
    "rates": (35.0, "rad/s"),
    "specific_force": (160.0, "m/s2"),
}
"""Beyond these no boat moves, and inertial units of 2000 deg/s and 16 g measure nothing."""
_TURNS = 1e6
"""Angles that count turns, rad: more no craft makes in a run."""


@dataclass(frozen=True)
class Truth:
    """True state of the simulated vehicle. SI, rad; velocity in {n}, the rest in {b}."""

    position_n: Ned
    velocity_n: Ned
    attitude: Ned
    rates: Ned
    specific_force: Ned


def require_possible(truth: Truth, whom: str) -> None:
    """Raise SimulationError for a motion that no craft has: ``whom``'s estimator would be upset."""
    for name, (limit, unit) in _LIMITS.items():
        for value in getattr(truth, name):
            if not abs(value) <= limit:
                what = name.removesuffix("_n").replace("_", " ")
                raise SimulationError(
                    f"the {what} is {value!r} {unit}, at most {limit:g} {unit} is sent to {whom}"
                )


class TrueMotion(Component):
    """Mix-in for what reads the true motion of a craft."""

    gravity = Parameter(9.81, "m/s2", "acceleration of gravity, in the truth", min=0.0)

    true_position = Input("m", "true position, north-east-down", axes="xyz", frame="n")
    true_velocity = Input("m/s", "true velocity, body axes", axes=("u", "v", "w"))
    true_attitude = Input("rad", "true Euler angles, ZYX", axes=("phi", "theta", "psi"))
    true_rates = Input("rad/s", "true angular velocity, body axes", axes=("p", "q", "r"))
    true_acceleration = Input(
        "m/s2", "true inertial acceleration, body axes", axes="xyz", frame="b"
    )

    def true_motion(self) -> Truth:
        """Return the inputs as what instruments without errors would measure."""
        phi, theta, psi = self.true_attitude
        attitude = _within_a_turn(phi), theta, _within_a_turn(psi)
        return Truth(
            self.true_position,
            to_ned(attitude, self.true_velocity),
            attitude,
            self.true_rates,
            specific_force(attitude, self.true_acceleration, self.gravity),
        )


def _within_a_turn(angle: float) -> float:
    """Return an angle within half a turn of 0: that of a craft that circles counts its turns."""
    return math.remainder(angle, math.tau) if abs(angle) <= _TURNS else angle
