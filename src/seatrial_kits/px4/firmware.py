"""Start of a build of PX4 for SITL: its command, and its parameters as environment variables."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from seatrial.errors import InputError
from seatrial.links.program import check_program
from seatrial.links.vehicle_sensors import axis, first_of, read_instruments, three

from .ports import Px4Ports, read_measured

PORT = 4560
"""Where the instance 0 connects to; each further one to the next."""
MOST_INSTANCES = 255
_START = "etc/init.d-posix/rcS"
_NAME = re.compile(r"[A-Z][A-Z0-9_]{0,15}")
_OURS = {"SIM_GZ_EN": "0", "EKF2_GPS_DELAY": "0"}
"""No Gazebo; and fixes that are made here have no delay."""


def check_build(program: str) -> tuple[Path, Path]:
    """Return the program, and the folder of its build. Raises InputError if it is none of PX4."""
    path = check_program(program)
    build = path.parent.parent
    if not (build / _START).is_file():
        raise InputError(
            f"program: {path} is of no build of PX4 for SITL: there is no file {build / _START}"
        )
    return path, build


def instance_of(port: int) -> int:
    """Return the number of the instance that connects to ``port``. Raises InputError."""
    if not PORT <= port < PORT + MOST_INSTANCES:
        raise InputError(
            f"link: a program connects to a port from {PORT} to {PORT + MOST_INSTANCES - 1}, "
            f"not to {port}"
        )
    return port - PORT


def read_parameters(file: str) -> dict[str, str]:
    """Return the parameters of a file of lines ``NAME VALUE``; ``#`` begins a comment.

    Raises InputError, with the line, for one that is written otherwise or twice.
    """
    values: dict[str, str] = {}
    try:
        lines = Path(file).read_text("utf-8").splitlines() if file else []
    except (OSError, UnicodeDecodeError) as error:
        cause = error.strerror if isinstance(error, OSError) else "not UTF-8"
        raise InputError(f"parameter file {file}: {cause}") from None
    for number, line in enumerate(lines, 1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        if len(words) != 2 or not _NAME.fullmatch(words[0]) or not _is_number(words[1]):
            raise InputError(f"{file}, line {number}: NAME VALUE is needed, not {line.strip()!r}")
        if words[0] in values:
            raise InputError(f"{file}, line {number}: {words[0]} is there twice")
        values[words[0]] = words[1]
    return values


def environment(of: Px4Ports, parameters: Mapping[str, str]) -> dict[str, str]:
    """Return the variables by which PX4's start-up takes airframe and parameters.

    It is given where inertial unit and antenna are, and the delay of a fix: where the fixes are
    measured, those of the vehicle's receiver. ``parameters`` may say otherwise.
    """
    given = dict(_OURS)
    places: dict[str, Sequence[float]] = {"EKF2_IMU_POS": of.imu, "EKF2_GPS_POS": of.antenna}
    _, gnss = first_of(read_instruments(of.instruments), "gnss")
    if gnss is not None and "gnss" in read_measured(of.measured):
        places["EKF2_GPS_POS"] = three(gnss["antenna"])
        given["EKF2_GPS_DELAY"] = f"{1e3 * axis(gnss['delay']):g}"
    for parameter, place in places.items():
        given |= {f"{parameter}_{letter}": f"{x:g}" for letter, x in zip("XYZ", place, strict=True)}
    given |= parameters
    return {
        "PX4_SYS_AUTOSTART": f"{of.airframe:.0f}",
        "PX4_SIMULATOR": "none",
        **{f"PX4_PARAM_{name}": value for name, value in given.items()},
    }


def arguments(instance: int, etc: str) -> list[str]:
    """Return the program's options; ``etc`` is the folder of its start-up files."""
    return ["-d", "-i", str(instance), etc]


def by_hand(variables: Mapping[str, str], port: int) -> str:
    """Return the command as a person types it, for a firmware that connects to ``port``."""
    given = " ".join(f"{name}={shlex.quote(value)}" for name, value in variables.items())
    options = arguments(max(0, port - PORT), "BUILD/etc")
    return f"{given} BUILD/bin/px4 {shlex.join(options)}"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
