"""The simulation's end of a live page: frames out, commands in, pause and pace.

It stands in the process of the run. A frame goes out when the page has taken the one before, at
most 30 times a second of wall time; what the page is too slow for is never sent, and the simulation
waits for nothing but its own pace. Without a viewer nothing goes out: who comes later sees what was
before from the record.
"""

from __future__ import annotations

import contextlib
import json
import math
import time
from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.instance import Variable
from seatrial.model.component import seconds
from seatrial.sim.actions import action
from seatrial.sim.clock import Pacer
from seatrial.sim.fault_schedule import Fault
from seatrial.sim.faults import resolved
from seatrial.sim.master import Master
from seatrial.system.fault_entry import FaultEntry
from seatrial.system.files import validated
from seatrial.system.system import System
from seatrial.trial.running.lost_links import watched

_FRAME_S = 1.0 / 30.0
"""Least wall time between two frames."""
_LOOK_S = 1.0 / 60.0
_ORIGIN = "the page"


@dataclass
class Tap:
    """Observer of a run, see `trial.running.hooks.Observer`. ``pipe`` leads to the page."""

    pipe: Connection
    may_command: bool
    factor: float | None = 1.0
    """Simulated seconds per second, None as fast as it can; of a trial that is not in real time."""
    stops: bool = False
    """The page wants the run to stop, to begin anew."""
    _paused: bool = False
    _viewers: int = 0
    _taken: bool = True
    _steps: int = 0
    _next_look: float = 0.0
    _next_frame: float = 0.0
    _lost: list[str] = field(default_factory=list)
    _faults: dict[int, Fault] = field(default_factory=dict)

    def begin(
        self, manifest: Mapping[str, Any], master: Master, pacer: Pacer | None, folder: Path
    ) -> None:
        """Tell the page what there is."""
        self._master, self._of_trial = master, pacer
        numbers = [i for i, value in enumerate(master.signals) if isinstance(value, int | float)]
        self._numbers = numbers
        self._links = [(name, place) for name, place, _ in watched(master)]
        self._own: Pacer | None = None
        self._changed_pace(self.factor)
        described = {
            "manifest": json.loads(json.dumps(manifest)),
            "folder": str(folder),
            "signals": [".".join(master.names[i]) for i in numbers],
            "settables": settables_of(master.system, master),
            "orders": orders_of(master.system, master),
            "paced": pacer is not None,
            "pace": self.factor,
            "step": seconds(master.step_ns),
        }
        self.pipe.send(("begin", described))

    def at_point(self, stop_requested: Callable[[], int]) -> None:
        """Look at the page between two steps; stay here as long as it wants a pause."""
        if self._own is not None:
            self._own.keep(self._master.time_ns, lambda: stop_requested() or self._looked())
        if time.perf_counter() >= self._next_look:
            self._look()
        signals = self._master.signals
        lost = [name for name, place in self._links if signals[place]] if self._links else []
        if lost != self._lost:
            self._lost = lost
            self._send("links", seconds(self._master.time_ns), lost)
        if not self._paused:
            return
        if self._steps:
            self._steps -= 1
        else:
            self._wait(stop_requested)

    # ------------------------------------------------------------------ inside

    def _wait(self, stop_requested: Callable[[], int]) -> None:
        begun = time.monotonic_ns()
        self._send_frame()
        while self._paused and not (self._steps or self.stops or stop_requested()):
            with contextlib.suppress(OSError):
                self.pipe.poll(_LOOK_S)
            self._look()
        self._steps = max(self._steps - 1, 0)
        for pacer in (self._own, self._of_trial):
            if pacer is not None:
                pacer.pause(time.monotonic_ns() - begun)

    def _looked(self) -> int:
        """Look at the page while a step waits; say whether it waits no longer."""
        self._look()
        return int(self._paused or self.stops or self._own is None)

    def _look(self) -> None:
        now = time.perf_counter()
        self._next_look = now + _LOOK_S
        try:
            while not self._steps and self.pipe.poll(0):  # what follows a step comes after it
                self._heed(*self.pipe.recv())
        except (EOFError, OSError):
            self._gone()
            return
        if self._viewers and self._taken and now >= self._next_frame:
            self._send_frame()

    def _send_frame(self) -> None:
        self._next_frame = time.perf_counter() + _FRAME_S
        self._taken = False
        signals = self._master.signals
        values = array("d", [signals[i] for i in self._numbers]).tobytes()
        self._send("frame", self._master.time, values)

    def _send(self, *message: Any) -> None:
        try:
            self.pipe.send(message)
        except OSError:
            self._gone()

    def _gone(self) -> None:
        """Go on alone, without a look at what is no longer there."""
        self._viewers, self._taken, self._paused = 0, False, False
        self._next_look = math.inf

    def _heed(self, what: str, *content: Any) -> None:
        if what == "taken":
            self._taken = True
            return
        if what == "viewers":
            (self._viewers,) = content
            return
        if not self.may_command:
            self._send("refused", "this page only watches")
            return
        try:
            getattr(self, f"_heed_{what}")(*content)
        except (InputError, SimulationError) as error:
            self._send("refused", str(error))

    def _heed_pause(self, wanted: bool) -> None:
        self._paused = wanted

    def _heed_step(self) -> None:
        self._paused, self._steps = True, self._steps + 1

    def _heed_stop(self) -> None:
        self.stops = True

    def _heed_speed(self, factor: float | None) -> None:
        self._changed_pace(factor)

    def _heed_set(self, key: str, written: Any) -> None:
        action(self._master.system, "set", key, written, _ORIGIN).apply(self._master)
        self._done("set", key, written)

    def _heed_fault(self, number: int, written: dict[str, Any]) -> None:
        entry = validated(FaultEntry, written, Path(_ORIGIN))
        schedule = self._master.faults
        place, now = len(schedule.faults), self._master.time_ns
        fault = resolved(self._master.system, entry, place, now, _ORIGIN)
        schedule.add(fault)
        schedule.act(self._master)
        self._faults[number] = fault
        self._done("fault", number, written)

    def _heed_clear(self, number: int) -> None:
        fault = self._faults.pop(number, None)
        if fault is not None:
            self._master.faults.end(self._master, fault)
            self._done("clear", number, None)

    def _done(self, what: str, key: Any, written: Any) -> None:
        self._send("done", seconds(self._master.time_ns), what, key, written)

    def _changed_pace(self, factor: float | None) -> None:
        """Keep to a pace of the page's own; a trial in real time has its own."""
        if self._of_trial is not None:
            return
        if factor is None:
            self._own = None
        elif self._own is None:
            self._own = Pacer(factor, "slip")
            self._own.start(self._master.time_ns)
        else:
            self._own.change(factor, self._master.time_ns)


_HELM = ("mode", "armed", "manual")
"""Members of the terminal ``orders`` by which a person takes a pilot's helm."""


def settables_of(system: System, master: Master) -> list[dict[str, Any]]:
    """Return the numbers and switches that can be set at any time, with unit, limits, value.

    They are inputs that nothing feeds and tunable parameters that nothing feeds, scalar by scalar.
    """
    found = []
    for name, part in system.parts.items():
        fed = system.feeders(name)
        own = [
            v
            for v in part.instance.variables.values()
            if v.type in (float, int, bool)
            and v.name not in fed
            and v.role != "fault"
            and (v.causality == "input" or v.variability == "tunable")
        ]
        values = master.values(name, [v.name for v in own]) if own else []
        found += [_entry(name, v, value) for v, value in zip(own, values, strict=True)]
    return found


def _entry(component: str, variable: Variable, value: Any) -> dict[str, Any]:
    limits = [variable.minimum, variable.maximum]
    return {
        "key": f"{component}.{variable.name}",
        "unit": variable.unit,
        "limits": [x if x is not None and math.isfinite(x) else None for x in limits],
        "value": value,
        "is_switch": variable.type is bool,
        "description": variable.description,
    }


def orders_of(system: System, master: Master) -> list[dict[str, Any]]:
    """Return the pilots whose helm a person can take: what their orders are written to.

    ``fed`` has the members that something else orders, which a fault of the kind fixed replaces
    as long as somebody has the helm; ``before`` has mode and arming as the rig starts.
    """
    found = []
    for name, part in system.parts.items():
        orders = part.instance.terminals.get("orders")
        if orders is None or not all(member in orders.members for member in _HELM):
            continue
        ports = {member: orders.members[member] for member in _HELM}
        variables = part.instance.variables
        scalars = variables.ports.get(ports["manual"], [])
        mode = variables.get(ports["mode"])
        if len(scalars) < 2 or mode is None or mode.causality != "input":
            continue
        fed = system.feeders(name)
        own = [ports["mode"], ports["armed"]]
        first = {**ports, "manual": scalars[0].name}
        found.append(
            {
                "component": name,
                "ports": ports,
                "axes": [scalar.name.rpartition(".")[2] for scalar in scalars],
                "fed": [member for member in _HELM if first[member] in fed],
                "before": dict(zip(("mode", "armed"), master.values(name, own), strict=True)),
            }
        )
    return found
