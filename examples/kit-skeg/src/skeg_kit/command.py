"""``seatrial skeg``: how much a skeg holds."""

from __future__ import annotations

import math
from typing import Annotated

import typer

from seatrial.cli.show import console
from seatrial.errors import InputError
from seatrial.system.parameters import load_vehicle


def skeg(
    speed: Annotated[float, typer.Argument(metavar="SPEED", help="Speed ahead, m/s.")],
    vehicle: Annotated[str, typer.Option(help="A vehicle with a skeg.")] = "skiff",
) -> None:
    """Show the side force of a vehicle's skeg for each degree of drift."""
    if speed < 0.0:
        raise InputError(f"SPEED: at least 0 is needed, found {speed:g}")
    values = load_vehicle(vehicle).parameter_set("skeg-craft", None).values
    area, slope = (float(values[name].value) for name in ("skeg_area", "skeg_slope"))
    density = float(values["density"].value)
    force = density * area * slope * speed**2 / 2 * math.radians(1.0)
    console.print(f"{force:.1f} N for each degree of drift at {speed:g} m/s")
