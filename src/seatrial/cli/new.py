"""``seatrial new``: the files of a vehicle of one's own, from templates."""

from __future__ import annotations

from typing import Annotated

import typer

from ..errors import InputError, unknown
from .templates import checked_name, texts, write

new_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)

KINDS = ("usv", "rov")


@new_app.callback()
def _options() -> None:
    """Write the files of a vehicle of your own."""


@new_app.command()
def vehicle(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Letters, digits, '-' and '_', 40 at most.")
    ],
    like: Annotated[
        str, typer.Option(help="'usv': a catamaran, two thrusters; 'rov': eight thrusters.")
    ] = "usv",
) -> None:
    """Write a vehicle that runs at once, its numbers invented, below the current folder."""
    if like not in KINDS:
        raise InputError(f"--like: {unknown('kind of vehicle', like, KINDS)}")
    steps = [
        (f"seatrial run {name}", "a course of waypoints, with criteria"),
        (f"seatrial describe sil --vehicle {name}", "its components and connections"),
        (f"seatrial run {name} --autopilot nmea0183", "the same, with a feed for chart plotters"),
        (f"seatrial run {name}-mission", "for a ground station at UDP port 14550"),
        (f"seatrial run square --vehicle {name} --autopilot ardupilot=PROGRAM", "under ArduPilot"),
    ]
    if like == "usv":
        steps.append((f"seatrial run {name}-sketch", "its Arduino sketch; needs g++"))
    write(texts(checked_name(name), like), "every number in them is invented", steps)
