"""Actuators that are commanded one by one: thrust, share or angle to what their driver takes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.links.servos import Servo, read_servos
from seatrial.links.unconnected import is_connected
from seatrial.physics.thrust_curve import command_of

from .ports import ANGLED, CHANNELS, SHARED, THRUSTERS, Ros2Ports


@dataclass(frozen=True)
class Actuator:
    """One actuator: the member of the terminal that drives it, and what its commands mean."""

    name: str
    member: str
    ways: tuple[str, ...]
    """Topics that it has: thrust, command, pos."""
    servo: Servo | None = None
    ahead: float = 0.0
    astern: float = 0.0
    exponent: float = 1.0
    travel: float = 0.0
    curve: tuple[float, ...] = ()

    @property
    def neutral(self) -> float:
        """The value at rest: of the pulse, s, the share or the angle."""
        return 0.0 if self.servo is None else 1e-6 * self.servo.pulse_neutral

    def value(self, way: str, command: float) -> float:
        """Return the pulse, s, share or angle, rad, of a command, held within its limits.

        thrust: share = +-(|T| / T_full) ^ exponent, or that of the curve. pos: about the z
        axis up, against the angles of here. The share of a pulse is that of its travel.
        """
        if way == "pos" and self.servo is None:
            return -command if self.member.startswith("a") else command
        share = command
        if way == "thrust" and any(self.curve):
            share = command_of(self.curve, command)
        elif way == "thrust":
            full = self.ahead if command > 0.0 else self.astern
            share = math.copysign((abs(command) / full) ** self.exponent, command) if full else 0.0
        elif way == "pos":
            share = -command / self.travel
        share = min(max(share, -1.0), 1.0)
        return share if self.servo is None else 1e-6 * _pulse(self.servo, share)


def _pulse(servo: Servo, share: float) -> float:
    share = -share if servo.reversed else share
    travel = (
        servo.pulse_max - servo.pulse_neutral
        if share > 0.0
        else servo.pulse_neutral - servo.pulse_min
    )
    return servo.pulse_neutral + share * travel


def actuators(link: Ros2Ports) -> list[Actuator]:
    """Return the actuators of the profile, then others that the vehicle's pilot commands."""
    shares = _connected(SHARED, link.piloted_share)
    pulses = _connected(CHANNELS, link.piloted_pulse)
    found = []
    for index, (channel, servo) in enumerate(sorted(read_servos(link.actuators).items())):
        numbers = _numbers(link, index)
        if servo.name in shares:
            found.append(_made(servo.name, servo.name, None, *numbers))
        elif f"ch{channel}" in pulses:
            found.append(_made(servo.name, f"ch{channel}", servo, *numbers))
    named = {each.name for each in found}
    others = [each for each in SHARED if each in shares and each not in named]
    start = len(found)
    found += [_made(m, m, None, *_numbers(link, start + i)) for i, m in enumerate(others)]
    angles = _connected(ANGLED, link.piloted_angle)
    return found + [Actuator(m, m, ("pos",)) for m in ANGLED if m in angles]


def _made(
    name: str,
    member: str,
    servo: Servo | None,
    ahead: float,
    astern: float,
    exponent: float,
    travel: float,
    curve: tuple[float, ...],
) -> Actuator:
    if ahead > 0.0:
        thrusts = ahead, astern or ahead, exponent
        return Actuator(name, member, ("command", "thrust"), servo, *thrusts, curve=curve)
    ways = ("command", "pos") if servo is not None and travel > 0.0 else ("command",)
    return Actuator(name, member, ways, servo, travel=travel)


def _numbers(link: Ros2Ports, index: int) -> tuple[float, float, float, float, tuple[float, ...]]:
    known = index < len(THRUSTERS)
    ahead = link.thrust_ahead[index] if known else 0.0
    astern = link.thrust_astern[index] if known else 0.0
    return ahead, astern, link.thrust_exponent, link.steering_travel, tuple(link.thrust_curve)


def _connected(names: Sequence[str], values: Sequence[float]) -> set[str]:
    return {name for name, value in zip(names, values, strict=True) if is_connected(value)}
