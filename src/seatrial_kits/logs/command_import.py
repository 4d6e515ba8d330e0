"""``seatrial import``: a log as a run folder."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.options import LogColumns, LogFormat
from seatrial.cli.show import console, print_notes
from seatrial.cli.statuses import FAILED
from seatrial.cli.watch import Watch
from seatrial.errors import InputError
from seatrial.model.units import quantity
from seatrial.system.parameters import Outline, load_vehicle
from seatrial.trial.criteria.criteria import parse
from seatrial.trial.logs.formats import format_of, read_log
from seatrial.trial.logs.quantities import read_columns
from seatrial.trial.records.run_folder import MANIFEST
from seatrial.trial.reports.playing import play
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.output import claim_folder

from .imported import Wanted, imported, write_run
from .paired.common_time import Window
from .paired.steady_clock import from_zero, steady
from .reading import reading

Begin = Annotated[
    str | None, typer.Option("--from", metavar="TIME", help="Begin of the part of the log: '60 s'.")
]
End = Annotated[str | None, typer.Option("--to", metavar="TIME", help="End of it.")]
Checks = Annotated[
    list[str] | None,
    typer.Option("--check", metavar="CRITERION", help="A criterion of signals log.NAME."),
]


def import_log(
    path: Annotated[Path, typer.Argument(metavar="LOG", help="A file, or a bag.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder (default: runs/NAME-DATE-TIME).")
    ] = None,
    columns: LogColumns = None,
    channels: Annotated[
        list[str] | None,
        typer.Option("--channels", metavar="PATTERN,...", help="Channels, such as 'ATTITUDE.*'."),
    ] = None,
    format_name: LogFormat = None,
    begin: Begin = None,
    end: End = None,
    every: Annotated[
        str | None,
        typer.Option("--every", metavar="TIME", help="Time between two rows (default: the log's)."),
    ] = None,
    vehicle: Annotated[
        str | None, typer.Option("--vehicle", metavar="NAME", help="Whose outline is drawn.")
    ] = None,
    check: Checks = None,
) -> None:
    """Import a log as a run folder: reports, playback, criteria and exports; status 1 if one fails.

    The signals are log.NAME, in the log's units, on one time axis.
    """
    named = read_columns(columns) if columns else {}
    criteria = [(text, text) for text in check or []]
    for _, text in criteria:
        parse(text)
    outline, step = _outline(vehicle), _step(every)
    patterns = [each.strip() for text in channels or [] for each in text.split(",")]
    name = format_name or format_of(path)
    if name == "run":
        raise InputError(f"{path}: is a run folder already")
    with reading(path):
        wanted = Wanted(named, patterns, window_of(begin, end), step)
        time = named.pop("time", None)
        found = imported(from_zero(steady(read_log(path, name, time))), wanted)
    folder = claim_folder(out, path.stem, MANIFEST)
    span = max(float(found.time[-1] - found.time[0]), 1e-9)
    try:
        with Watch(path.name) as watch:
            run = write_run(found, folder, name, criteria, outline,
                            lambda share: watch.progress(share * span, span))  # fmt: skip
        page = write_report(folder, play=play, run=run)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    print_notes(found.notes)
    answer.result = {
        "folder": str(folder),
        "format": name,
        "rows": len(found.time),
        "signals": found.units,
        "serves": found.serves,
        "notes": list(found.notes),
    }
    console.print(
        f"{len(found.units)} signals in {len(found.time)} rows, from {found.time[0]:g} s to "
        f"{found.time[-1]:g} s",
        soft_wrap=True,
    )
    passed = print_records(folder)
    console.print(f"report: {page}", soft_wrap=True)
    if not passed:
        raise typer.Exit(FAILED)


def _outline(vehicle: str | None) -> Outline | None:
    outline = None if vehicle is None else load_vehicle(vehicle).file.outline
    if vehicle is not None and outline is None:
        print_notes([f"the file of {vehicle} has no outline: nothing of it is drawn"])
    return outline


def _step(every: str | None) -> float | None:
    step = None if every is None else _duration("--every", every)
    if step is not None and step <= 0.0:
        raise InputError(f"--every: a time above 0 is needed, found {every!r}")
    return step


def print_records(folder: Path) -> bool:
    """Print the verdicts in a run's folder; return whether all hold."""
    from seatrial.trial.records.run_folder import read_verdicts

    verdicts = read_verdicts(folder)
    for verdict in verdicts:
        style, word = ("green", "PASS") if verdict["passed"] else ("red", "FAIL")
        line = f"{escape(verdict['name'])}: {escape(verdict['detail'])}"
        console.print(f"[{style}]{word}[/]  {line}", soft_wrap=True)
    return all(verdict["passed"] for verdict in verdicts)


def window_of(begin: str | None, end: str | None) -> Window:
    """Return the part of a log's time that ``--from`` and ``--to`` name. Raises InputError."""
    first = -math.inf if begin is None else _duration("--from", begin)
    last = math.inf if end is None else _duration("--to", end)
    if first >= last:
        raise InputError(f"--from {begin!r} is not before --to {end!r}")
    return first, last


def _duration(option: str, text: str) -> float:
    try:
        return quantity(text, "s")
    except InputError as error:
        raise InputError(f"{option}: {error}") from None
