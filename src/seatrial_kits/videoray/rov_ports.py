"""The Pro 4 ROV component's parameters, inputs and outputs."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import (
    Input,
    Output,
    Parameter,
    Terminal,
    terminal,
)
from seatrial.model.unit_table import STANDARD_GRAVITY

from .drive import SLEW_UNITS, THRUSTERS
from .half_duplex import LineEnd
from .registers import GAINS, read_settings

_XYZ = ("x", "y", "z")


class Pro4RovPorts(LineEnd):
    """Parameters, inputs and outputs of `Pro4Rov`."""

    baud = Parameter(115_200.0, "1/s", "baud rate", min=300.0, max=1e7)
    turnaround = Parameter(0.0, "s", "from the end of a request to its answer", min=0.0, max=1.0)
    byte_timeout = Parameter(0.05, "s", "gap after which a frame is given up", min=1e-4)
    watchdog = Parameter(1.0, "s", "silence after which the thrusters stop, 0 for never", min=0.0)
    reboot_time = Parameter(2.0, "s", "time that a reboot takes", min=0.0)
    serial_number = Parameter("J14461", "1", "serial number, up to 16 characters")
    firmware = Parameter("2.6.6", "1", "version of its firmware")
    boards = Parameter(
        "Pro4CPU20 Pro4Power16C Pro4Pressure04 Pro4CamIO02 Pro4Cam01 Pro4LEDMain03 ThrustBL01 "
        "ThrustBLG01",
        "1",
        "revisions of its boards",
    )
    gains = Parameter("captured", "1", "named set of gains and slew rates", choices=tuple(GAINS))
    registers = Parameter(
        "", "1", "stored registers that differ: NAME VALUE; ...", check=read_settings
    )
    storing = Parameter(
        "at-once",
        "1",
        "when what is written outlives a reboot: at once, or when the commit register is written",
        choices=("at-once", "commit"),
    )
    loop_period = Parameter(0.1, "s", "period of its control", min=1e-3, max=10.0)
    slew_unit = Parameter("per-loop", "1", "what slew rates are per", choices=tuple(SLEW_UNITS))
    compensation = Parameter(
        "on", "1", "whether it jumps over the thrusters' dead band", choices=("on", "off")
    )
    vertical_ahead = Parameter(
        "up",
        "1",
        "where the vertical thruster pushes with a positive number",
        choices=("up", "down"),
    )
    motor_dead_band = Parameter(
        (0.38, 0.38, 0.4),
        "1",
        "duty up to which a motor does not turn",
        axes=THRUSTERS,
        min=0.0,
        max=0.99,
    )
    heading_range = Parameter(
        "full", "1", "headings: full, 0 to 360 degrees; half, -180 to 180", choices=("full", "half")
    )
    surface_pressure = Parameter(101_325.0, "Pa", "pressure at the surface", min=0.0)
    density = Parameter(1000.0, "kg/m3", "density of the water", min=0.0)
    gravity = Parameter(STANDARD_GRAVITY, "m/s2", "acceleration of gravity", min=0.0)
    depth_offset = Parameter(0.0, "m", "depth that its pressure sensor reads too much")

    rx = Input("1", "bytes received", type=str, role="bytes", optional=True)
    cut = Input("1", "whether the line is cut", type=bool, optional=True)
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    depth = Input("m", "depth, positive down")
    specific_force = Input(
        "m/s2",
        "specific force, body axes",
        axes=_XYZ,
        frame="b",
        start=(0.0, 0.0, -STANDARD_GRAVITY),
        optional=True,
    )
    rates = Input("rad/s", "angular velocity, body axes", axes=("p", "q", "r"), optional=True)
    magnetometer = Input("1", "raw readings", axes=_XYZ, optional=True)
    water_temperature = Input("K", "temperature of the water", start=284.25, optional=True)
    humidity = Input("1", "relative humidity inside", start=0.49, optional=True)
    tether_voltage = Input("V", "voltage at the vehicle", start=75.52, optional=True)
    tether_current = Input("A", "current that the vehicle takes", optional=True)
    bus_voltage = Input("V", "voltage of the 12 V supply", start=12.19, optional=True)
    bus_current = Input("A", "current of the 12 V supply", start=0.385, optional=True)

    tx = Output("1", "bytes sent", type=str, role="bytes")
    accessory_tx = Output("1", "requests that it passes on", type=str, role="bytes")
    command = Output(
        "1", "shares of full thrust, -1 to 1: ahead, vertical downwards", axes=THRUSTERS
    )
    duty = Output("1", "duties of the motors, as the firmware scales them", axes=THRUSTERS)
    lights = Output("1", "brightness, 0 to 1")
    camera_tilt = Output("rad", "of the camera, -pi/2 to pi/2", min=-math.pi / 2, max=math.pi / 2)
    camera_focus = Output("1", "-1 to 1")
    camera_select = Output("1", "whether the other camera is selected", type=bool)
    camera_buttons = Output("1", "bits: menu, up, down, left, right, menu off", type=int)
    manipulator = Output("1", "1 opens, -1 closes, 0 stands still", type=int)
    auto_depth = Output("1", "whether it holds its depth", type=bool)
    auto_heading = Output("1", "whether it holds its heading", type=bool)
    commanded = Output("1", "whether it has received commands lately", type=bool)
    node_id = Output("1", "its node id", type=int)
    requests = Output("1", "requests that it has carried out", type=int)
    communication_errors = Output("1", "wrong checksums and broken frames", type=int)

    terminals: ClassVar = {
        "serial": terminal(down="rx", up="tx"),
        "sensors": terminal(
            "depth",
            euler="attitude",
            heading="attitude__psi",
            heel="attitude__phi",
            pitch="attitude__theta",
            gyro="rates",
            accelerometer="specific_force",
        ),
        "actuators": Terminal({name: f"command.{name}" for name in THRUSTERS}),
    }
