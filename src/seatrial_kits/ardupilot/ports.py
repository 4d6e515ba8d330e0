"""The ArduPilot component's parameters, inputs and outputs."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.errors import InputError
from seatrial.links.endpoints.url import check_urls
from seatrial.links.parameter_validation import start_date
from seatrial.links.servos import read_servos
from seatrial.links.truth import MOTION, TrueMotion
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

from .packet import MOST_CHANNELS
from .reply import RANGES, read_fields

LOOP_HZ = {"rover": 50.0, "sub": 400.0, "copter": 400.0}
"""Main loop of each firmware: it needs its sensors at least as often."""
RC_CHANNELS = 12

_CHANNELS = tuple(f"ch{number}" for number in range(1, MOST_CHANNELS + 1))


def _check_link(text: str) -> None:
    check_urls(text)
    if len(text.split()) != 1 or not text.startswith("udpin:"):
        raise InputError(f"link is {text!r}, one udpin:HOST:PORT is needed")


class ArduPilotPorts(Logging, Reachable, TrueMotion):
    """Parameters, inputs and outputs of `ArduPilot`."""

    link = Parameter(
        "udpin:127.0.0.1:9002", "1", "where the firmware sends its servo packets", check=_check_link
    )
    firmware = Parameter("rover", "1", "which firmware", choices=tuple(LOOP_HZ))
    program = Parameter("", "1", "the firmware's program, to be started; empty: you start it")
    serial0 = Parameter(
        "", "1", "device of its first serial port, for a ground station; empty: its own"
    )
    instance = Parameter(
        0.0,
        "1",
        "of several firmwares on one machine: adds 10 to its own ports, 1 to its MAVLink number",
        min=0.0,
        max=200.0,
    )
    defaults = Parameter("", "1", "file of the firmware's parameters", role="file")
    speedup = Parameter(
        1.0, "1", "simulated time per wall time at which a started firmware paces", min=0.01
    )
    wait_limit = Parameter(
        60.0, "s", "wall time to wait for a frame, then it fails; 0: without end", min=0.0
    )
    fields = Parameter(
        "", "1", "what it is sent beside the motion, separated by spaces", check=read_fields
    )
    actuators = Parameter(
        "",
        "1",
        "CHANNEL NAME MIN NEUTRAL MAX of each output channel, pulses in us; with ;",
        check=read_servos,
    )
    instruments = Parameter(
        "",
        "1",
        "the vehicle's sensors, of which its simulated ones follow: JSON; empty: its own",
        check=read_instruments,
    )
    date = start_date()
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707964, max=1.5707964)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-math.pi, max=math.pi)
    altitude = Parameter(0.0, "m", "of the origin")

    wind_speed = Input("m/s", "speed of the apparent wind", optional=True)
    wind_angle = Input(
        "rad", "where the apparent wind blows to from the bow, to starboard", optional=True
    )
    wind_valid = Input("1", "whether the wind is measured", type=bool, optional=True)
    wind = Input(
        "m/s", "velocity of the air, where it blows to", axes="xyz", frame="n", optional=True
    )
    airspeed = Input("m/s", "speed through the air", optional=True)
    distance = Input("m", "rangefinders' distances", axes=RANGES, optional=True)
    rc = Input(
        "s",
        "pulses of an RC receiver",
        axes=tuple(f"rc_{number}" for number in range(1, RC_CHANNELS + 1)),
        start=1.5e-3,
        optional=True,
    )
    voltage = Input("V", "voltage of the battery", optional=True)
    current = Input("A", "current out of the battery", optional=True)

    pulse = Output("s", "servo pulses, 0 for none", axes=_CHANNELS)
    armed = Output("1", "whether an actuator has been off its neutral pulse", type=bool)
    connected = Output("1", "whether a firmware has sent something", type=bool)
    frame_rate = Output("Hz", "frames per second that the firmware expects")
    restarts = Output("1", "times that the firmware began again", type=int)
    repeated = Output("1", "frames that the firmware repeated", type=int)
    frames_refused = Output("1", "datagrams that are no frame, or another's", type=int)
    lost = Output("1", "frames that were never received", type=int)

    terminals: ClassVar = {
        "motion": MOTION,
        "sensors": terminal("wind_speed", "wind_angle", "wind_valid"),
        "pulses": Terminal({channel: f"pulse.{channel}" for channel in _CHANNELS}),
    }
