"""The PX4 component's parameters, inputs and outputs."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.errors import InputError, unknown
from seatrial.links.endpoints.url import check_urls
from seatrial.links.parameter_validation import start_date
from seatrial.links.servos import read_servos
from seatrial.links.truth import MOTION, TrueMotion
from seatrial.links.vehicle_sensors import read_instruments
from seatrial.model.component import (
    Input,
    Logging,
    Noise,
    Output,
    Parameter,
    Reachable,
    Terminal,
    terminal,
)

CHANNELS = 16
"""Of HIL_ACTUATOR_CONTROLS."""
MEASURED = ("imu", "gnss", "compass")
INSTRUMENTS = ("gnss", "compass", "barometer")

_NED = ("north", "east", "down")
_CHANNELS = tuple(f"ch{number}" for number in range(1, CHANNELS + 1))


def read_measured(text: str) -> tuple[str, ...]:
    """Return the instruments that are the vehicle's own. Raises InputError."""
    for name in text.split():
        if name not in MEASURED:
            raise InputError(unknown("instrument", name, MEASURED))
    return tuple(text.split())


def _check_link(text: str) -> None:
    check_urls(text)
    if len(text.split()) != 1 or not text.startswith("tcpin:"):
        raise InputError(f"link is {text!r}, one tcpin:HOST:PORT is needed")


class Px4Ports(Logging, Noise, Reachable, TrueMotion):
    """Parameters, inputs and outputs of `Px4`."""

    link = Parameter(
        "tcpin:127.0.0.1:4560", "1", "where the firmware connects to", check=_check_link
    )
    program = Parameter("", "1", "bin/px4 of a build for SITL, to be started; empty: you start it")
    airframe = Parameter(50000.0, "1", "SYS_AUTOSTART of a started firmware", min=1.0)
    defaults = Parameter("", "1", "file of the firmware's parameters", role="file")
    speedup = Parameter(
        1.0, "1", "simulated time per wall time at most; in lockstep, it may be less", min=0.01
    )
    wait_limit = Parameter(
        60.0, "s", "wall time to wait for a connection, then it fails; 0: without end", min=0.0
    )
    answer_period = Parameter(
        0.01, "s", "between two of PX4's actuators; the step, if that is longer", min=1e-3
    )
    answer_limit = Parameter(
        2.0, "s", "wall time to wait for actuators, then it runs on without", min=0.01
    )
    actuators = Parameter(
        "",
        "1",
        "CHANNEL NAME MIN NEUTRAL MAX of each output channel, pulses in us; with ;",
        check=read_servos,
    )
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707964, max=1.5707964)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-math.pi, max=math.pi)
    altitude = Parameter(0.0, "m", "of the origin")
    date = start_date()

    imu = Parameter(0.0, "m", "inertial unit from the body origin, body axes", axes="xyz")
    gyro_noise = Parameter(6e-4, "rad/s", "of a sample, standard deviation", min=0.0)
    accelerometer_noise = Parameter(0.007, "m/s2", "of a sample, standard deviation", min=0.0)
    field_period = Parameter(0.02, "s", "between two samples of the magnetometer", min=1e-3)
    field_noise = Parameter(3e-7, "T", "of a sample, standard deviation", min=0.0)
    pressure_period = Parameter(0.02, "s", "between two samples of the barometer", min=1e-3)
    pressure_noise = Parameter(1.0, "Pa", "of a sample, standard deviation", min=0.0)
    gnss_period = Parameter(0.2, "s", "between two fixes", min=1e-3)
    reception = Parameter("air", "1", "where the antenna receives", choices=("air", "everywhere"))
    antenna = Parameter(
        (0.0, 0.0, -0.3), "m", "antenna from the body origin, body axes", axes="xyz"
    )
    position_noise = Parameter(
        (0.1, 0.1, 0.15), "m", "of a fix, standard deviation", axes=("north", "east", "down"),
        min=0.0,
    )  # fmt: skip
    velocity_noise = Parameter(0.05, "m/s", "of a fix, standard deviation per axis", min=0.0)
    satellites = Parameter(12.0, "1", "that a fix is of", min=4.0, max=254.0)

    instruments = Parameter(
        "", "1", "the vehicle's sensors: JSON; empty: unknown", check=read_instruments
    )
    measured = Parameter(
        "",
        "1",
        "instruments that are the vehicle's own sensors: imu, gnss, compass; the others are made "
        "of the true motion",
        check=read_measured,
    )

    gyro = Input("rad/s", "rates as measured, body axes", axes="xyz", frame="b", optional=True)
    accelerometer = Input(
        "m/s2", "specific force as measured, body axes", axes="xyz", frame="b", optional=True
    )
    imu_valid = Input("1", "whether both are measured", type=bool, optional=True)
    position_n = Input(
        "m", "antenna's position as measured, {n}", axes=_NED, frame="n", optional=True
    )
    velocity_n = Input(
        "m/s", "antenna's velocity as measured, {n}", axes=_NED, frame="n", optional=True
    )
    position_valid = Input("1", "whether both are measured", type=bool, optional=True)
    heading = Input("rad", "heading as measured", optional=True)
    heading_valid = Input("1", "whether the heading is measured", type=bool, optional=True)
    without = Input(
        "1", "instruments that send nothing", axes=INSTRUMENTS, type=bool, optional=True
    )

    pulse = Output("s", "pulses of the actuators, neutral while disarmed", axes=_CHANNELS)
    connected = Output("1", "whether a firmware is connected", type=bool)
    armed = Output("1", "whether it says that it is armed", type=bool)
    lockstep = Output("1", "whether each step waits for its actuators", type=bool)
    restarts = Output("1", "times that a firmware connected again", type=int)
    frames_refused = Output("1", "frames received that are no message", type=int)
    missed = Output("1", "times that actuators did not come in time", type=int)

    terminals: ClassVar = {
        "motion": MOTION,
        "sensors": terminal(
            "gyro",
            "accelerometer",
            "imu_valid",
            "position_n",
            "velocity_n",
            "position_valid",
            "heading",
            "heading_valid",
        ),
        "pulses": Terminal({channel: f"pulse.{channel}" for channel in _CHANNELS}),
    }
