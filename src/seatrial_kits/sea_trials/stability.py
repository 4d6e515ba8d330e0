"""``seatrial stability``: righting arms of a vehicle at the surface, to capsize."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer
from rich.box import SIMPLE
from rich.table import Table

from seatrial.cli.answer import answer
from seatrial.cli.show import console
from seatrial.errors import InputError
from seatrial.fmi.components.index import component_class
from seatrial.model.readable import number
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.sea.numbers import Array
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig

_SHOWN = (*range(0, 91, 10), 120, 150)
_LEAST_LENGTH = 24.0
"""m: the code is for ships of that length and more."""


def stability(
    vehicle: Annotated[str, typer.Argument(help="A vehicle that floats at the surface.")],
    variant: Annotated[
        str | None, typer.Option(help="Variant of the vehicle (default: its own default).")
    ] = None,
) -> None:
    """Find righting arms from the sections of a hull: GZ to capsize, areas, criteria of the IMO."""
    craft = craft_of(vehicle, variant)
    found = Stability(craft.righting_arms(ANGLES), craft.GM_T)
    answer.result = _content(found)
    _print(found, craft.hull_length)


def craft_of(vehicle: str, variant: str | None) -> MarineCraft:
    """Return the craft of a vehicle, with its parameters. Raises InputError for one without."""
    system = assemble(load_rig(f"vehicles/{vehicle}", Path.cwd()), "direct", variant=variant)
    try:
        for part in system.parts.values():
            kind = component_class(part.fmu) if ":" not in part.fmu else None
            if kind is not None and issubclass(kind, MarineCraft):
                craft = kind(part.name)
                for name, given in part.given.items():
                    craft.set(name, given.value)
                return craft
    finally:
        system.discard()
    raise InputError(
        f"vehicle {vehicle!r} has no craft in six degrees of freedom that floats: marine-craft, "
        "fitted-craft or seakeeping-craft"
    )


def _print(found: Stability, length: float) -> None:
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("heel, deg", justify="right")
    table.add_column("GZ, m", justify="right")
    for degrees in _SHOWN:
        arm = round(float(np.interp(math.radians(degrees), ANGLES, found.arms)), 3)
        table.add_row(str(degrees), f"{arm + 0.0:.3f}")
    console.print(table)
    arm, angle = found.largest
    console.print(f"largest arm: {number(arm, 4)} m at {math.degrees(angle):.0f} deg")
    console.print(f"vanishing stability: {math.degrees(found.vanishing):.1f} deg")
    of_ships = "" if length >= _LEAST_LENGTH else f", of ships of {_LEAST_LENGTH:g} m and more"
    console.print(f"International Code on Intact Stability 2008{of_ships}:")
    for each in found.criteria():
        verdict = "holds" if each.holds else "FAILS"
        console.print(
            f"  {verdict}  {each.name}: {each.found:.4g} {each.unit}, least {each.least:g}"
        )


def _content(found: Stability) -> dict[str, Any]:
    arm, angle = found.largest
    return {
        "heel_rad": ANGLES.tolist(),
        "righting_arm_m": found.arms.tolist(),
        "vanishing_rad": found.vanishing,
        "largest_arm_m": arm,
        "largest_arm_at_rad": angle,
        "criteria": [{**each._asdict(), "holds": each.holds} for each in found.criteria()],
    }


ANGLES = np.radians(np.arange(0.0, 181.0, 1.0))
"""Angles of heel that a curve is asked for, rad."""


class Criterion(NamedTuple):
    """A figure, and the least that is allowed."""

    name: str
    found: float
    least: float
    unit: str

    @property
    def holds(self) -> bool:
        """Whether it is kept."""
        return self.found >= self.least


class Stability(NamedTuple):
    """A curve GZ, m, at `ANGLES`, by its figures; SI and radians."""

    arms: Array
    GM: float
    """Its slope at rest, m."""

    @property
    def vanishing(self) -> float:
        """Least angle from which on the arm capsizes; pi if there is none, 0 without GM."""
        after = np.flatnonzero(self.arms[1:-1] <= 0.0)
        if not len(after) or self.GM <= 0.0:
            return math.pi if self.GM > 0.0 else 0.0
        k = int(after[0])
        before, beyond = self.arms[k], self.arms[k + 1]
        return float(ANGLES[k] + (ANGLES[k + 1] - ANGLES[k]) * before / (before - beyond))

    @property
    def largest(self) -> tuple[float, float]:
        """Largest arm before that, m, and its angle."""
        k = int(np.argmax(np.where(self.vanishing >= ANGLES, self.arms, -np.inf)))
        return float(self.arms[k]), float(ANGLES[k])

    def area(self, start: float, end: float) -> float:
        """Return the area below the curve between two angles, m rad, to where it vanishes."""
        phi = np.linspace(start, max(start, min(end, self.vanishing)), 401)
        return float(np.trapezoid(np.interp(phi, ANGLES, self.arms), phi))

    def criteria(self) -> list[Criterion]:
        """Return those of the International Code on Intact Stability, 2008, part A, 2.2."""
        thirty, forty = math.radians(30.0), math.radians(40.0)
        _, angle = self.largest
        beyond = np.where((thirty - 1e-9 <= ANGLES) & (self.vanishing >= ANGLES), self.arms, 0.0)
        return [
            Criterion("area to 30 deg", self.area(0.0, thirty), 0.055, "m.rad"),
            Criterion("area to 40 deg", self.area(0.0, forty), 0.090, "m.rad"),
            Criterion("area from 30 to 40 deg", self.area(thirty, forty), 0.030, "m.rad"),
            Criterion("largest arm from 30 deg on", float(beyond.max()), 0.20, "m"),
            Criterion("angle of the largest arm", math.degrees(angle), 25.0, "deg"),
            Criterion("GM", self.GM, 0.15, "m"),
        ]
