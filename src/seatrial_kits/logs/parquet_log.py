"""Parquet files as logs: columns with units in the fields' metadata, or in their names."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.trial.logs.channels import Array, Channel, Log, channel, empty_cells
from seatrial.trial.logs.clock_times import date_of
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import QUANTITIES, Column, times_of

from .parquet_file import TIME
from .run_log import of_craft

_MAGIC = b"PAR1"
_WITH_UNIT = re.compile(r"(.+?)\s*[\[(]([^\[\]()]+)[\])]")


def _read(path: Path, time: Column | None) -> Log:
    """Return the log in a Parquet file: its columns of numbers and flags.

    The time is the column ``time`` or ``time_ns`` unless another is named: a number with a unit, in
    s without one, or a timestamp, from the first on. The unit of a column is ``unit`` in its
    metadata, or in its name, ``name [unit]``. Empty cells are no numbers.

    Raises InputError for a file that is not Parquet, or without a column of the time, and if
    pyarrow is missing.
    """
    import pyarrow as pa
    from pyarrow import parquet

    try:
        table = parquet.read_table(path)
        names, columns = [_name_and_unit(field) for field in table.schema], table.columns
    except (pa.ArrowException, OSError, ValueError) as error:
        raise InputError(f"{path}: not Parquet: {error}") from None
    rows = np.arange(table.num_rows, dtype=np.float64)
    channels: dict[str, Channel] = {}
    dates: dict[str, Array] = {}
    for (name, unit), field, column in zip(names, table.schema, columns, strict=True):
        if pa.types.is_timestamp(field.type):
            dates[name] = column.cast(pa.timestamp("ns")).cast(pa.int64()).to_numpy() / 1e9
        elif (
            pa.types.is_integer(field.type)
            or pa.types.is_floating(field.type)
            or (pa.types.is_boolean(field.type))
        ):
            values = column.cast(pa.float64()).to_numpy()
            channels[name] = channel(name, unit, rows, values)
    craft = of_craft(channels)
    served = {what: [what, *craft.get(what, ())] for what in QUANTITIES}
    log = Log(path, channels, served, notes=tuple(empty_cells(channels)), row="row", table=True)
    return _timed(log, time or _time_column({*channels, *dates}), dates)


def _time_column(names: set[str]) -> Column:
    return Column(next((name for name in ("time", TIME) if name in names), "time"))


def _timed(log: Log, time: Column, dates: dict[str, Array]) -> Log:
    """Return the log with the times of one of its columns."""
    start = None
    if time.name in dates:
        moments = dates[time.name]
        seconds = moments - moments[0] if len(moments) else moments
        start = date_of(float(moments[0])) if len(moments) else None
    elif time.name not in log.channels:
        names = [*log.channels, *dates]
        raise InputError(
            f"{log.path}: time: {unknown('column', time.name, names)}; --columns time=NAME names it"
        )
    else:
        found = len(log.channels[time.name].time) > 0
        # To the nanosecond: what was written as whole ones reads back so.
        seconds = np.round(times_of(log, time), 9) if found else np.empty(0)
    channels = {name: replace(each, time=seconds) for name, each in log.channels.items()}
    return replace(log, channels=channels, start=start)


def _name_and_unit(field: Any) -> tuple[str, str | None]:
    written = (field.metadata or {}).get(b"unit")
    if written:
        return field.name, written.decode("utf-8", "replace")
    match = _WITH_UNIT.fullmatch(field.name)
    return (match[1], match[2]) if match else (field.name, None)


PARQUET = Format("Parquet", lambda path, head: head.startswith(_MAGIC), _read, table=True)
