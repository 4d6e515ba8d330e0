"""``seatrial shadow``: a real boat's log plays into a system, and the two are compared."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.leaves import exit_with
from seatrial.cli.options import (
    Autopilot,
    Choices,
    EngineName,
    LogColumns,
    LogFormat,
    Out,
    Settings,
    Vehicle,
    changes_of,
    engine_named,
)
from seatrial.cli.show import (
    console,
    print_notes,
    print_table,
    print_verdicts,
    run_entry,
    text_table,
)
from seatrial.cli.stopping import stoppable
from seatrial.cli.watch import Watch
from seatrial.system.system import Engine
from seatrial.trial.files.trial import Trial
from seatrial.trial.logs.formats import format_of, read_log
from seatrial.trial.logs.quantities import read_columns
from seatrial.trial.records.ending import is_whole
from seatrial.trial.reports.playing import play
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.run import Result
from seatrial.trial.running.supervision import run_supervised

from ..command_import import Begin, Checks, End, window_of
from ..paired.pairing import read_matches
from ..paired.residuals import HEADINGS, resampling_notes
from ..paired.steady_clock import from_zero, steady
from ..reading import reading
from .asked import Asked, read_feeds
from .page import compared, describe, write_data, write_page
from .preparing import Driven, Prepared, prepared


def shadow(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="A file, a bag or a run folder.")],
    vehicle: Vehicle = None,
    rig: Annotated[
        str | None, typer.Option("--rig", metavar="RIG", help="A rig, or a trial, to play into.")
    ] = None,
    feed: Annotated[
        list[str] | None,
        typer.Option(
            "--feed",
            metavar="PORT=CHANNEL[:UNIT],...",
            help="Inputs that channels, or numbers, feed; of a vehicle's pilot yaw, helm, speed.",
        ),
    ] = None,
    compare: Annotated[
        list[str] | None,
        typer.Option(
            "--compare",
            metavar="SIGNAL=CHANNEL[:UNIT],...",
            help="Signals and the channels that are the same (default: the craft's motion).",
        ),
    ] = None,
    columns: LogColumns = None,
    format_name: LogFormat = None,
    begin: Begin = None,
    end: End = None,
    check: Checks = None,
    settings: Settings = None,
    choices: Choices = None,
    autopilot: Autopilot = None,
    engine: EngineName = "direct",
    out: Out = None,
) -> None:
    """Play a log into a system and compare them; status 1 if a criterion fails."""
    chosen = engine_named(engine)
    named = read_columns(columns) if columns else {}
    asked = Asked(
        read_feeds(feed or []), read_matches(compare or [], "--compare"), named,
        window_of(begin, end),
    )  # fmt: skip
    driven = Driven(rig, vehicle, changes_of(settings, choices, None, autopilot))
    name = format_name or format_of(log)
    with reading(log):
        found = from_zero(steady(read_log(log, name, named.pop("time", None))))
    with TemporaryDirectory() as folder:
        made = prepared(found, driven, asked, check or [], Path(folder))
        result = _run(made.trial, out, chosen)
    print_notes(found.notes)
    print_notes(made.notes)
    print_verdicts(result)
    answer.result = {"runs": [run_entry(result)]}
    if is_whole(result.status):
        _compare(result, made, name, [*found.notes, *made.notes], vehicle)
    exit_with([result])


def _run(trial: Trial, out: Path | None, engine: Engine) -> Result:
    with stoppable() as stop, Watch(trial.name) as watch:
        hooks = Hooks(
            building=watch.building,
            progress=watch.progress,
            stop_requested=stop.requested,
            interruptible=stop.interruptible,
        )
        return run_supervised(trial, out, engine=engine, hooks=hooks)


def _compare(
    result: Result, made: Prepared, format_name: str, notes: list[str], vehicle: str | None
) -> None:
    describe(result.folder, made, format_name)
    run, residuals, lacking = compared(result.folder, made)
    print_notes(lacking)
    notes = [*notes, *lacking]
    answer.result.update(write_data(result.folder, residuals, notes))
    if residuals:
        print_table(text_table(HEADINGS, [each.cells() for each in residuals]))
    for line in resampling_notes(residuals):
        console.print(escape(line), soft_wrap=True)
    page = write_page(run, residuals, notes)
    write_report(result.folder, play=play)
    if vehicle is not None and made.traces.orders():
        line = f"identify: seatrial calibrate {vehicle} {result.folder}"
        console.print(escape(line), soft_wrap=True)
    console.print(f"report: {page}", soft_wrap=True)
