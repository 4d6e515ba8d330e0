"""The ROS 2 component's parameters, inputs and outputs."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.links.parameter_validation import start_us
from seatrial.links.servos import read_servos
from seatrial.links.truth import MOTION, TrueMotion
from seatrial.links.unconnected import NOT_CONNECTED
from seatrial.links.vehicle_sensors import read_instruments
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
from seatrial.physics.thrust_curve import COEFFICIENTS

from .joining import TRANSPORTS
from .reach import HIGHEST_DOMAIN
from .topics import check_namespace, read_topics

CHANNELS = tuple(f"ch{number}" for number in range(1, 17))
SHARED = ("port", "starboard", "vertical", "engine", *(f"p{number}" for number in range(1, 9)))
"""Actuators commanded by shares of full thrust or speed, -1 to 1."""
ANGLED = ("rudder", "sail", "flap", *(f"a{number}" for number in range(1, 9)))
"""Actuators commanded by angles, rad."""
JOINTS = ("rudder", "sail", "flap")
MOTORS = tuple(f"m{number}" for number in range(1, 9))
THRUSTERS = tuple(f"t{number}" for number in range(1, 9))
UNITS = (
    *("gps", "mag", "gyro", "accel", "baro", "airspeed", "battery"),
    *(f"{unit}{number}" for unit in ("motor", "servo") for number in range(1, 9)),
)
"""Units whose faults the service ``inject_fault`` sets."""
_ORDERS = [name for name in ORDERED if name != "home" and not name.startswith("leg")]
_NED = ("north", "east", "down")
_MANUAL = ("surge", "sway", "yaw", "heave")


class Ros2Ports(Logging, Reachable, TrueMotion, Sampled):
    """Parameters, inputs and outputs of `Ros2`."""

    period = Parameter(0.01, "s", "sample period", min=1e-6)
    namespace = Parameter("vehicle", "1", "name before its topics", check=check_namespace)
    frame_prefix = Parameter(
        "", "1", "before odom, base_link and frames of sensors: of one of several vehicles"
    )
    domain = Parameter(
        -1.0, "1", "domain of ROS; -1: ROS_DOMAIN_ID, else 0", min=-1.0, max=float(HIGHEST_DOMAIN)
    )
    transport = Parameter(
        "auto",
        "1",
        "DDS itself, or a node of rclpy; auto: rclpy of a sourced workspace whose middleware is "
        "another than rmw_cyclonedds_cpp",
        choices=TRANSPORTS,
    )
    topics = Parameter(
        "", "1", "KEY TOPIC of topics with other names, or 'off'; with ;", check=read_topics
    )
    simulator = Parameter(
        "/seatrial", "1", "name before the services of simulation_interfaces; empty: none"
    )
    truth_period = Parameter(0.02, "s", "time between two odometries and transforms", min=1e-6)
    timeout = Parameter(
        0.5, "s", "simulated time for which a command is valid, but a goal", min=1e-3
    )
    lockstep = Parameter(
        "off",
        "1",
        "whether each step waits: for commands stamped with it, or one new one of each",
        choices=("off", "stamped", "counted"),
    )
    awaited = Parameter(
        "cmd_vel_stamped", "1", "lockstep: topics of commands waited for, separated by spaces"
    )
    wait_limit = Parameter(
        60.0, "s", "wall time to wait for a command in lockstep; 0: without end", min=0.0
    )
    thrust_ahead = Parameter(
        0.0, "N", "full thrust ahead, in the order of the profile's actuators; 0: none known",
        axes=THRUSTERS, min=0.0,
    )  # fmt: skip
    thrust_astern = Parameter(0.0, "N", "full thrust astern", axes=THRUSTERS, min=0.0)
    thrust_exponent = Parameter(
        1.0, "1", "of the share of full thrust in the command: 0.5 where thrust goes by its square",
        min=0.1, max=2.0,
    )  # fmt: skip
    thrust_curve = Parameter(
        0.0, "N", "thrust by odd powers of the command, in the exponent's place; 0: none",
        axes=COEFFICIENTS,
    )  # fmt: skip
    steering_travel = Parameter(
        0.0, "rad", "angle of actuators that steer at their greatest pulse; 0: none do", min=0.0
    )
    full_force = Parameter(
        0.0,
        "N",
        "force at full manual control: ahead, to starboard, down; 0: none",
        axes="xyz",
        min=0.0,
    )
    full_moment = Parameter(
        0.0, "N.m", "moment at full manual control, to starboard; 0: none", min=0.0
    )
    shape = Parameter("", "1", "the vehicle's shape, for its description: JSON", role="shape")
    verdicts = Parameter(
        "", "1", "how the trial's criteria stand: JSON", tunable=True, role="verdicts"
    )
    bag = Parameter("off", "1", "whether a bag of all it writes is kept", choices=("off", "on"))
    actuators = Parameter(
        "",
        "1",
        "CHANNEL NAME MIN NEUTRAL MAX of each output channel, pulses in us; with ;",
        check=read_servos,
    )
    instruments = Parameter(
        "", "1", "the vehicle's sensors, for rates and covariances: JSON", check=read_instruments
    )
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707964, max=1.5707964)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-math.pi, max=math.pi)
    altitude = Parameter(0.0, "m", "of the origin")
    date = Parameter(
        "2026-01-01",
        "1",
        "UTC at the start of the run, for the earth's field",
        check=start_us,
        role="start-time",
    )
    clock = Parameter(
        "run", "1", "where simulated time begins: at 0, or at the date", choices=("run", "date")
    )

    position_n = Input("m", "position, north-east-down", axes=_NED, start=NOT_CONNECTED)
    velocity_n = Input(
        "m/s", "velocity over ground, north-east-down", axes=_NED, start=NOT_CONNECTED
    )
    position_valid = Input("1", "whether position and velocity are valid", type=bool, start=True)
    heading = Input("rad", "heading, clockwise from north", start=NOT_CONNECTED)
    heading_valid = Input("1", "whether the heading is valid", type=bool, start=True)
    roll_pitch = Input("rad", "roll and pitch", axes=("phi", "theta"), start=NOT_CONNECTED)
    gyro = Input("rad/s", "angular velocity, body axes", axes="xyz", frame="b", start=NOT_CONNECTED)
    gyro_valid = Input("1", "whether the angular velocity is valid", type=bool, start=True)
    accelerometer = Input(
        "m/s2", "specific force, body axes", axes="xyz", frame="b", start=NOT_CONNECTED
    )
    imu_valid = Input("1", "whether force, roll and pitch are valid", type=bool, start=True)
    depth = Input("m", "depth, positive down", start=NOT_CONNECTED, optional=True)
    depth_valid = Input("1", "whether the depth is valid", type=bool, optional=True)
    velocity_b = Input(
        "m/s", "velocity over the bottom by a DVL, body axes", axes=("u", "v", "w"),
        start=NOT_CONNECTED, optional=True,
    )  # fmt: skip
    velocity_b_valid = Input("1", "whether the bottom is tracked", type=bool, optional=True)
    water_speed = Input("m/s", "speed ahead through the water", start=NOT_CONNECTED, optional=True)
    water_speed_valid = Input("1", "whether it is valid", type=bool, optional=True)
    water_depth = Input("m", "water below a transducer", start=NOT_CONNECTED, optional=True)
    water_depth_valid = Input("1", "whether there is an echo", type=bool, optional=True)
    sonar_distance = Input(
        "m", "range of a scanning sonar's first echo", start=NOT_CONNECTED, optional=True
    )
    sonar_distance_valid = Input("1", "whether there is an echo", type=bool, optional=True)
    sonar_angle = Input("rad", "where it looks, from the bow to starboard", optional=True)
    wind_speed = Input("m/s", "speed of the apparent wind", start=NOT_CONNECTED, optional=True)
    wind_angle = Input(
        "rad", "where the apparent wind blows to from the bow, to starboard", optional=True
    )
    wind_valid = Input("1", "whether the wind is measured", type=bool, optional=True)
    leaking = Input("1", "1 where there is water, else 0", start=NOT_CONNECTED, optional=True)
    water_temperature = Input("K", "temperature of the water", start=NOT_CONNECTED, optional=True)
    joint = Input("rad", "angles of servos", axes=JOINTS, start=NOT_CONNECTED, optional=True)
    motor_speed = Input("rad/s", "shaft speeds", axes=MOTORS, start=NOT_CONNECTED, optional=True)
    voltage = Input("V", "voltage of the battery", start=NOT_CONNECTED, optional=True)
    current = Input("A", "current out of the battery", start=NOT_CONNECTED, optional=True)
    charge = Input("1", "share of the charge that is left", start=NOT_CONNECTED, optional=True)
    leg = Input("1", "number of the course's leg, 0 for none", type=int, optional=True)
    leg_from = Input("m", "where the leg begins", axes=_NED, optional=True)
    leg_to = Input("m", "where the leg ends", axes=_NED, optional=True)
    leg_radius = Input("m", "distance at which its end is reached", optional=True)
    ais = Input("1", "VDM and VDO sentences, as text", type=str, role="bytes", optional=True)
    piloted_pulse = Input(
        "s", "pulses of the vehicle's pilot", axes=CHANNELS, start=NOT_CONNECTED, optional=True
    )
    piloted_share = Input(
        "1", "shares of the vehicle's pilot", axes=SHARED, start=NOT_CONNECTED, optional=True
    )
    piloted_angle = Input(
        "rad", "angles of the vehicle's pilot", axes=ANGLED, start=NOT_CONNECTED, optional=True
    )

    pulse = Output("s", "pulses, the pilot's or as commanded", axes=CHANNELS)
    share = Output("1", "shares, the pilot's or as commanded", axes=SHARED)
    angle = Output("rad", "angles, the pilot's or as commanded", axes=ANGLED)
    source = Output(
        "1", "what commands: none, thrusters, cmd_vel, cmd_wrench or goal_pose", type=str,
        start="none", role="arrivals",
    )  # fmt: skip
    mode = Output("1", "mode of the pilot: hold, manual or guided", type=str, start="hold")
    armed = Output("1", "whether the pilot acts", type=bool)
    manual = Output("1", "manual control, -1 to 1", axes=_MANUAL)
    target_kind = Output("1", "position, heading or body", type=str, start="position")
    target_valid = Output("1", "whether there is a set-point", type=bool)
    target_position = Output("m", "position to go to; its down with a heading", axes=_NED)
    target_velocity = Output("m/s", "velocity over ground", axes=_NED)
    target_heading = Output("rad", "heading, clockwise from north")
    target_speed = Output("m/s", "speed along the bow")
    target_sway = Output("m/s", "speed to starboard, of a pilot that has sway")
    leg_reached = Output("1", "number of the leg whose end is reached, 0 while none is", type=int)
    failure = Output("1", "fault of each unit, none without", axes=UNITS, type=str, start="none")
    order = Output("1", "simulated time and text of the last order", type=str, role="order")
    paused = Output("s", "wall time that a node paused it")
    refused = Output("1", "messages that were refused", type=int)
    late = Output("1", "commands that were older than their time-out", type=int)

    terminals: ClassVar = {
        "sensors": terminal(
            "position_n", "velocity_n", "position_valid", "heading", "heading_valid",
            "roll_pitch", "gyro", "gyro_valid", "accelerometer", "imu_valid",
            "depth", "depth_valid", "velocity_b", "velocity_b_valid",
            "water_speed", "water_speed_valid", "water_depth", "water_depth_valid",
            "wind_speed", "wind_angle", "wind_valid", "leaking", "water_temperature",
            heel="roll_pitch__phi",
            pitch="roll_pitch__theta",
            rudder="joint__rudder",
            sail="joint__sail",
            flap="joint__flap",
        ),
        "motion": MOTION,
        "orders": terminal(*_ORDERS, "target_sway"),
        "course": terminal("leg", "leg_from", "leg_to", "leg_radius", "leg_reached"),
        "piloted": Terminal(
            {each: f"piloted_pulse.{each}" for each in CHANNELS}
            | {each: f"piloted_share.{each}" for each in SHARED}
            | {each: f"piloted_angle.{each}" for each in ANGLED}
        ),
        "actuators": Terminal(
            {each: f"pulse.{each}" for each in CHANNELS}
            | {each: f"share.{each}" for each in SHARED}
            | {each: f"angle.{each}" for each in ANGLED}
        ),
        "battery": terminal("voltage", "current", "charge"),
        "motors": Terminal({f"speed{n}": f"motor_speed.{m}" for n, m in enumerate(MOTORS, 1)}),
        "failures": Terminal({unit: f"failure.{unit}" for unit in UNITS}),
    }  # fmt: skip
