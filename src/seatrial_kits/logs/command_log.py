"""``seatrial log``: the channels of a log, and the quantities that they serve."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from seatrial.cli.answer import answer
from seatrial.cli.options import LogColumns, LogFormat
from seatrial.cli.show import console, print_notes, print_table
from seatrial.model.readable import number
from seatrial.trial.logs.channels import Channel
from seatrial.trial.logs.formats import FORMATS, format_of, read_log
from seatrial.trial.logs.quantities import defaults, read_columns, series

from .paired.common_time import GAP
from .paired.steady_clock import from_zero, steady
from .reading import reading

_MOST_SHOWN = 40
"""Channels of a log that are all shown."""


def log(
    path: Annotated[Path, typer.Argument(metavar="LOG", help="A file, a bag or a run folder.")],
    columns: LogColumns = None,
    format_name: LogFormat = None,
    every: Annotated[
        bool, typer.Option("--all", help="Show channels that serve no quantity, of many too.")
    ] = False,
) -> None:
    """Show the channels of a log: units, rates, ranges, gaps, and the quantities they serve."""
    named = read_columns(columns or [])
    name = format_name or format_of(path)
    with reading(path):
        found = from_zero(steady(read_log(path, name, named.pop("time", None))))
    serves: dict[str, list[str]] = {}
    for what, column in {**defaults(found), **named}.items():
        serves.setdefault(series(found, what, column).channel.name, []).append(what)
    serving = {channel: found.channels[channel] for channel in serves} or found.channels
    start, end = _span(serving.values())
    first = [*serving, *(channel for channel in found.channels if channel not in serving)]
    rows = [_described(found.channels[channel], serves.get(channel, [])) for channel in first]
    answer.result = {
        "format": name,
        "start": None if found.start is None else found.start.isoformat(),
        "from": start,
        "to": end,
        "channels": rows,
    }
    begun = "" if found.start is None else f", time 0 is {found.start.isoformat()}"
    title = f"{FORMATS.load(name).title} ({name})"
    console.print(
        f"{path}: {title}, from {number(start)} s to {number(end)} s{begun}", soft_wrap=True
    )
    print_notes(found.notes)
    shown = len(rows) if every or len(rows) <= _MOST_SHOWN else len(serving)
    print_table(_table(rows[:shown]))
    if shown < len(rows):
        console.print(f"{len(rows) - shown} more channels: --all shows them", soft_wrap=True)


def _span(channels: Iterable[Channel]) -> tuple[float, float]:
    times = [each.time for each in channels if len(each.time)] or [np.zeros(1)]
    return min(float(each[0]) for each in times), max(float(each[-1]) for each in times)


def _described(channel: Channel, serves: list[str]) -> dict[str, object]:
    finite = channel.values[np.isfinite(channel.values)]
    steps = np.diff(channel.time)
    usual = float(np.median(steps)) if len(steps) else 0.0
    return {
        "name": channel.name,
        "unit": channel.unit,
        "values": len(channel.values),
        "rate": 1.0 / usual if usual > 0.0 else None,
        "least": float(finite.min()) if len(finite) else None,
        "most": float(finite.max()) if len(finite) else None,
        "gaps": int(np.count_nonzero(steps > GAP * usual)) if usual > 0.0 else 0,
        "serves": serves,
    }


def _table(rows: list[dict[str, object]]) -> Table:
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("channel", no_wrap=True)
    table.add_column("unit")
    for heading in ("values", "rate, Hz", "least", "most", "gaps"):
        table.add_column(heading, justify="right")
    table.add_column("serves", overflow="fold")
    for row in rows:
        numbers = [row[key] for key in ("values", "rate", "least", "most", "gaps")]
        shown = ["" if each is None else number(float(each)) for each in numbers]  # type: ignore[arg-type]
        cells = [str(row["name"]), str(row["unit"] or ""), *shown, ", ".join(row["serves"])]  # type: ignore[arg-type]
        table.add_row(*map(escape, cells))
    return table
