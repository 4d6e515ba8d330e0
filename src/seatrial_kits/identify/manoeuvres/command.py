"""``seatrial calibrate``: a vehicle's parameters from logs of standard manoeuvres."""

from __future__ import annotations

import shutil
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.show import console, print_notes, print_table, text_table
from seatrial.errors import InputError, unknown
from seatrial.trial.reports.report import REPORT
from seatrial.trial.running.output import claim_folder
from seatrial_kits.logs.reading import reading
from seatrial_kits.sea_trials.log_record import MOTION

from .craft import Craft
from .page import HEADINGS, pass_rows, table_rows, write_page
from .passes import SPEED, YAW, Pass, read_pass
from .replay import craft_of
from .study import ManoeuvreStudy, manoeuvre_study
from .vehicle_copy import write_copy

_REJECTED = 1


def calibrate(
    vehicle: Annotated[str, typer.Argument(help="Name of the vehicle.")],
    logs: Annotated[
        list[Path], typer.Argument(metavar="LOG...", help="Logs of manoeuvres, or run folders.")
    ],
    columns: Annotated[
        list[str] | None,
        typer.Option(
            "--columns",
            metavar="WHAT=NAME[:UNIT],...",
            help="Columns of the logs; orders are helm or yaw, and speed, or inputs of the craft.",
        ),
    ] = None,
    checks: Annotated[
        list[Path] | None,
        typer.Option("--check", metavar="LOG", help="A log to evaluate the result, not fitted."),
    ] = None,
    free: Annotated[
        list[str] | None,
        typer.Option(
            "--free", metavar="NAME,...", help="Parameters to calibrate (default: usual)."
        ),
    ] = None,
    variant: Annotated[
        str | None, typer.Option("--variant", help="Variant of the vehicle to start from.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder of the result (default: runs/...).")
    ] = None,
) -> None:
    """Calibrate a vehicle by logs of manoeuvres; status 1 if the model is to be rejected."""
    craft = craft_of(vehicle, variant)
    names = [name.strip() for text in free or [] for name in text.split(",")]
    looked_for = craft.free(names)
    passes, checked = (
        [_read(log, columns, craft) for log in each] for each in (logs, checks or [])
    )
    notes = [note for each in (*passes, *checked) for note in each.notes]
    print_notes(notes)
    folder = claim_folder(out, f"{vehicle}-identified", REPORT)
    try:
        found = manoeuvre_study(vehicle, passes, craft, looked_for, variant, checked)
    except BaseException:
        shutil.rmtree(folder)
        raise
    file = write_copy(found, folder) if found.accepted else None
    page = write_page(found, folder, file)
    answer.result = {
        "folder": str(folder),
        "accepted": found.accepted,
        "vehicle": None if file is None else str(file),
        "parameters": [{**asdict(row), "interval": row.interval} for row in found.rows],
        "notes": [*notes, *found.notes],
        "verdicts": [asdict(verdict) for verdict in found.verdicts],
    }
    _print(found)
    if file is not None:
        console.print(f"vehicle: {file}", soft_wrap=True)
    console.print(f"report: {page}", soft_wrap=True)
    if file is None:
        raise typer.Exit(_REJECTED)


def _read(log: Path, columns: list[str] | None, craft: Craft) -> Pass:
    with reading(log):
        return read_pass(log, columns or [], lambda what: _unit(craft, what))


def _unit(craft: Craft, what: str) -> str:
    if what in (YAW, SPEED):
        return "1"
    if what not in craft.model.u_names:
        known = [*MOTION, YAW, SPEED, *craft.fed]
        raise InputError(f"--columns: {unknown('column', what, known)}")
    return craft.unit(what)


def _print(found: ManoeuvreStudy) -> None:
    # The page has the column of the bootstrap, for which a terminal is too narrow.
    print_table(text_table(HEADINGS[:-1], [row[:-1] for row in table_rows(found)]))
    heads = ("", "track before", "identified", "heading before", "identified")
    print_table(text_table(heads, pass_rows(found)))
    print_notes(found.notes)
    for verdict in found.verdicts:
        style, word = ("green", "PASS") if verdict.passed else ("red", "FAIL")
        console.print(
            f"[{style}]{word}[/]  {escape(verdict.name)}: {escape(verdict.detail)}", soft_wrap=True
        )
