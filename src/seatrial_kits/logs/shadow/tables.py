"""The table that plays a log's traces into a system."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from seatrial.files.whole_file import write_whole
from seatrial.fmi.components.stored_table import write_stored
from seatrial.fmi.components.table_file import LARGEST
from seatrial.model.component import NS
from seatrial.trial.logs.channels import Array

from ..paired.common_time import Window
from ..paired.resampling import Trace
from ..played import rows_of

TABLE, LONG_TABLE = "log.csv", "log.table"


def write_table(traces: Mapping[str, Trace], window: Window, folder: Path, step_ns: int) -> Path:
    """Write traces in a window, which becomes the time 0, as a table of values; return its path.

    The rows are at all entries of all, between which values are linear, or held; where a system
    with steps of ``step_ns`` looks less often, at its steps. A trace with gaps has a switch
    NAME_valid. A long table is one of binary columns.
    """
    times = rows_of(traces.values(), window)
    since = times - window[0]
    steps = int((window[1] - window[0]) * NS + 1) // step_ns + 1
    if steps < len(times):
        since = np.arange(steps) * step_ns / NS
        times = np.minimum(window[0] + since, window[1])
    columns: list[tuple[str, str, str, str, Array]] = []
    for name, each in traces.items():
        values, known = each.at(times)
        how = "held" if each.held else "linear"
        columns.append((name, "real", each.unit or "1", how, values))
        if not known.all():
            columns.append((f"{name}_valid", "boolean", "1", "held", known.astype(float)))
    if len(times) * (len(columns) + 1) * 10 > LARGEST:
        ticks = np.round(since * NS).astype(np.int64)
        write_stored(folder / LONG_TABLE, TABLE, ticks, columns)
        return folder / LONG_TABLE
    write_whole(folder / TABLE, _csv(since, columns))
    return folder / TABLE


def _csv(times: Array, columns: Sequence[tuple[str, str, str, str, Array]]) -> str:
    words = {"real": "", "boolean": " boolean"}
    heads = [
        f"{name} [{unit}{words[kind]}{' held' if how == 'held' else ''}]"
        for name, kind, unit, how, _ in columns
    ]
    cells = [
        values.tolist() if kind == "real" else np.where(values > 0.0, "true", "false").tolist()
        for _, kind, _, _, values in columns
    ]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time [s]", *heads])
    writer.writerows(zip(times.tolist(), *cells, strict=True))
    return text.getvalue()
