"""The last change from outside, for the message of a simulation that could not go on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..errors import SimulationError
from ..model.component import NS
from .network import Network


class LastChange:
    """The last thing that an event, a fault or a program changed, or somebody ordered over a link.

    Links publish their orders on an output with the role ``order``: the time in s, then the order.
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self._at, self._what = -1.0, ""

    def note(self, t_ns: int, what: str) -> None:
        """Note what has changed at a time."""
        self._at, self._what = t_ns / NS, what

    def note_set(self, t_ns: int, component: str, names: Sequence[str], values: Any) -> None:
        """Note the values that ports were set to; where the run's folder is changes nothing."""
        variables = self._network.system.parts[component].instance.variables
        if any(variables[name].role != "run-folder" for name in names):
            ports = ", ".join(f"{component}.{name}" for name in names)
            self.note(t_ns, f"{ports} set to {', '.join(map(repr, values))}")

    def tell(self, error: SimulationError) -> None:
        """Add the last change, if there was one, to an error's message."""
        at, what = max([(self._at, self._what), *self._orders()], key=lambda one: one[0])
        if what and what not in str(error):
            error.args = (f"{error}\n(last changed from outside: {what}, at t = {at!r} s)",)

    def _orders(self) -> list[tuple[float, str]]:
        found = []
        for component, part in self._network.system.parts.items():
            for name in part.instance.variables.of_role("order"):
                shown = str(self._network.signals[self._network.places[component, name]])
                time, _, order = shown.partition(" ")
                if order:
                    found.append((float(time), f"{component} was ordered {order}"))
        return found
