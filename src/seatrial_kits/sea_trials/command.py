"""``seatrial trials``: figures of sea trials, from runs and from logs."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated

import typer
from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from seatrial.cli.answer import answer
from seatrial.cli.options import LogColumns, LogFormat
from seatrial.cli.show import console, print_notes
from seatrial.errors import InputError, unknown
from seatrial.model.readable import number, person_scale
from seatrial.model.units import quantity
from seatrial.trial.logs.quantities import Column, read_columns
from seatrial.trial.records.run_folder import MANIFEST, load_run
from seatrial_kits.logs.paired.common_time import WHOLE, Window
from seatrial_kits.logs.reading import reading

from .drawing import shown_number
from .evaluation import FIGURES, Done, approach_speed_of, criteria_name, figures_of
from .figures.criteria import Verdict, imo
from .figures.result import Figures
from .log_record import read_record
from .page import DATA, evaluated, failed, run_folders, write_pages
from .run_record import done_in, has_component
from .uncertainty import read_errors, with_uncertainty

trials_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)
CRITERIA = ("imo", "none")
_FAILED = 1


@trials_app.callback()
def _trials() -> None:
    """Find figures of standard sea trials."""


@trials_app.command()
def figures(
    log: Annotated[Path, typer.Argument(help="A run folder, or the log of a real trial.")],
    manoeuvre: Annotated[
        str | None, typer.Option("--manoeuvre", help=f"Of a log: {', '.join(FIGURES)}.")
    ] = None,
    columns: LogColumns = None,
    format_name: LogFormat = None,
    start: Annotated[
        str | None, typer.Option("--from", help="Time of the log at which the record starts.")
    ] = None,
    end: Annotated[str | None, typer.Option("--to", help="Time at which it ends.")] = None,
    length: Annotated[str | None, typer.Option(help="Length between perpendiculars.")] = None,
    heading: Annotated[str | None, typer.Option(help="Heading change of a zig-zag.")] = None,
    depth: Annotated[str | None, typer.Option(help="Depth that a step leads to.")] = None,
    order: Annotated[
        list[str] | None, typer.Option("--order", help="Time of an order, once for each.")
    ] = None,
    compare: Annotated[
        Path | None, typer.Option("--compare", metavar="RUN", help="A run to put beside it.")
    ] = None,
    criteria: Annotated[str | None, typer.Option("--criteria", help="imo: MSC.137(76).")] = None,
    errors: Annotated[
        list[str] | None,
        typer.Option("--error", metavar="WHAT=VALUE,...", help="Standard deviations of sensors."),
    ] = None,
) -> None:
    """Show the figures of a manoeuvre; status 1 if a criterion does not hold."""
    _check_criteria(criteria)
    window = (
        -math.inf if start is None else _quantity("from", start, "s"),
        math.inf if end is None else _quantity("to", end, "s"),
    )
    read = _read(log, manoeuvre, read_columns(columns or []), format_name, window, bool(order))
    done = _with(read, length, heading, depth, order or [])
    found = figures_of(done)
    if errors:
        found = with_uncertainty(done, found, read_errors(errors))
    beside = None if compare is None else figures_of(done_in(load_run(compare)))
    verdicts = _verdicts(done, found) if criteria == "imo" else []
    answer.result = {**found.as_dict(), "criteria": [_verdict(each) for each in verdicts]}
    if beside is not None:
        answer.result["compared"] = beside.as_dict()
    _print(found, beside, done.length)
    for each in verdicts:
        style, word = ("green", "PASS") if each.passed else ("red", "FAIL")
        console.print(
            f"[{style}]{word}[/]  {each.ability}: {number(each.value)} {each.unit}, limit "
            f"{number(each.limit)}, margin {number(each.margin)}",
            soft_wrap=True,
        )
    if not all(each.passed for each in verdicts):
        raise typer.Exit(_FAILED)


@trials_app.command()
def page(
    runs: Annotated[list[Path], typer.Argument(help="Run folders, or the folder of a campaign.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder of the page (default: the first).")
    ] = None,
    criteria: Annotated[
        str | None,
        typer.Option("--criteria", help="imo: MSC.137(76), or none (default: by the vehicle)."),
    ] = None,
) -> None:
    """Write one page, and one JSON file, of a vehicle's sea trials; status 1 as for figures."""
    _check_criteria(criteria)
    trials = [evaluated(folder, criteria) for folder in run_folders(runs)]
    folder = runs[0] if out is None else out
    folder.mkdir(parents=True, exist_ok=True)
    path = write_pages(trials, folder)
    lacking = [what for trial in trials for what in failed(trial)]
    answer.result = {"page": str(path), "json": str(path.with_name(DATA)), "failed": lacking}
    console.print(f"page: {path}", soft_wrap=True)
    if lacking:
        console.print(f"FAIL  {', '.join(lacking)}", soft_wrap=True)
        raise typer.Exit(_FAILED)


def _check_criteria(criteria: str | None) -> None:
    if criteria is not None and criteria not in CRITERIA:
        raise InputError(f"--criteria: {unknown('set', criteria, CRITERIA)}")


def _read(
    log: Path,
    manoeuvre: str | None,
    columns: dict[str, Column],
    format_name: str | None,
    window: Window,
    ordered: bool,
) -> Done:
    is_run = (log / MANIFEST).is_file()
    if is_run and (manoeuvre is None or has_component(load_run(log))):
        if manoeuvre is not None or columns or format_name is not None or window != WHOLE:
            raise InputError(
                "--manoeuvre, --columns, --format, --from and --to are for logs: a run has its own"
            )
        return done_in(load_run(log))
    if manoeuvre is None:
        raise InputError(f"--manoeuvre: one of {', '.join(FIGURES)} is needed")
    with reading(log):
        record, notes = read_record(log, columns, format_name, window)
    if record.helm is None and not ordered:
        notes += (
            f"no helm is read: the order is taken to be given at {record.start:g} s, the first "
            "row; --columns helm=NAME:UNIT names its channel, --order the time",
        )
    print_notes(notes)
    return Done(manoeuvre, record)


def _with(
    done: Done, length: str | None, heading: str | None, depth: str | None, orders: list[str]
) -> Done:
    """Return a manoeuvre with what the command line adds. Raises InputError."""
    texts = {"length": (length, "m"), "heading": (heading, "rad"), "depth": (depth, "m")}
    values = {}
    for name, (text, unit) in texts.items():
        if text is not None:
            values[name] = _quantity(name, text, unit)
    if values.get("length", 1.0) <= 0.0:
        raise InputError(f"--length: a length above 0 is needed, found {length!r}")
    times = tuple(_quantity("order", text, "s") for text in orders)
    return replace(done, **values, orders=times or done.orders)  # type: ignore[arg-type]


def _quantity(name: str, text: str, unit: str) -> float:
    try:
        return quantity(text, unit)
    except InputError as error:
        raise InputError(f"--{name}: {error}") from None


def _verdicts(done: Done, found: Figures) -> list[Verdict]:
    if done.length is None:
        raise InputError("--criteria: the length of the ship is needed: --length")
    verdicts = imo({criteria_name(done): found}, done.length, approach_speed_of(done, found))
    if not verdicts:
        raise InputError(
            f"--criteria: MSC.137(76) has none of {criteria_name(done)}, or the record holds no "
            "figure that it limits"
        )
    return verdicts


def _verdict(verdict: Verdict) -> dict[str, object]:
    return {**asdict(verdict), "margin": verdict.margin, "passed": verdict.passed}


def _print(found: Figures, beside: Figures | None, length: float | None) -> None:
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0), title=found.manoeuvre, title_justify="left")
    table.add_column("")
    table.add_column("value", justify="right")
    is_uncertain = any(figure.uncertainty is not None for figure in found.found.values())
    if is_uncertain:
        table.add_column("+-", justify="right")
    table.add_column("unit")
    table.add_column("in lengths", justify="right")
    if beside is not None:
        table.add_column("run", justify="right")
        table.add_column("difference", justify="right")
    for name, figure in found.found.items():
        in_lengths = number(figure.value / length) if length and figure.unit == "m" else ""
        factor, unit = person_scale(figure.unit)
        half = figure.uncertainty
        halves = ["" if half is None else number(factor * half, 2)] if is_uncertain else []
        row = [name, shown_number(factor * figure.value), *halves, unit, in_lengths]
        if beside is not None and name in beside:
            other = beside[name]
            row += [shown_number(factor * other), _difference(figure.value, other)]
        table.add_row(*map(escape, row))
    console.print(table)
    for name, reason in found.missing.items():
        console.print(f"{name} cannot be had: {reason}", soft_wrap=True)
    for note in found.notes:
        console.print(f"note: {note}", soft_wrap=True)


def _difference(value: float, other: float) -> str:
    """Return by how much the run differs, as a share of the log's figure."""
    return "" if shown_number(value) == "0" else f"{100.0 * (other / value - 1.0):+.1f} %"
