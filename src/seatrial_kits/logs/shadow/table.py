"""The table of values over time that a log becomes."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from seatrial.errors import InputError
from seatrial.fmi.components.table_file import LARGEST
from seatrial.trial.logs.common_time import Window
from seatrial.trial.logs.resampling import Trace
from seatrial.whole_file import write_whole

from ..played import rows_of


def window_of(traces: Mapping[str, Trace], needed: list[str], window: Window, where: str) -> Window:
    """Return the part of the log's time, s, in which the traces ``needed`` have values.

    Raises InputError for traces without a time in common.
    """
    kept = [traces[name] for name in needed] or list(traces.values())
    first = max(window[0], *(float(each.time[0]) for each in kept))
    last = min(window[1], *(float(each.time[-1]) for each in kept))
    if first >= last:
        spans = "; ".join(
            f"{each.name}: {each.time[0]:g} s to {each.time[-1]:g} s" for each in kept
        )
        raise InputError(f"{where}: no time is common to {spans}")
    return first, last


def write_table(traces: Mapping[str, Trace], window: Window, path: Path, where: str) -> None:
    """Write traces in a window, which becomes the time 0, as a table of values over time.

    The rows are at all entries of all, between which values are linear, or held. A trace with gaps
    has a switch NAME_valid. Raises InputError, with ``where``, for one too large to be played.
    """
    times = rows_of(traces.values(), window)
    heads, columns = ["time [s]"], [(times - window[0]).tolist()]
    for name, each in traces.items():
        values, known = each.at(times)
        held = " held" if each.held else ""
        heads.append(f"{name} [{each.unit or '1'}{held}]")
        columns.append(values.tolist())
        if not known.all():
            heads.append(f"{name}_valid [boolean]")
            columns.append(np.where(known, "true", "false").tolist())
    if len(times) * len(columns) * 10 > LARGEST:
        raise InputError(
            f"{where}: {len(times)} rows of {len(columns)} columns are too many to be played; "
            "--from and --to take a part"
        )
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows(zip(*columns, strict=True))
    write_whole(path, text.getvalue())
