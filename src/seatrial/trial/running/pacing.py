"""A run in real time: steps that are presented when they are due."""

from __future__ import annotations

import math
from collections.abc import Callable

from ...errors import SimulationError
from ...model.component import NS
from ...sim.clock import Pacer
from ...sim.master import Master
from ..files.trial_file import RealTimeEntry

_LEAST_FACTOR = 1e-9


class Pace:
    """Steps of a master at the pace that a trial asks for.

    Where the factor is a signal, its value at a communication point is that of the step from
    there on. Wall time by which the signal ``paused`` grows in a step is excluded.
    """

    def __init__(self, entry: RealTimeEntry, master: Master) -> None:
        places = {".".join(name): place for place, name in enumerate(master.names)}
        self._master = master
        self._factor = entry.factor
        self._factor_place = places[entry.factor] if isinstance(entry.factor, str) else None
        self._paused_place = places[entry.paused] if entry.paused is not None else None
        self.pacer = Pacer(1.0 if isinstance(entry.factor, str) else entry.factor, entry.overrun)

    def start(self) -> None:
        """Start the clock. Raises SimulationError for a signal that is no factor."""
        self._paused = self._paused_s()
        self.pacer.factor = self._wanted()
        self.pacer.start(self._master.time_ns)

    def step(self, stop_requested: Callable[[], int]) -> None:
        """Take a step and wait until its end is due, or a stop is requested.

        Raises SimulationError if the step is late and must not be, or for a signal that is no
        factor.
        """
        master, pacer = self._master, self.pacer
        pacer.change(self._wanted(), master.time_ns)
        before = {name: times.total_ns for name, times in master.step_times.items()}
        master.step()
        paused = self._paused_s()
        pacer.pause(round((paused - self._paused) * NS))
        self._paused = paused
        lateness = pacer.keep(master.time_ns, stop_requested)
        if lateness and pacer.policy == "abort":
            spent = {name: t.total_ns - before[name] for name, t in master.step_times.items()}
            slowest = max(spent, key=spent.__getitem__)
            raise SimulationError(
                f"at t = {master.time!r} s the step ended {lateness / 1e6:.3g} ms after its "
                f"deadline in real time (factor {pacer.factor:g}, overrun = 'abort'); {slowest} "
                f"took longest, {spent[slowest] / 1e6:.3g} ms"
            )

    def _wanted(self) -> float:
        """Return the factor of the step from here on."""
        if self._factor_place is None:
            return self.pacer.factor
        factor = float(self._master.signals[self._factor_place])
        if not _LEAST_FACTOR <= factor < math.inf:
            raise SimulationError(
                f"real_time.factor: {self._factor} is {factor!r} at t = {self._master.time!r} s, "
                f"at least {_LEAST_FACTOR:g} is needed"
            )
        return factor

    def _paused_s(self) -> float:
        if self._paused_place is None:
            return 0.0
        return float(self._master.signals[self._paused_place])
