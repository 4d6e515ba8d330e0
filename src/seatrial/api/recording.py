"""Recordings: what signals did while a simulation was stepped."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

from .arrays import SignalArray
from .signal import Signal
from .signals import Signals


class _Timed(Protocol):
    """Source of a record, with its simulated time, s."""

    @property
    def time(self) -> float: ...


class Recording:
    """Signals at every communication point since `Simulation.record`.

    An observer like any other: `Simulation.unobserve` ends it. A restored simulation appends to
    it too, so that its time may go back.
    """

    def __init__(self, described: Sequence[Signal], read: Callable[[], list[Any]]) -> None:
        self._described = {signal.name: signal for signal in described}
        self._times: list[float] = []
        self._rows: list[list[Any]] = []
        self._read = read

    def __call__(self, simulation: _Timed) -> None:
        """Append a row."""
        self._times.append(simulation.time)
        self._rows.append(self._read())

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def signals(self) -> Signals:
        """Signals recorded so far, as the arrays of a run's result.

        Bytes are of the type object.
        """
        import numpy as np

        columns = dict(zip(self._described, zip(*self._rows, strict=True), strict=True))

        def column(name: str) -> SignalArray:
            signal = self._described[name]
            types = {float: np.float64, int: np.int64, bool: np.bool_}
            kind: type[Any] = types.get(signal.type, np.object_)
            return SignalArray(np.array(columns[name], dtype=kind), signal.unit, signal.description)

        times = SignalArray(np.array(self._times), "s", "simulated time")
        return Signals(list(self._described), times, column)
