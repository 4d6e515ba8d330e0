"""Terminals: named groups of a component's ports that are connected together, by member.

The words, so that components of different makers meet:

============  ==================================================================================
motion        truth of a craft: position, velocity, attitude, rates, acceleration
water         velocity of a craft through the water: nu_r
wrench        force, moment (N and N.m, body axes, at the body origin)
attachment    point, velocity, force: of a tether or a tow, all in {n}
reading       of a sensor: position_n, velocity_n, position_valid; heading, heading_valid; heel,
              pitch, roll_pitch, roll_rate, yaw_rate, gyro, gyro_valid, accelerometer, imu_valid;
              wind_speed, wind_angle, wind_valid; depth, depth_valid, of the vehicle; water_depth,
              water_depth_valid, below a transducer; water_speed, water_speed_valid; pressure;
              rudder
sensors       the same members, of who reads them
truth         members of motion, of who reads them
actuators     pulses by channel, ch1 ... ch16; or by name, angles and shares
failures      faults of sensors and actuators by name: gps, mag, gyro, motor1, ...
orders        what commands a pilot: mode, armed, manual, targets, home, legs; and what it answers
deflections   manual control: surge, sway, yaw, heave, -1 to 1, and armed
wanted        within a pilot: engaged, direct, speed_engaged, heading_engaged, sail_engaged,
              direct_yaw, direct_sheet, speed, speed_wanted, heading_wanted, yaw_rate_wanted,
              depth_wanted
held          what an autopilot asks: surge, sway, yaw_moment, heave, pitch_moment, rudder
demand        what is asked of an allocation: surge, sway, heave, roll_moment, pitch_moment,
              yaw_moment
propulsor_*   of a craft with parts: propulsor_orders and propulsor_angles, p1 ... p8
foil_angles   the same of its foils, f1 ... f8
estimate      nu, wind
serial        down (towards the vehicle), up
bus           tx, rx: of a node, and n1 ... n12 of a CAN bus
============  ==================================================================================
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Rule = Literal["plug", "bus"]
"""FMI 3.0's matching rules: of a plug all inputs must be met, of a bus any may stay open."""


@dataclass(frozen=True)
class Terminal:
    """A group of ports: by the name of a member, the port, scalar or sum of the component."""

    members: Mapping[str, str] = field(default_factory=dict)
    rule: Rule = "bus"


def terminal(*same: str, rule: Rule = "bus", **others: str) -> Terminal:
    """Return a terminal: members named as their ports, then member = port (or port__axis).

    A scalar of a port is written ``port__axis``, ``roll_pitch__phi``.
    """
    named = {name: name for name in same}
    return Terminal({**named, **{m: p.replace("__", ".") for m, p in others.items()}}, rule)


ORDERED = (
    "mode",
    "armed",
    "manual",
    "home",
    "target_kind",
    "target_valid",
    "target_position",
    "target_velocity",
    "target_heading",
    "target_speed",
    "leg",
    "leg_from",
    "leg_to",
    "leg_speed",
    "leg_radius",
    "leg_wait",
    "leg_circle",
)
"""Members of ``orders`` from whoever commands; a pilot answers ``leg_reached`` and others."""

MOTION = terminal("position", "velocity", "attitude", "rates", "acceleration")
"""Outputs of every craft under the name ``motion``."""

ATTACHMENT = terminal(
    point="attachment_point", velocity="attachment_velocity", force="attachment_force"
)
"""Attachment of a tether or a tow to any craft: point and velocity out, force in."""
