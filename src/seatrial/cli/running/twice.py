"""``seatrial run --twice``: runs repeated, with what differs and which component called a clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import typer
from rich.markup import escape

from ...system.system import Engine
from ...trial.running.twice import First, repeated
from ..answer import answer
from ..show import console
from ..statuses import FAILED
from ..stopping import Stop


def repeat(runs: Sequence[First], engine: Engine, stop: Stop) -> bool:
    """Repeat runs, say what became of each, and return whether all are the same to the byte.

    Raises SimulationError, StoppedError.
    """
    found = []
    for each in repeated(runs, engine, stop.requested):
        found.append(each)
        first, *others = each.lines()
        mark = "[red]DIFFERS[/red]" if each.difference else "[green]SAME[/green]"
        console.print(f"{mark}  {escape(first)}", soft_wrap=True)
        for line in others:
            console.print(f"  {escape(line)}", soft_wrap=True)
    answer.result["twice"] = [asdict(each) for each in found]
    same = sum(not each.difference for each in found)
    console.print(f"{same} of {len(found)} runs are the same to the byte when repeated")
    return same == len(found)


def exit_unless(is_same: bool) -> None:
    """End with a status of failure if a run and its repetition differ. Raises typer.Exit."""
    if not is_same:
        raise typer.Exit(FAILED)
