"""Links that were lost in a run: when, for how long, and how often they came back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from ...errors import SimulationError
from ...links.hardware import devices_allowed
from ...model.component import seconds
from ...sim.master import Master


def watched(master: Master) -> list[tuple[str, int, int]]:
    """Return components with links, and the places of their two signals: is lost, came back."""
    places = {name: place for place, name in enumerate(master.names)}
    return [
        (name, places[name, lost], places[name, back])
        for name, part in master.system.parts.items()
        for lost in part.instance.variables.of_role("link-lost")
        for back in part.instance.variables.of_role("reconnections")
    ]


@dataclass
class _Loss:
    """Simulated times, s."""

    first_at: float
    lost_s: float = 0.0
    reconnections: int = 0


class LostLinks:
    """Watches the components of a run that have links.

    A lost link ends a run that may reach devices, unless it is to ``keep_going``.
    """

    def __init__(self, master: Master, keep_going: bool) -> None:
        self._master, self._watched = master, watched(master)
        self._ends = devices_allowed() and not keep_going
        self._losses: dict[str, _Loss] = {}
        self._looked_ns = master.time_ns

    def look(self) -> None:
        """Look at a communication point. Raises SimulationError for a loss that ends the run."""
        signals = self._master.signals
        for name, lost, back in self._watched:
            if signals[lost]:
                self._is_lost(name)
            if signals[back]:
                loss = self._losses.setdefault(name, _Loss(self._master.time))
                loss.reconnections = int(signals[back])
        self._looked_ns = self._master.time_ns

    def notes(self) -> list[str]:
        """Return a line for each component that lost a link."""
        return [
            f"{name}: a link was lost at t = {loss.first_at:g} s, for {loss.lost_s:g} s in all; "
            f"it came back {loss.reconnections} times"
            for name, loss in self._losses.items()
        ]

    def as_json(self) -> dict[str, Any]:
        """Return what ``timing.json`` says of them."""
        return {name: asdict(loss) for name, loss in self._losses.items()}

    # ------------------------------------------------------------------ inside

    def _is_lost(self, name: str) -> None:
        master = self._master
        if name not in self._losses:
            self._losses[name] = _Loss(master.time)
        else:
            self._losses[name].lost_s += seconds(master.time_ns - self._looked_ns)
        if self._ends:
            raise SimulationError(
                f"{name}: a link is lost at t = {master.time!r} s{_reached(master, name)} "
                "(--keep-going goes on without it)"
            )


def lost_links(timing: Mapping[str, Any]) -> list[str]:
    """Return a sentence for each component that lost a link, of a run's ``timing.json``."""
    return [
        f"{name} lost a link at t = {loss['first_at']:g} s, for {loss['lost_s']:g} s in all; it "
        f"came back {loss['reconnections']} times."
        for name, loss in timing.get("lost_links", {}).items()
    ]


def _reached(master: Master, name: str) -> str:
    """Return where the links of a component lead, as far as it says so."""
    instance = master.system.parts[name].instance
    for port in instance.variables.of_role("address"):
        if where := instance.reader([port])()[0]:
            return f": {where}"
    return ""
