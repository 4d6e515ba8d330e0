"""The Pro 4 topside component's parameters, inputs and outputs."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.unit_table import STANDARD_GRAVITY

from .half_duplex import LineEnd

_XYZ = ("x", "y", "z")


class Pro4TopsidePorts(LineEnd):
    """Parameters, inputs and outputs of `Pro4Topside`."""

    period = Parameter(0.1, "s", "period of the command block", min=1e-3)
    node_id = Parameter(1.0, "1", "node id of the vehicle", min=1.0, max=127.0)
    baud = Parameter(115_200.0, "1/s", "baud rate", min=300.0, max=1e7)
    byte_timeout = Parameter(0.05, "s", "gap after which a frame is given up", min=1e-4)
    timeout = Parameter(1.0, "s", "silence after which the vehicle is lost", min=0.0)
    manual_limit = Parameter(1.0, "1", "thrust at full deflection", min=0.0, max=1.0)
    vertical_ahead = Parameter(
        "up",
        "1",
        "where the vertical thruster pushes with a positive number",
        choices=("up", "down"),
    )
    surface_pressure = Parameter(101_325.0, "Pa", "pressure at the surface", min=0.0)
    density = Parameter(1000.0, "kg/m3", "density of the water", min=1e-3)
    gravity = Parameter(STANDARD_GRAVITY, "m/s2", "acceleration of gravity", min=1e-3)
    nmea = Parameter("off", "1", "whether it sends NMEA sentences", choices=("off", "on"))

    rx = Input("1", "bytes received", type=str, role="bytes", optional=True)
    armed = Input("1", "whether manual control and holds apply", type=bool, optional=True)
    manual = Input(
        "1",
        "-1 to 1: ahead, turn to starboard, down",
        axes=("surge", "yaw", "heave"),
        optional=True,
    )
    lights = Input("1", "brightness, 0 to 1", optional=True)
    camera_tilt = Input("rad", "of the camera", optional=True)
    camera_focus = Input("1", "-1 to 1", optional=True)
    camera_select = Input("1", "whether the other camera is wanted", type=bool, optional=True)
    camera_buttons = Input(
        "1", "bits: menu, up, down, left, right, menu off", type=int, optional=True
    )
    manipulator = Input("1", "1 opens, -1 closes, 0 stands still", type=int, optional=True)
    hold_depth = Input("1", "whether the vehicle is to hold its depth", type=bool, optional=True)
    depth_wanted = Input("m", "depth to hold, positive down", optional=True)
    hold_heading = Input(
        "1", "whether the vehicle is to hold its heading", type=bool, optional=True
    )
    heading_wanted = Input("rad", "heading to hold, clockwise from north", optional=True)

    tx = Output("1", "bytes sent", type=str, role="bytes")
    nmea_tx = Output("1", "NMEA sentences", type=str, role="bytes")
    connected = Output("1", "whether a vehicle answers, and is driven", type=bool)
    phase = Output("1", "detect, configure, read or drive", type=str, start="detect")
    serial_number = Output("1", "of the vehicle", type=str)
    attitude = Output(
        "rad",
        "Euler angles, ZYX; psi from 0 to 2 pi",
        axes=("phi", "theta", "psi"),
        min=-math.pi,
        max=math.tau,
    )
    depth = Output("m", "depth, positive down")
    specific_force = Output("m/s2", "specific force, body axes", axes=_XYZ, frame="b")
    magnetometer = Output("1", "raw readings", axes=_XYZ)
    water_temperature = Output("K", "temperature of the water", start=273.15)
    humidity = Output("1", "relative humidity inside the vehicle")
    power = Output("1", "power that the vehicle allows its thrusters, 0 to 1")
    cycles = Output("1", "requests sent", type=int)
    missed = Output("1", "cycles without an answer before the next", type=int)
    round_trip = Output("s", "from a request's first byte to the end of its answer")
    errors = Output("1", "wrong checksums and broken frames", type=int)

    terminals: ClassVar = {
        "serial": terminal(down="tx", up="rx"),
        "deflections": terminal(
            "armed", surge="manual__surge", yaw="manual__yaw", heave="manual__heave"
        ),
        "reading": terminal(
            "depth",
            heading="attitude__psi",
            heel="attitude__phi",
            pitch="attitude__theta",
            heading_valid="connected",
            depth_valid="connected",
        ),
        "sensors": terminal(
            "depth",
            euler="attitude",
            accelerometer="specific_force",
            imu_valid="connected",
            depth_valid="connected",
        ),
    }
