"""Waiting in simulated time for something that was received."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from ..api.written import as_duration
from ..model.readable import number
from ..system.rig import duration_ns

if TYPE_CHECKING:
    from ..api.simulation import Simulation

Item = TypeVar("Item")
_SHOWN = 8


class Queue(Generic[Item]):
    """Arrivals from a simulation, in order; `expect` continues behind its last find."""

    def __init__(self, bench: Simulation, shown: Callable[[Item], str]) -> None:
        self.items: list[Item] = []
        """All that has arrived."""
        self._bench, self._shown, self._next = bench, shown, 0

    def expect(self, wanted: Callable[[Item], Any], what: str, within: float | str) -> Any:
        """Step until ``wanted`` of an item is neither None nor False, and return that.

        Looks first at what has arrived since the last one found. Raises AssertionError, with what
        came instead, if nothing is found ``within`` a simulated time from now, s or text.
        """
        __tracebackhide__ = True
        begun, first = self._bench.time, self._next
        end_ns = round(begun * 1e9) + duration_ns(str(as_duration(within)), "within")
        while True:
            while self._next < len(self.items):
                found = wanted(self.items[self._next])
                self._next += 1
                if found is not None and found is not False:
                    return found
            if round(self._bench.time * 1e9) >= end_ns:
                break
            self._bench.step()
        seen = [self._shown(item) for item in self.items[first:]]
        more = f"{len(seen) - _SHOWN} before, " if len(seen) > _SHOWN else ""
        came = more + ", ".join(seen[-_SHOWN:]) if seen else "nothing"
        raise AssertionError(
            f"{what} was not received from {number(begun, 6)} s to "
            f"{number(self._bench.time, 6)} s; received: {came}"
        )
