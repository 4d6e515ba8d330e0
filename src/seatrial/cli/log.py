"""``seatrial log``: the channels of a log, and the quantities that they serve."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from ..model.readable import number
from ..trial.logs.channels import Channel, Log
from ..trial.logs.common_time import GAP
from ..trial.logs.formats import FORMATS, format_of, read_log
from ..trial.logs.quantities import defaults, read_columns
from .answer import answer
from .options import LogColumns, LogFormat
from .show import console, print_notes, print_table


def log(
    path: Annotated[Path, typer.Argument(metavar="LOG", help="A file, a bag or a run folder.")],
    columns: LogColumns = None,
    format_name: LogFormat = None,
) -> None:
    """Show the channels of a log: units, rates, ranges, gaps, and the quantities they serve."""
    named = read_columns(columns or [])
    name = format_name or format_of(path)
    found = read_log(path, name, named.get("time"))
    serving = defaults(found) | {what: column.name for what, column in named.items()}
    serves: dict[str, list[str]] = {}
    for what, channel in serving.items():
        serves.setdefault(channel if channel in found.channels else channel[1:], []).append(what)
    rows = [_described(each, serves.get(each.name, [])) for each in found.channels.values()]
    start, end = _span(found)
    answer.result = {
        "format": name,
        "start": None if found.start is None else found.start.isoformat(),
        "from": start,
        "to": end,
        "channels": rows,
    }
    begun = "" if found.start is None else f", time 0 is {found.start.isoformat()}"
    console.print(
        f"{path}: {FORMATS.load(name).title} ({name}), {number(start)} s to {number(end)} s{begun}",
        soft_wrap=True,
    )
    print_notes(found.notes)
    print_table(_table(rows))


def _span(found: Log) -> tuple[float, float]:
    times = [each.time for each in found.channels.values() if len(each.time)]
    if not times:
        return 0.0, 0.0
    return float(min(map(np.nanmin, times))), float(max(map(np.nanmax, times)))


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
    table.add_column("channel")
    table.add_column("unit")
    for heading in ("values", "rate, Hz", "least", "most", "gaps"):
        table.add_column(heading, justify="right")
    table.add_column("serves")
    for row in rows:
        numbers = [row[key] for key in ("values", "rate", "least", "most", "gaps")]
        shown = ["" if each is None else number(float(each)) for each in numbers]  # type: ignore[arg-type]
        cells = [str(row["name"]), str(row["unit"] or ""), *shown, ", ".join(row["serves"])]  # type: ignore[arg-type]
        table.add_row(*map(escape, cells))
    return table
