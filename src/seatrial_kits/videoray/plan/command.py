"""The plan command: from wanted speeds of a vessel to its motion and commands."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.show import console
from seatrial.model.readable import number
from seatrial.model.units import quantity
from seatrial.trial.reports.report import REPORT

from .motion import plan_motion
from .page import TABLE, settings, verdicts, write_plan

_INFEASIBLE = 1


def plan(
    vehicle: Annotated[
        str, typer.Argument(help="A vehicle with a surface-vessel: a name or .toml.")
    ],
    surge: Annotated[str, typer.Option(help="Wanted speed ahead, '0.5 m/s'.")],
    yaw_rate: Annotated[
        str, typer.Option(help="Wanted yaw rate, '5 deg/s', positive to starboard.")
    ] = "0 rad/s",
    duration: Annotated[
        str | None,
        typer.Option(help="Time from rest to these speeds (default: the shortest within --limit)."),
    ] = None,
    constant: Annotated[
        list[str] | None,
        typer.Option(help="surge or yaw: is there from the start; may be repeated."),
    ] = None,
    limit: Annotated[
        float, typer.Option(help="Largest share of its full thrust that a thruster may give.")
    ] = 1.0,
    stop: Annotated[
        str | None, typer.Option(help="End of the plan (default: 60 s after the speeds).")
    ] = None,
    variant: Annotated[
        str | None, typer.Option(help="Variant of the vehicle (default: its own default).")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder of the plan (default: runs/...).")
    ] = None,
) -> None:
    """Plan a vessel's motion from wanted speeds; status 1 if its thrusters cannot do it."""
    found = plan_motion(
        vehicle,
        quantity(surge, "m/s"),
        quantity(yaw_rate, "rad/s"),
        variant=variant,
        constant=constant or (),
        duration=None if duration is None else quantity(duration, "s"),
        stop=None if stop is None else quantity(stop, "s"),
        limit=limit,
    )
    folder = write_plan(found, out)
    answer.result = {
        "folder": str(folder),
        "feasible": found.feasible,
        "peak": found.peak,
        "surge": asdict(found.surge),
        "yaw": asdict(found.yaw),
        "flat_until": found.flat_until,
    }
    if found.duration_was_found:
        console.print(f"shortest duration: {number(found.duration, 4)} s")
    for holds, text in verdicts(found):
        word = "[green]yes[/]" if holds else "[red]no[/] "
        console.print(f"{word}  {escape(text)}", soft_wrap=True)
    console.print("in a trial of the rig videoray-surface:")
    for line in settings(found):
        console.print(f"  {escape(line)}", soft_wrap=True)
    console.print(f"table: {folder / TABLE}", soft_wrap=True)
    console.print(f"report: {folder / REPORT}", soft_wrap=True)
    if not found.feasible:
        raise typer.Exit(_INFEASIBLE)
