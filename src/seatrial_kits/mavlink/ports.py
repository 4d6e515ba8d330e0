"""The MAVLink component's parameters, inputs and outputs."""

from __future__ import annotations

from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.endpoints.url import check_urls
from seatrial.links.parameter_validation import start_date
from seatrial.links.truth import MOTION, TrueMotion
from seatrial.links.unconnected import NOT_CONNECTED
from seatrial.model.component import (
    Input,
    Logging,
    Output,
    Parameter,
    Reachable,
    Terminal,
    terminal,
)
from seatrial.model.sampled import Sampled
from seatrial.model.terminals import ORDERED

from .outputs import SHARED
from .parameters.simulation import FASTEST, SLOWEST
from .parameters.tunable import MOST_TUNABLES, tunable_parameters
from .services.failsafe import ACTIONS
from .services.failures import UNITS, failing_units
from .settings import LIMITS
from .vehicle import CHANNELS, FIXES

VEHICLE_TYPES = {
    "ground_rover": mavlink.MAV_TYPE_GROUND_ROVER,
    "surface_boat": mavlink.MAV_TYPE_SURFACE_BOAT,
    "submarine": mavlink.MAV_TYPE_SUBMARINE,
}

_NED = ("north", "east", "down")
NAMED_VALUES = 8
"""Values of `named`."""

START_MODES = ("hold", "loiter", "auto", "return")
"""Modes in which it may start: those that need neither set-point nor manual control."""

_MANUAL = ("surge", "sway", "yaw", "heave")
_CHANNELS = tuple(f"ch{number}" for number in range(1, CHANNELS + 1))
MOTORS = ("m1", "m2", "m3", "m4")
_NAMED = tuple(f"n{number}" for number in range(1, NAMED_VALUES + 1))


def _limited(start: float, unit: str, description: str, setting: str) -> Parameter:
    """Return the parameter of a setting, within its limits."""
    low, high = LIMITS[setting]
    return Parameter(start, unit, description, min=low, max=high)


class MavlinkPorts(Logging, Reachable, TrueMotion, Sampled):
    """Parameters, inputs and outputs of `Mavlink`."""

    period = Parameter(0.01, "s", "sample period", min=1e-6)
    links = Parameter(
        "udpout:127.0.0.1:14550", "1", "URLs of the links, separated by spaces", check=check_urls
    )
    system_id = Parameter(1.0, "1", "MAVLink system", min=1.0, max=255.0)
    component_id = Parameter(1.0, "1", "MAVLink component", min=1.0, max=255.0)
    vehicle_type = Parameter(
        "surface_boat", "1", "MAV_TYPE, in lower case", choices=tuple(VEHICLE_TYPES)
    )
    autopilot_type = Parameter(
        "ardupilotmega", "1", "MAV_AUTOPILOT, in lower case", choices=("ardupilotmega", "px4")
    )
    firmware_version = Parameter(
        "0.1.0-dev", "1", "its own version, reported beside that of the firmware it acts as"
    )
    uid = Parameter("1", "1", "serial number that it reports, a whole number up to 2^64 - 1")
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707964, max=1.5707964)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-3.1415927, max=3.1415927)
    altitude = Parameter(0.0, "m", "of the origin")
    date = start_date()
    mode_start = Parameter("hold", "1", "mode at the start", choices=START_MODES)
    armed_start = Parameter("off", "1", "whether it is armed at the start", choices=("off", "on"))
    failsafe = Parameter("hold", "1", "what it does when left alone", choices=ACTIONS)
    station_timeout = _limited(
        5.0, "s", "silence after which a ground station is lost", "station_timeout"
    )
    manual_timeout = _limited(3.0, "s", "time for which manual control is valid", "manual_timeout")
    target_timeout = _limited(3.0, "s", "time for which a set-point is valid", "target_timeout")
    full_speed = _limited(1.0, "m/s", "speed of full thrust in an attitude set-point", "full_speed")
    truth = Parameter("off", "1", "whether the truth is sent", choices=("off", "on"))
    waypoint_radius = _limited(
        3.0, "m", "distance at which a waypoint is reached", "waypoint_radius"
    )
    cruise_speed = _limited(1.0, "m/s", "speed of legs that name none", "cruise_speed")
    loiter_radius = _limited(10.0, "m", "radius of turns that name none", "loiter_radius")
    fence_action = Parameter("hold", "1", "what it does outside its fence", choices=ACTIONS)
    fence_depth = _limited(0.0, "m", "depth of the fence's floor, 0 for none", "fence_depth")
    battery_capacity = Parameter(0.0, "A.s", "charge of a full battery, 0 if unknown", min=0.0)
    battery_low_voltage = _limited(
        0.0, "V", "voltage of a low battery, 0 for none", "battery_low_voltage"
    )
    battery_low_charge = _limited(
        0.0, "1", "share of the charge of a low battery, 0 for none", "battery_low_charge"
    )
    battery_action = Parameter("none", "1", "what it does with a low battery", choices=ACTIONS)
    gnss_fix = Parameter("3d", "1", "fix of the receiver with a position", choices=tuple(FIXES))
    gnss_satellites = Parameter(12.0, "1", "satellites of that fix", min=0.0, max=254.0)
    gnss_hdop = Parameter(1.0, "1", "horizontal dilution of precision of that fix", min=0.0)
    plan_folder = Parameter(
        "", "1", "folder of mission, fence and rally points; empty: they end with the run"
    )
    actuators = Parameter(
        "", "1", "CHANNEL NAME MIN NEUTRAL MAX of each output channel, pulses in us; with ;"
    )
    tunables = Parameter(
        "",
        "1",
        "NAME START LOW HIGH of each tunable parameter; with ;",
        check=tunable_parameters,
        role="tunables",
    )
    parameter_file = Parameter("", "1", "file of the parameters that were set; empty: none")
    speedup_start = Parameter(
        1.0, "1", "simulated time per wall time until it is set", min=SLOWEST, max=FASTEST
    )
    failures = Parameter(
        "", "1", "units whose failures are connected, separated by spaces", check=failing_units
    )
    names = Parameter("", "1", "names of the first values of `named`, separated by spaces")
    signing_key_file = Parameter("", "1", "file with the pass phrase; empty: no signatures")
    state_file = Parameter("", "1", "file for what outlives the run; empty: none")

    position_n = Input("m", "position, north-east-down", axes=_NED, start=NOT_CONNECTED)
    velocity_n = Input(
        "m/s", "velocity over ground, north-east-down", axes=_NED, start=NOT_CONNECTED
    )
    position_valid = Input("1", "whether position and velocity are valid", type=bool)
    heading = Input("rad", "heading, clockwise from north", start=NOT_CONNECTED)
    heading_valid = Input("1", "whether the heading is valid", type=bool, start=True)
    roll_pitch = Input(
        "rad",
        "roll and pitch, starboard side down, bow up",
        axes=("phi", "theta"),
        start=NOT_CONNECTED,
    )
    gyro = Input("rad/s", "angular velocity, body axes", axes="xyz", frame="b", start=NOT_CONNECTED)
    gyro_valid = Input(
        "1", "whether the angular velocity is valid", type=bool, start=True, optional=True
    )
    accelerometer = Input(
        "m/s2", "specific force, body axes", axes="xyz", frame="b", start=NOT_CONNECTED
    )
    imu_valid = Input(
        "1",
        "whether specific force, roll and pitch are valid",
        type=bool,
        start=True,
        optional=True,
    )
    depth = Input("m", "depth of a submarine, positive down", start=NOT_CONNECTED, optional=True)
    depth_valid = Input("1", "whether the depth is measured", type=bool, optional=True)
    ground_distance = Input(
        "m", "distance to the ground below, 0 if it is not measured", optional=True
    )
    wind_speed = Input("m/s", "speed of the apparent wind", optional=True)
    wind_angle = Input(
        "rad", "where the apparent wind blows to from the bow, to starboard", optional=True
    )
    wind_valid = Input("1", "whether the wind is measured", type=bool, optional=True)
    voltage = Input("V", "voltage of the battery, 0 if it is not measured", optional=True)
    current = Input("A", "current out of the battery", start=NOT_CONNECTED, optional=True)
    charge = Input(
        "1", "share of the battery's charge that is left", start=NOT_CONNECTED, optional=True
    )
    motor_speed = Input("rad/s", "shaft speeds of motors", axes=MOTORS, optional=True)
    motor_current = Input("A", "currents of motors", axes=MOTORS, optional=True)
    pulse = Input("s", "servo pulses, 0 for none", axes=_CHANNELS, optional=True)
    share = Input(
        "1",
        "commands of thrusters as shares of full thrust, in the place of pulses",
        axes=SHARED,
        optional=True,
    )
    named = Input("1", "values that `names` names, in any unit", axes=_NAMED, optional=True)
    nav_state = Input("1", "guidance: 2 stays, 3 follows a leg, 4 steers, else less", type=int)
    nav_heading = Input("rad", "guidance: heading wanted, clockwise from north")
    nav_speed = Input(
        "m/s",
        "guidance: speed wanted over ground along the bow, below 0 for none",
        start=-1.0,
        optional=True,
    )
    nav_depth = Input("m", "guidance: depth wanted, positive down", optional=True)
    nav_cross_track = Input("m", "guidance: cross-track error, positive to starboard of the leg")
    nav_distance = Input("m", "guidance: horizontal distance to where it goes")
    leg_reached = Input("1", "number of the leg that is done, 0 while none is", type=int)

    mode = Output("1", "manual, hold, loiter, guided, auto, return, ...", type=str, start="hold")
    armed = Output("1", "whether to act", type=bool)
    manual = Output(
        "1", "manual control, -1 to 1: ahead, to starboard, turn to starboard, down", axes=_MANUAL
    )
    target_kind = Output("1", "position, velocity or heading", type=str, start="position")
    target_valid = Output("1", "whether there is a set-point", type=bool)
    target_position = Output("m", "position to go to; its down with a heading", axes=_NED)
    target_velocity = Output("m/s", "velocity over ground", axes=_NED)
    target_heading = Output("rad", "heading, clockwise from north")
    target_speed = Output(
        "m/s", "speed along the bow with a heading; to a position, 0 if not given"
    )
    home = Output("m", "position to return to: home, or a rally point", axes=_NED)
    leg = Output("1", "number of the mission's leg, another for each; 0 for none", type=int)
    leg_from = Output("m", "where the leg begins", axes=_NED)
    leg_to = Output("m", "where the leg ends", axes=_NED)
    leg_speed = Output("m/s", "speed on the leg")
    leg_radius = Output("m", "distance at which its end is reached")
    leg_wait = Output("s", "time to stay at its end")
    leg_circle = Output("m", "radius of the circle to stay on at its end, 0 for none")
    failsafe_active = Output("1", "whether a failsafe acted and still lasts", type=bool)
    tunable = Output(
        "1",
        "the tunable parameters, in any unit",
        axes=tuple(f"t{n}" for n in range(1, MOST_TUNABLES + 1)),
        role="tunable",
    )
    failure = Output("1", "failure of each unit, none without", axes=UNITS, type=str, start="none")
    order = Output(
        "1", "simulated time and text of the last order of a station", type=str, role="order"
    )
    speedup = Output("1", "simulated time per wall time that is wanted", start=1.0)
    paused = Output("s", "wall time that it stood still")
    frames_refused = Output("1", "frames received that are no message, or not signed", type=int)
    ground_stations = Output("1", "number of ground stations that are there", type=int)

    terminals: ClassVar = {
        "sensors": terminal(
            "position_n",
            "velocity_n",
            "position_valid",
            "heading",
            "heading_valid",
            "roll_pitch",
            "gyro",
            "gyro_valid",
            "accelerometer",
            "imu_valid",
            "wind_speed",
            "wind_angle",
            "wind_valid",
            "depth",
            "depth_valid",
            heel="roll_pitch__phi",
            pitch="roll_pitch__theta",
        ),
        "motion": MOTION,
        "orders": terminal(
            *ORDERED,
            "leg_reached",
            "nav_state",
            "nav_heading",
            "nav_speed",
            "nav_depth",
            "nav_cross_track",
            "nav_distance",
        ),
        "deflections": Terminal({"armed": "armed", **{axis: f"manual.{axis}" for axis in _MANUAL}}),
        "pulses": Terminal(
            {channel: f"pulse.{channel}" for channel in _CHANNELS}
            | {name: f"share.{name}" for name in SHARED}
        ),
        "battery": terminal("voltage", "current", "charge"),
        "motors": Terminal(
            {f"speed{n}": f"motor_speed.{motor}" for n, motor in enumerate(MOTORS, 1)}
            | {f"current{n}": f"motor_current.{motor}" for n, motor in enumerate(MOTORS, 1)}
        ),
        "failures": Terminal({unit: f"failure.{unit}" for unit in UNITS}),
    }
