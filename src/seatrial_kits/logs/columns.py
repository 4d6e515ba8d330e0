"""Signals of a log on one time axis, made as they are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from seatrial.trial.logs.channels import Array

from .paired.resampling import Trace

WHOLE = slice(None)


class Columns(Mapping[str, Array]):
    """Traces at ``time`` (n,), s, by name; of a long log, they are not in memory together.

    A trace whose own times are these is not copied.
    """

    def __init__(self, time: Array) -> None:
        self._time = time
        self._traces: dict[str, tuple[Trace | None, bool]] = {}
        self._at_own: set[int] = set()

    def add(self, name: str, each: Trace) -> float:
        """Add a trace; return the share of the times at which it is known."""
        self._traces[name] = each, False
        if len(each.time) == len(self._time) and np.array_equal(each.time, self._time):
            self._at_own.add(id(each))
            return 1.0
        return float(np.mean(each.at(self._time)[1]))

    def add_switch(self, name: str, each: Trace) -> None:
        """Add whether a trace is known."""
        self._traces[name] = each, True

    def add_zero(self, name: str) -> None:
        """Add a signal that is 0."""
        self._traces[name] = None, False

    def rows(self, name: str, rows: slice) -> Array:
        """Return some rows of a signal; of a switch 0 and 1."""
        each, is_switch = self._traces[name]
        if each is None:
            return np.zeros(len(self._time[rows]))
        if id(each) in self._at_own:
            return each.values[rows]
        values, known = each.at(self._time[rows])
        return known.astype(float) if is_switch else values

    def __getitem__(self, name: str) -> Array:
        return self.rows(name, WHOLE)

    def __iter__(self) -> Iterator[str]:
        return iter(self._traces)

    def __len__(self) -> int:
        return len(self._traces)
