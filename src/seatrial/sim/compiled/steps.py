"""Steps that `master.c` takes, with what Python keeps brought up to date before and after."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from ...fmi.messages import ACCEPTED, said
from ..algorithms import Algorithm
from ..divergence import DivergenceWatch
from ..feedthrough import Feedthrough
from ..instants import interval
from ..network import ANY_QUANTITY, Network
from .library import library
from .program import Program
from .rows import Rows
from .structures import (
    ANSWERED,
    ASKED,
    CALLED,
    DIVERGED,
    DONE,
    EXCESS,
    STEP,
    UNSETTLED,
    Master,
    Operation,
    Pace,
    Times,
)


class CompiledSteps:
    """Takes communication steps of one length; `Network` and all others know of it afterwards."""

    def __init__(
        self,
        network: Network,
        feedthrough: Feedthrough,
        algorithm: Algorithm,
        watch: DivergenceWatch,
        step_ns: int,
    ) -> None:
        self._network, self._feedthrough = network, feedthrough
        self._watch, self.step_ns = watch, step_ns
        self._library = library()
        self._program = Program(network, feedthrough, step_ns)
        self._program.add_step(algorithm)
        self.is_current = False
        """Whether C has what Python has: not after a step or a change that was Python's."""
        self.taken = 0
        """Steps that were taken whole when `take` ended, however it did."""
        self.ends = False
        """Whether an FMU has asked for the end."""
        operations = self._program.operations
        self._operations = (Operation * len(operations))(*operations)
        self._signals = (ctypes.c_double * max(1, len(network.signals)))()
        self._numbers = _ranges(network.signals)
        self._paces = (Pace * max(1, len(watch.paces)))(*map(_pace, watch.paces))
        self._slaves = {id(s): s for s, _ in self._program.asked.values()}
        self._master = Master(
            operations=self._operations,
            count=len(operations),
            signals=self._signals,
            step_ns=step_ns,
            said=ctypes.pointer(said),
            paces=self._paces,
            pace_count=len(watch.paces),
            any_quantity=ANY_QUANTITY,
        )
        for node in network.nodes.values():
            marks = getattr(node.part.instance, "marks", None)
            if marks is not None:
                self._master.cells, self._master.times = marks.address, marks.address
        self._handlers: dict[int, Callable[[int], None]] = {
            ANSWERED: self._answered,
            EXCESS: self._exceeded,
            UNSETTLED: self._unsettled,
            CALLED: self._called,
        }

    def take(self, steps: int, t_ns: int, count: int, rows: Rows | None) -> int:
        """Take up to ``count`` steps from ``t_ns``, the ``steps``-th; return how many.

        It ends before where somebody asks for a stop or an FMU for the end. ``rows`` gets the
        points in between. Raises SimulationError, DiscardError as the algorithm does; ``taken``
        has what was taken whole.
        """
        assert self._library is not None
        master, self.taken, self.ends = self._master, 0, False
        if not self.is_current:
            self._push()
        self.is_current = False
        master.steps, master.begin_ns, master.at = steps, t_ns, 0
        until = steps + count
        if rows is None:
            master.row_every = 0
        else:
            rows.attach(master, count)
        try:
            while (why := self._library.master_run(ctypes.byref(master), until)) in self._handlers:
                self._network.time_ns = master.time_ns
                self._handlers[why](master.at - 1)
                until = master.steps + 1 if self.ends else until
            self.is_current = why in (DONE, ASKED)
        finally:
            self.taken = master.steps - steps
            self._pull()
        if why == DIVERGED:
            self._watch.paces[master.diverged].refuse(self._paces[master.diverged].worst)
        return self.taken

    def merge_times(self) -> None:
        """Add the durations of steps that C has measured to those of the components."""
        for name, times in self._program.times.items():
            if times.count:
                self._network.nodes[name].times.merge(
                    times.count, times.total_ns, times.longest_ns, times.longest_at_ns, times.bins
                )
                ctypes.memset(ctypes.byref(times), 0, ctypes.sizeof(Times))
                times.longest_at_ns = -1

    # ------------------------------------------------------------------ where Python decides

    def _answered(self, at: int) -> None:
        """Refuse, or log what was said, as every call of an FMU in Python does."""
        slave, function = self._program.asked[at]
        operation, status = self._operations[at], self._master.status
        said.value = 0
        if operation.kind == STEP:
            t_ns = self._master.begin_ns + operation.start
            t, h = interval(t_ns, operation.length, constant=bool(operation.constant))
            slave.stepped(t, h, status)
            if status not in ACCEPTED:  # it was not refused: C has not counted it
                self._network.nodes[slave.name].times.add(self._master.took_ns, t_ns)
            self.ends |= slave.ended_at is not None
        else:
            slave.answered(function, status)
        for other in self._slaves.values():
            other.forward()

    def _exceeded(self, at: int) -> None:
        """Refuse a value that is none or too large; take over those that are not."""
        operation, chunk = self._operations[at], self._program.chunks[at]
        of_type = ctypes.POINTER(ctypes.c_double)
        values = ctypes.cast(operation.values, of_type)[: operation.count]
        self._network.refuse_excess(chunk, values)
        self._signals[chunk.start : chunk.stop] = values

    def _unsettled(self, at: int) -> None:
        """Solve a loop in the other ways that there are."""
        group = self._program.loops[at]
        self._pull()
        self._feedthrough.solve(group, self._master.steps + 1)
        self._push_signals()
        self._operations[at].relaxation = group.relaxation
        self._master.at = at + 1 + self._operations[at].length

    def _called(self, at: int) -> None:
        """Do what only Python can."""
        signals, own, program = self._network.signals, self._signals, self._program
        for place in program.fetched[at]:
            if not isinstance(signals[place], (str, bytes)):
                signals[place] = type(signals[place])(own[place])
        for call in program.calls[self._operations[at].start]:
            call(self._master.steps, self._master.begin_ns)
        for chunk in program.left[at]:
            if not isinstance(signals[chunk.start], (str, bytes)):
                own[chunk.start : chunk.stop] = signals[chunk.start : chunk.stop]

    # ------------------------------------------------------------------ what both keep

    def _push(self) -> None:
        self._push_signals()
        for at, (slave, function) in self._program.asked.items():
            if function == "DoStep":
                self._operations[at].never_back = slave.never_back
        for at, group in self._program.loops.items():
            self._operations[at].relaxation = group.relaxation
        for at, past in self._program.past.items():
            operation = self._operations[at]
            operation.has_previous = int(past.previous is not None)
            for i, value in enumerate(past.previous or ()):
                operation.previous[i] = value
        self._master.time_ns = self._network.time_ns

    def _push_signals(self) -> None:
        for kind, start, stop in self._numbers:
            if kind is not None:
                self._signals[start:stop] = self._network.signals[start:stop]

    def _pull(self) -> None:
        signals, own = self._network.signals, self._signals
        for kind, start, stop in self._numbers:
            if kind is float:
                signals[start:stop] = own[start:stop]
            elif kind is not None:
                signals[start:stop] = map(kind, own[start:stop])
        for at, group in self._program.loops.items():
            group.relaxation = self._operations[at].relaxation
        for at, past in self._program.past.items():
            operation = self._operations[at]
            if operation.has_previous:
                past.previous = operation.previous[: operation.count]
        self._network.time_ns = self._master.time_ns


def _ranges(signals: list[Any]) -> list[tuple[type | None, int, int]]:
    """Return what stands side by side: numbers of one type, or what C cannot have (None)."""
    found: list[tuple[type | None, int, int]] = []
    for place, value in enumerate(signals):
        kind = type(value) if isinstance(value, (bool, int, float)) else None
        if found and found[-1][0] is kind:
            found[-1] = kind, found[-1][1], place + 1
        else:
            found.append((kind, place, place + 1))
    return found


def _pace(pace: Any) -> Pace:
    arrays = {
        name: getattr(pace, name).ctypes.data
        for name in ("rows", "last", "first", "jump", "growing", "seen")
    }
    pace.places_in_c = (ctypes.c_int64 * max(1, len(pace.places)))(*pace.places)
    places = ctypes.addressof(pace.places_in_c)
    return Pace(every=pace.every, count=len(pace.places), places=places, **arrays)
