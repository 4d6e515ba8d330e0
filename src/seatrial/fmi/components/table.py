"""Tables of values over time as components: what plays a CSV or Parquet file in a rig."""

from __future__ import annotations

import json
from bisect import bisect_right
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, ClassVar

from ...errors import InputError
from ...model.component import Component, Output, Parameter, seconds
from .stored_table import stored_columns

TYPES = {"real": float, "integer": int, "boolean": bool, "text": str}


class Table(Component):
    """Plays the columns of a file as outputs, by the simulated time.

    Between two rows at t0 and t1, a real column has the value v0 + (v1 - v0) (t - t0) / (t1 - t0);
    columns of integers, switches and texts, and real ones that are held, have v0. Of several rows
    of one time the last holds from that time on, so that two of them are a jump.

    Before the first row and after the last, ``beyond`` = hold keeps their values; repeat plays the
    rows again and again, the first following at the time of the last. Else raises InputError there.
    """

    _times_ns: ClassVar[Sequence[int]] = ()
    """Of the rows, which do not go back."""
    _columns: ClassVar[Sequence[tuple[Sequence[Any], bool]]] = ()
    """Values of each output by row, and whether they are interpolated."""
    _file: ClassVar[str] = ""
    """What the rows are from, for messages."""

    beyond = Parameter(
        "error", "1", "before the first row and after the last", choices=("error", "hold", "repeat")
    )

    def outputs(self, t: float) -> None:
        """Publish the values at ``t``."""
        times, now = self._times_ns, self.now_ns
        if not times[0] <= now <= times[-1]:
            if self.beyond == "error":
                self._refuse_beyond()
            if self.beyond == "repeat" and times[-1] > times[0]:
                now = times[0] + (now - times[0]) % (times[-1] - times[0])
        row = max(0, bisect_right(times, now) - 1)
        if row + 1 == len(times) or now <= times[row]:
            found = [values[row] for values, _ in self._columns]
        else:
            share = (now - times[row]) / (times[row + 1] - times[row])
            found = [
                v[row] + (v[row + 1] - v[row]) * share if interpolated else v[row]
                for v, interpolated in self._columns
            ]
        self.values[-len(found) :] = found

    def _refuse_beyond(self) -> None:
        first, last = seconds(self._times_ns[0]), seconds(self._times_ns[-1])
        raise InputError(
            f"{self.name}: t = {self.now!r} s is beyond the rows of {self._file}, from "
            f'{first!r} s to {last!r} s; beyond = "hold" holds its first and last values, "repeat" '
            "plays them again"
        )


@lru_cache(maxsize=64)
def table_component(text: str) -> type[Table]:
    """Return the component that plays a table, as `frozen_table` and `stored_head` have it."""
    content = json.loads(text)
    if "stored" in content:
        content["times_ns"], content["columns"] = stored_columns(content)
    outputs = {
        name: Output(unit, f"column of {content['file']}", type=TYPES[kind])
        for name, kind, unit, _, _ in content["columns"]
    }
    for name, output in outputs.items():
        output.name = name
    columns = [(values, held == "linear") for _, _, _, held, values in content["columns"]]
    own = {
        "__doc__": f"Table of values over time, of {content['file']}.",
        "__module__": __name__,
        "_times_ns": content["times_ns"],
        "_columns": columns,
        "_file": content["file"],
        "feedthrough": dict.fromkeys(outputs, ()),
    }
    return type("FileTable", (Table,), {**own, **outputs})


RESERVED = frozenset((*dir(Table), "name", "values"))
"""Names that a column cannot have: attributes of the component."""
