"""FMI 3.0: co-simulation with clocks, each of which ticks at its instant inside a step.

A step goes from one tick to the next. There the FMU is in event mode: its input clocks are set
active, then variables of active clocks are written and read, until it has nothing more to
update. In between, what is written waits for its clock, and what is read is of the last tick.
"""

from __future__ import annotations

import ctypes
import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from fractions import Fraction
from typing import Any

from ...errors import InputError, SimulationError
from ...model.component import NS
from ..clocks import Clock, Timetable, refuse_unfit
from ..files.busport import BusPort
from ..instance import Reader, Value, Variable, Writer
from ..messages import WARNING
from .fmi3slave import Fmi3Slave
from .loaded import LoadedFmu

_HELD = "held here"
_Calls = list[tuple[list[str], Callable[..., Any]]]
"""Names of variables of one type, and what sets or reads them."""


class Fmi3ClockedSlave(Fmi3Slave):
    """An instance of an FMI 3.0 FMU in co-simulation that has clocks, and event mode.

    Signals of truth are its triggered clocks. An input that is true activates its clock at the
    beginning of each step; an output is true if its clock was active in the step that ends.
    """

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        self._clocks = fmu.clocks
        self._outputs = [c for c in fmu.clocks.by_reference.values() if c.causality == "output"]
        self._timed = [c for c in fmu.clocks.by_reference.values() if c.is_timed]
        self._intervals = Intervals(name, self._call)
        self._timetable = Timetable()
        self._ports = [BusPort(bus) for bus in fmu.buses]
        ports = [port for bus in fmu.buses for port in (bus.receives, bus.sends)]
        self._held: dict[str, Value] = {
            n: fmu.variables[n].first for n in (*fmu.clocks.clocked, *fmu.clocks.signals, *ports)
        }
        """What the FMU does not hold between ticks, by variable."""
        self._put: set[str] = set()
        """Clocked variables that somebody sets."""
        self._triggered: set[int] = set()
        self._active: set[int] = set()
        self._counts: Counter[int] = Counter()
        """How often each output clock was active since the communication point before."""
        self._has_warned = False
        self._exchanges: dict[int, tuple[_Calls, _Calls]] = {}
        super().__init__(fmu, name)

    def begin(self) -> None:
        """End the initialisation; clocks that tick at the start do."""
        start = Fraction(self._now_ns, NS)
        for clock in self._timed:
            if not clock.is_periodic:
                self._ask(clock)
                continue
            interval, shift = clock.interval, clock.shift
            if interval is None:
                interval, shift = self._intervals.period(clock)
            self._timetable.set(clock.reference, start + shift, interval)
        super().begin()
        self._publish()

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s, through all ticks and events on the way."""
        now_ns, later_ns = round(t * NS), None if self.any_step else round((t + h) * NS)
        self._triggered = {
            reference
            for name, reference in self._clocks.signals.items()
            if self._held[name] and self.variables[name].causality == "input"
        }
        for port in self._ports:
            receives = port.terminal.receives
            try:
                port.take(str(self._held[receives]), now_ns, later_ns)
            except SimulationError as error:
                raise SimulationError(f"{self.name}.{receives}: {error}") from None
        super().step(t, h)
        self._publish()

    # ------------------------------------------------------------------ instants

    @property
    def _now_ns(self) -> int:
        return round(self._now * NS)

    def _next_ns(self) -> int | None:
        """Return when a clock has to be activated next; None if that is not known."""
        waits = [self._timetable.next_ns(), *(port.next_ns for port in self._ports)]
        return min((ns for ns in waits if ns is not None), default=None)

    def _stop(self, end: float) -> float:
        next_ns = self._next_ns()
        if next_ns is None or next_ns >= round(end * NS):
            return end
        if not self.any_step:
            raise SimulationError(
                f"{self.name}: a clock ticks at t = {next_ns / NS!r} s, between two communication "
                "points, and the FMU takes no steps of other lengths: a step of the rig that "
                "divides the clock's interval is needed"
            )
        return next_ns / NS

    def _is_due(self) -> bool:
        next_ns = self._next_ns()
        return bool(self._triggered) or (next_ns is not None and next_ns <= self._now_ns)

    def _publish(self) -> None:
        """Show at a communication point what has happened since the one before."""
        for clock in self._outputs:
            if clock.name in self._held:
                self._held[clock.name] = self._counts[clock.reference] > 0
                if self._counts[clock.reference] > 1:
                    self._warn_of_many(clock.name)
        for port in self._ports:
            self._held[port.terminal.sends] = port.flush()
        self._counts.clear()

    def _warn_of_many(self, clock: str) -> None:
        if not self._has_warned:
            self._has_warned = True
            text = (
                f"{clock} was active more than once in the step to t = {self._now!r} s: a signal "
                "shows that as once"
            )
            self._messages.keep(WARNING, text.encode())
            self._messages.forward()

    # ------------------------------------------------------------------ events

    def _activate(self) -> None:
        """Set the input clocks that are due, and exchange the variables of all active ones."""
        now_ns = self._now_ns
        received = {port: port.due(now_ns) for port in self._ports if port.is_due(now_ns)}
        active = {*self._timetable.take(now_ns), *self._triggered}
        active |= {port.terminal.rx_clock for port in received}
        self._triggered = set()
        self._set_clocks(sorted(active))
        for port, operations in received.items():
            self._setter([port.terminal.rx_data], "Binary")([operations])
        for reference in sorted(active):
            for names, put in self._exchange(reference)[0]:
                put([self._held[name] for name in names])
        ticking = self._ticking(active)
        self._counts.update(ticking)
        self._active = active | ticking
        for reference in sorted(self._active):
            for names, read in self._exchange(reference)[1]:
                self._held.update(zip(names, read(), strict=True))
        for port in self._ports:
            if port.terminal.tx_clock in self._active:
                port.send(now_ns, self._getter([port.terminal.tx_data], "Binary")()[0])

    def _set_clocks(self, active: Sequence[int]) -> None:
        if active:
            n = len(active)
            references = (ctypes.c_uint * n)(*active)
            self._call("SetClock", references, n, (ctypes.c_bool * n)(*[True] * n))

    def _ticking(self, active: Collection[int]) -> set[int]:
        """Return the output clocks that are active; asking takes it away from them."""
        found, unasked = set(active), self._outputs
        # One that belongs to others may be asked only when they are active.
        while asking := [c for c in unasked if not c.clocks or not found.isdisjoint(c.clocks)]:
            n = len(asking)
            values = (ctypes.c_bool * n)()
            references = (ctypes.c_uint * n)(*[clock.reference for clock in asking])
            self._call("GetClock", references, n, values)
            found |= {c.reference for c, value in zip(asking, values, strict=True) if value}
            unasked = [clock for clock in unasked if clock not in asking]
        return found.difference(active)

    def _exchange(self, reference: int) -> tuple[_Calls, _Calls]:
        """Return the calls that set and that read the variables of a clock."""
        if reference not in self._exchanges:
            clocked = self._clocks.clocked.items()
            own = [self.variables[name] for name, clocks in clocked if reference in clocks]
            inputs = [v for v in own if v.name in self._put]
            outputs = [v for v in own if v.causality in ("output", "local")]
            self._exchanges[reference] = (
                self._by_type(inputs, self._setter), self._by_type(outputs, self._getter)
            )  # fmt: skip
        return self._exchanges[reference]

    def _by_type(
        self, variables: Iterable[Variable], bind: Callable[[list[Variable], Any], Any]
    ) -> _Calls:
        groups: dict[Any, list[Variable]] = {}
        for variable in variables:
            groups.setdefault(self._type(variable), []).append(variable)
        return [([v.name for v in group], bind(group, of)) for of, group in groups.items()]

    def _schedule(self) -> None:
        for clock in self._timed:
            has_ticked = clock.kind == "changing" and clock.reference in self._active
            may_change = clock.kind == "tunable" and clock.interval is None
            is_open = not (clock.clocks and self._active.isdisjoint(clock.clocks))
            if has_ticked or may_change or (clock.kind == "countdown" and is_open):
                self._ask(clock)

    def _ask(self, clock: Clock) -> None:
        """Ask when a clock ticks next, counted from now."""
        interval = self._intervals.new(clock)
        if interval is not None:
            first = Fraction(self._now_ns, NS) + interval
            again = interval if clock.is_periodic else Fraction(0)
            self._timetable.set(clock.reference, first, again)

    # ------------------------------------------------------------------ variables

    def _kind(self, variable: Variable) -> Any:
        return _HELD if variable.name in self._held else super()._kind(variable)

    def _reader(self, variables: list[Variable], kind: Any) -> Reader:
        if kind != _HELD:
            return super()._reader(variables, kind)
        names = [variable.name for variable in variables]

        def read() -> list[Any]:
            self._flush()
            return [self._held[name] for name in names]

        return read

    def _writer(self, variables: list[Variable], kind: Any) -> Writer:
        if kind != _HELD:
            return super()._writer(variables, kind)
        names = [variable.name for variable in variables]
        clocked = [v for v in variables if v.name in self._clocks.clocked]
        self._put.update(v.name for v in clocked)
        self._exchanges.clear()
        puts = self._by_type(clocked, self._setter)

        def write(values: Sequence[Any]) -> None:
            self._held.update(zip(names, values, strict=True))
            if not self._stepping:
                for some, put in puts:
                    put([self._held[name] for name in some])

        return write

    def _memory(self) -> Any:
        ports = [port.memory() for port in self._ports]
        own = (dict(self._held), Counter(self._counts))
        return super()._memory(), own, self._timetable.memory(), ports

    def _recall(self, memory: Any) -> None:
        given, (held, counts), timetable, ports = memory
        super()._recall(given)
        self._held, self._counts = dict(held), Counter(counts)
        self._timetable.recall(timetable)
        for port, kept in zip(self._ports, ports, strict=True):
            port.recall(kept)


_NOT_YET_KNOWN, _UNCHANGED, _CHANGED = range(3)


class Intervals:
    """Asks an FMU, exactly where it has fractions. All times are in s.

    Everything raises SimulationError, with the instance's ``name``, for what is no interval.
    """

    def __init__(self, name: str, call: Callable[..., None]) -> None:
        self._name, self._call = name, call

    def period(self, clock: Clock) -> tuple[Fraction, Fraction]:
        """Return interval and shift of a periodic clock, in initialisation mode."""
        interval, _ = self._interval(clock)
        shift = self._fit(clock, "shift", self._asked("GetShift", clock), periodic=False)
        return interval, shift

    def new(self, clock: Clock) -> Fraction | None:
        """Return the time from now to a clock's next tick; None: nothing new is known of it."""
        interval, qualifier = self._interval(clock)
        # A changing clock is asked only when it has ticked: what it says is of the next tick.
        is_new = qualifier == _CHANGED or (qualifier == _UNCHANGED and clock.kind == "changing")
        return interval if is_new else None

    def _interval(self, clock: Clock) -> tuple[Fraction, int]:
        qualifier = ctypes.c_int()
        time = self._asked("GetInterval", clock, ctypes.byref(qualifier))
        if qualifier.value == _NOT_YET_KNOWN and clock.kind == "countdown":
            return Fraction(0), _NOT_YET_KNOWN
        if qualifier.value not in (_UNCHANGED, _CHANGED):
            raise SimulationError(
                f"{self._name}: the {clock.kind} clock {clock.name} has the interval qualifier "
                f"{qualifier.value}; {_UNCHANGED} (unchanged) or {_CHANGED} (changed) is needed"
            )
        return self._fit(clock, "interval", time, clock.is_periodic), qualifier.value

    def _asked(self, function: str, clock: Clock, *more: Any) -> Fraction | None:
        """Return what a function says of a clock; None: it is no time."""
        reference = (ctypes.c_uint * 1)(clock.reference)
        if clock.has_fractions:
            counter, resolution = ctypes.c_uint64(), ctypes.c_uint64()
            parts = ctypes.byref(counter), ctypes.byref(resolution)
            self._call(f"{function}Fraction", reference, 1, *parts, *more)
            return Fraction(counter.value, resolution.value) if resolution.value else None
        time = ctypes.c_double()
        self._call(f"{function}Decimal", reference, 1, ctypes.byref(time), *more)
        return Fraction(repr(time.value)) if math.isfinite(time.value) else None

    def _fit(self, clock: Clock, what: str, time: Fraction | None, periodic: bool) -> Fraction:
        try:
            if time is None:
                raise InputError("it is no number")
            refuse_unfit(time, periodic=periodic)
        except InputError as error:
            raise SimulationError(
                f"{self._name}: {what} of the {clock.kind} clock {clock.name}: {error}"
            ) from None
        return time
