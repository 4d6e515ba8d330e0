"""``seatrial identify``: parameters of an axis of a vehicle from the log of an experiment."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from seatrial.cli.answer import answer
from seatrial.cli.options import LogFormat
from seatrial.cli.show import console
from seatrial.trial.reports.report import REPORT
from seatrial.trial.running.output import claim_folder

from .studies.page import RatioRow, physical_rows, ratio_rows, write_page
from .studies.planar_experiment import PlanarExperiment, read_experiment
from .studies.planar_page import planar_rows, write_planar_page
from .studies.planar_study import PlanarStudy, planar_study
from .studies.study import Study, study
from .studies.vehicle_file import base_vehicle, write_vehicle

VEHICLE = "vehicle.toml"
_REJECTED = 1


def identify(
    experiment: Annotated[str, typer.Argument(help="Experiment: a name or a .toml file.")],
    log: Annotated[
        Path | None, typer.Option("--log", help="A log, or a run folder, instead of the file's.")
    ] = None,
    format_name: LogFormat = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder of the result (default: runs/...).")
    ] = None,
) -> None:
    """Identify an axis of a vehicle from a log; status 1 if the model is to be rejected."""
    loaded = read_experiment(experiment)
    found: Study | PlanarStudy = (
        planar_study(loaded, log, format_name)
        if isinstance(loaded, PlanarExperiment)
        else study(loaded, log, format_name)
    )
    base = base_vehicle(found)
    folder = claim_folder(out, f"{loaded.name}-identified", REPORT)
    parameters = folder / VEHICLE if found.accepted else None
    if parameters is not None:
        write_vehicle(found, base, parameters)
    beside = None if parameters is None else VEHICLE
    page = (
        write_planar_page(found, folder, beside)
        if isinstance(found, PlanarStudy)
        else write_page(found, folder, beside)
    )
    answer.result = {
        "folder": str(folder),
        "accepted": found.accepted,
        "parameters": None if parameters is None else str(parameters),
        "verdicts": [asdict(verdict) for verdict in found.verdicts],
    }
    _print(found)
    if parameters is not None:
        console.print(f"parameters: {parameters}", soft_wrap=True)
    console.print(f"report: {page}", soft_wrap=True)
    if parameters is None:
        raise typer.Exit(_REJECTED)


def _print(found: Study | PlanarStudy) -> None:
    if isinstance(found, PlanarStudy):
        console.print(_table(planar_rows(found)))
    else:
        _print_axis(found)
    for verdict in found.verdicts:
        style, word = ("green", "PASS") if verdict.passed else ("red", "FAIL")
        console.print(
            f"[{style}]{word}[/]  {escape(verdict.name)}: {escape(verdict.detail)}", soft_wrap=True
        )


def _print_axis(found: Study) -> None:
    ratios = _table(ratio_rows(found))
    period = found.fitted.period
    delays = (f"{found.delay:g}", "", f"{found.source.delay * period:g}")
    ratios.add_row("delay", *delays, "s")
    console.print(ratios)
    for physical in physical_rows(found):
        console.print(
            f"{physical.name}: {physical.value} {physical.unit}, "
            f"standard deviation {physical.deviation}"
        )
    if not found.whiteness.white:
        console.print("note: the residual is not white: something acts that the model lacks")


def _table(rows: list[RatioRow]) -> Table:
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("")
    for heading in ("output error", "deviation", "method of [Paulino2015]"):
        table.add_column(heading, justify="right")
    table.add_column("unit")
    for row in rows:
        table.add_row(row.symbol, row.ours, row.deviation, row.source, row.unit)
    return table
