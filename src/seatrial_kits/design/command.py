"""The design command: gains of a heading autopilot from root loci."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer
from rich.box import SIMPLE
from rich.table import Table

from seatrial.cli.show import console
from seatrial.model.readable import number

from .heading import HeadingDesign, design_heading
from .heading_page import rows, stability, write_design


def design(
    vehicle: Annotated[
        str, typer.Argument(help="A vehicle that a rudder steers: a name or .toml.")
    ],
    variant: Annotated[
        str | None, typer.Option(help="Variant of the vehicle (default: its own default).")
    ] = None,
    td: Annotated[
        list[float] | None,
        typer.Option(
            help="Derivative time in L/U; may be repeated (default: 0 and the vehicle's)."
        ),
    ] = None,
    damping: Annotated[
        float, typer.Option(help="Damping ratio that the slowest poles should have.")
    ] = math.sqrt(0.5),
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder of the page (default: runs/...).")
    ] = None,
) -> None:
    """Design a heading autopilot: poles over the gain, gains for a damping ratio, stability."""
    found = design_heading(vehicle, variant, td, damping)
    page = write_design(found, out)
    _print(found)
    console.print(f"report: {page}", soft_wrap=True)


def _print(found: HeadingDesign) -> None:
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0))
    for heading in ("Td, L/U", "Kp = K", "Kd, s"):
        table.add_column(heading, justify="right")
    table.add_column("poles, U/L")
    table.add_column("damping")
    for row in rows(found):
        table.add_row(row.derivative_time, row.K, row.Kd, row.poles, row.damping)
    console.print(table)
    console.print(f"L/U = {number(found.time_unit, 6)} s")
    for locus in found.loci:
        console.print(f"Td = {number(locus.derivative_time, 6)}: stable for {stability(locus)}")
