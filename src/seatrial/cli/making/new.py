"""``seatrial new``: the files of a vehicle of one's own, from templates."""

from __future__ import annotations

import re
from typing import Annotated

import typer

from ...errors import InputError, unknown
from .templates import checked_name, texts, write

new_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)

KINDS = {
    "usv": "a catamaran, two thrusters",
    "rov": "eight thrusters",
    "auv": "a torpedo, propeller and fins",
    "azimuth": "a workboat, two azimuth thrusters and a tunnel",
    "ship": "propeller and rudder",
}
"""What a vehicle can be like, and what that is."""

_INVENTED = "every number in them is invented"

_NAME = Annotated[
    str, typer.Argument(metavar="NAME", help="Letters, digits, '-' and '_', 40 at most.")
]
_VEHICLE = Annotated[str, typer.Argument(metavar="NAME", help="Name of your vehicle.")]
_PACKAGE = Annotated[str, typer.Argument(metavar="NAME", help="Name of the package: my_boat.")]
_ROS_NAME = re.compile(r"[a-z](_?[a-z0-9]+)*")
_LIKE = Annotated[str, typer.Option(help="; ".join(f"'{k}': {v}" for k, v in KINDS.items()) + ".")]
_LIKE_IT = Annotated[str, typer.Option(help=f"Kind of the vehicle: {', '.join(KINDS)}.")]


@new_app.callback()
def _options() -> None:
    """Write the files of a vehicle of your own."""


@new_app.command()
def vehicle(name: _NAME, like: _LIKE = "usv") -> None:
    """Write a vehicle that runs at once, its numbers invented, below the current folder."""
    steps = [
        (f"seatrial run {name}", "it sets out to the east"),
        (f'seatrial run {name} --set sea.height="0.3 m"', "the same in waves"),
        (f"seatrial run {name} --live --open", "the same, seen in a browser"),
        (f"seatrial describe sil --vehicle {name}", "its components and connections"),
        (f"seatrial run under-ground-station --vehicle {name}", "for a ground station"),
        (f"seatrial new trials {name} --like {like}", "trials of its own"),
        (f"seatrial new ardupilot {name} --like {like}", "what ArduPilot needs"),
    ]
    if like == "usv":
        steps.append((f"seatrial new sketch-of {name}", "an Arduino sketch for it"))
    write(texts(checked_name(name), _kind(like)), _INVENTED, steps)


@new_app.command()
def trials(name: _VEHICLE, like: _LIKE_IT = "usv") -> None:
    """Write trials of a vehicle: a course with criteria, and a mission for a ground station."""
    steps = [
        (f"seatrial run {name}-course", "waypoints, with criteria"),
        (f"seatrial run {name}-mission", "for a ground station at UDP port 14550"),
    ]
    write(texts(checked_name(name), f"trials/{_kind(like)}"), _INVENTED, steps)


@new_app.command()
def ardupilot(name: _VEHICLE, like: _LIKE_IT = "usv") -> None:
    """Write what ArduPilot needs to drive a vehicle: rig, parameters, section of its profile."""
    command = f"seatrial run square --vehicle {name} --autopilot ardupilot=PROGRAM"
    steps = [(command, "round a square under ArduPilot")]
    write(texts(checked_name(name), f"ardupilot/{_kind(like)}"), _INVENTED, steps)


@new_app.command()
def sketch_of(name: _VEHICLE) -> None:
    """Write an Arduino sketch for a vehicle with two thrusters, its trial and profile section."""
    steps = [
        (f"seatrial run {name}-sketch", "the sketch in the place of the autopilot; needs g++"),
        (f"seatrial sketch check harness/firmware/{name} --profile {name}:mega", "its lines"),
    ]
    write(texts(checked_name(name), "sketch-of"), _INVENTED, steps)


@new_app.command()
def ros2_package(name: _PACKAGE) -> None:
    """Write a ROS 2 package: a node that sails a vehicle, a launch file with a trial, a test."""
    steps = [
        (f"colcon build --packages-select {name}", "in a workspace, with ROS 2 sourced"),
        (f"ros2 launch {name} sim.launch.py vehicle:=otter", "a trial, and the node"),
        (f"colcon test --packages-select {name}", "fails if a criterion does not hold"),
    ]
    if not _ROS_NAME.fullmatch(checked_name(name)):
        raise InputError(f"NAME {name!r}: ROS allows small letters, digits and single '_'")
    write(texts(name, "ros2-package"), "It sails any boat along the legs of a trial", steps)


def _kind(like: str) -> str:
    """Return a kind of vehicle. Raises InputError for one that is none."""
    if like not in KINDS:
        raise InputError(f"--like: {unknown('kind of vehicle', like, KINDS)}")
    return like
