"""Parameters of ArduPilot's Rover and Sub that ground stations look for."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.servos import Servo

from ..settings import Settings
from ..vehicle import Identity
from .definition import INT8, INT16, INT32, REAL32, Definition, choice, fixed, real, whole
from .joystick import joystick_parameters
from .listed import ardupilot_listed

# What the failsafe's numbers mean here. Those that prefer the way it came mean what ArduPilot
# does if there is none.
_ROVER_ACTIONS = {
    0: "none",
    1: "return",
    2: "hold",
    5: "disarm",
    6: "loiter",
    3: "return",
    4: "hold",
}
_SUB_ACTIONS = {1: "none", 0: "none", 2: "disarm", 3: "hold", 4: "surface", 5: "loiter"}
_SUB_FENCE_ACTIONS = {0: "none", 1: "surface", 2: "hold", 3: "disarm", 4: "loiter"}
_SUB_BATTERY_ACTIONS = {0: "none", 2: "disarm", 3: "surface"}
_SUB_PILOT_ACTIONS = {3: "", 0: "off", 1: "none", 2: "disarm"}
_SWITCH = {0: False, 1: True}

_MANUAL_AXES = "the channels of manual control are always the same"
_NO_SWITCH = "no channel chooses modes"

_FUNCTIONS = {"rudder": 26, "throttle": 70, "port": 73, "starboard": 74, "sail": 89, "flap": 128}
"""SERVOn_FUNCTION of a boat's actuator, by its name."""
_NO_FUNCTION, _FIRST_MOTOR = 0, 33
_LISTED_CHANNELS = 8
"""Channels that are listed even if nothing is connected."""


def ardupilot_parameters(
    identity: Identity, settings: Settings, servos: Mapping[int, Servo]
) -> list[Definition]:
    """Return the parameters of a boat (Rover) or a submarine (Sub); ``servos`` by channel.

    Those that lead to ``settings`` start with its values. The others have what the trial's files
    made of the vehicle, and cannot be set. Raises InputError for a setting that ArduPilot has no
    number for.
    """
    submerged = identity.submerged
    channels = range(1, max([_LISTED_CHANNELS, *servos]) + 1)
    return [
        fixed("SYSID_THISMAV", INT16, identity.system),
        whole("SYSID_MYGCS", "pilot_system", settings, 1, 255),
        _frame(identity, len(servos)),
        *(_sub(settings) if submerged else _rover(settings)),
        whole("ARMING_CHECK", "arming_check", settings, 0, (1 << 20) - 1),
        fixed("ARMING_REQUIRE", INT8, 1),
        *_battery(submerged, settings),
        fixed("MODE_CH", INT8, 0, _NO_SWITCH),
        *(fixed(f"MODE{n}", INT8, 0, _NO_SWITCH) for n in range(1, 7)),
        *_manual_control(submerged),
        *(one for n in channels for one in _servo(n, servos, submerged)),
        *ardupilot_listed(submerged=submerged),
    ]


def _frame(identity: Identity, motors: int) -> Definition:
    if not identity.submerged:
        boat = identity.vehicle_type == mavlink.MAV_TYPE_SURFACE_BOAT
        return fixed("FRAME_CLASS", INT8, 2 if boat else 1)
    # Sub's simple frames have 3 to 5 motors, its vectored ones 6 and 8; else it is a custom one.
    frames = {3: 4, 4: 5, 5: 6, 6: 1, 8: 2}
    return fixed("FRAME_CONFIG", INT8, frames.get(motors, 7))


def _battery(submerged: bool, settings: Settings) -> list[Definition]:
    actions = _SUB_BATTERY_ACTIONS if submerged else _ROVER_ACTIONS
    capacity = settings.battery_capacity / 3.6  # mA.h
    return [
        fixed("BATT_MONITOR", INT8, 4),
        fixed("BATT_CAPACITY", INT32, round(capacity)),
        real("BATT_LOW_VOLT", "battery_low_voltage", settings),
        choice("BATT_FS_LOW_ACT", "battery_action", settings, actions),
        *_low_charge(settings, capacity),
    ]


def _low_charge(settings: Settings, capacity: float) -> list[Definition]:
    """Return BATT_LOW_MAH: a share of the capacity, if that is known."""
    if not capacity:
        return [fixed("BATT_LOW_MAH", REAL32, 0.0, "the battery's capacity is not known")]

    def apply(settings: Settings, value: float) -> None:
        settings.battery_low_charge = value / capacity

    low = settings.battery_low_charge * capacity
    return [Definition("BATT_LOW_MAH", REAL32, low, 0.0, capacity, apply=apply)]


def _rover(settings: Settings) -> list[Definition]:
    return [
        real("CRUISE_SPEED", "cruise_speed", settings),
        real("WP_SPEED", "waypoint_speed", settings),
        real("WP_RADIUS", "waypoint_radius", settings),
        choice("FS_ACTION", "failsafe", settings, _ROVER_ACTIONS),
        real("FS_TIMEOUT", "manual_timeout", settings),
        choice("FS_THR_ENABLE", "watches_manual_control", settings, _SWITCH),
        choice("FS_GCS_ENABLE", "watches_stations", settings, _SWITCH),
        real("FS_GCS_TIMEOUT", "station_timeout", settings),
        real("GUID_TIMEOUT", "target_timeout", settings),
        real("CIRC_RADIUS", "loiter_radius", settings),
        choice("FENCE_ACTION", "fence_action", settings, _ROVER_ACTIONS),
    ]


def _sub(settings: Settings) -> list[Definition]:
    return [
        real("WPNAV_SPEED", "waypoint_speed", settings, scale=0.01),
        real("WPNAV_RADIUS", "waypoint_radius", settings, scale=0.01),
        choice("FS_GCS_ENABLE", "failsafe", settings, _SUB_ACTIONS),
        real("FS_GCS_TIMEOUT", "station_timeout", settings),
        real("FS_PILOT_TIMEOUT", "manual_timeout", settings),
        choice("FS_PILOT_INPUT", "manual_failsafe", settings, _SUB_PILOT_ACTIONS),
        real("CIRCLE_RADIUS", "loiter_radius", settings, scale=0.01),
        choice("FENCE_ACTION", "fence_action", settings, _SUB_FENCE_ACTIONS),
        real("FENCE_DEPTH_MAX", "fence_depth", settings),
        *joystick_parameters(settings),
    ]


def _manual_control(submerged: bool) -> list[Definition]:
    axes = {"ROLL": 1, "PITCH": 2, "THROTTLE": 3, "YAW": 4}
    if submerged:
        axes |= {"FORWARD": 5, "LATERAL": 6}
    # Those of 1100, 1500 and 1900 exactly are of a radio that was never calibrated.
    pulses = {"MIN": 1099, "TRIM": 1500, "MAX": 1901, "REVERSED": 0}
    return [
        *(fixed(f"RCMAP_{axis}", INT8, channel, _MANUAL_AXES) for axis, channel in axes.items()),
        *(
            fixed(f"RC{n}_{what}", INT16, value, _MANUAL_AXES)
            for n in range(1, _LISTED_CHANNELS + 1)
            for what, value in pulses.items()
        ),
    ]


def _servo(channel: int, servos: Mapping[int, Servo], submerged: bool) -> list[Definition]:
    servo = servos.get(channel, Servo("", 1100.0, 1500.0, 1900.0, False))
    function = _FUNCTIONS.get(servo.name, _NO_FUNCTION)
    if submerged and servo.name:
        function = _FIRST_MOTOR + sorted(servos).index(channel)
    values = {
        "FUNCTION": function,
        "MIN": round(servo.pulse_min),
        "TRIM": round(servo.pulse_neutral),
        "MAX": round(servo.pulse_max),
        "REVERSED": int(servo.reversed),
    }
    return [fixed(f"SERVO{channel}_{what}", INT16, value) for what, value in values.items()]
