"""The estimate command: damping of a hull from its dimensions."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from seatrial.cli.show import console
from seatrial.model.readable import number

from .hull_file import estimate_damping


def estimate(
    hull: Annotated[str, typer.Argument(help="Dimensions of a hull: a name or a .toml file.")],
) -> None:
    """Estimate the damping of a hull from its dimensions, as lines of a vehicle file too."""
    found = estimate_damping(hull)
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0), title=escape(found.title), title_justify="left")
    table.add_column("")
    table.add_column("value", justify="right")
    table.add_column("unit")
    table.add_column("from")
    for each in found.derivatives:
        table.add_row(each.symbol, number(each.value + 0.0, 4), each.unit, each.equation)
    console.print(table)
    wetted, frontal = number(found.hull.wetted_area, 4), number(found.hull.frontal_area, 4)
    console.print(f"wetted area {wetted} m2, frontal area {frontal} m2")
    console.print("\nof the component marine-craft or rov, with the term coupled-damping:")
    for line in found.vehicle_lines():
        console.print(escape(line), soft_wrap=True)
