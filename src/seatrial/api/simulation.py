"""Simulations that the caller steps."""

from __future__ import annotations

import contextlib
import weakref
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from ..errors import InputError, SimulationError, unknown
from .assembling import (
    Origin,
    act_on,
    assembled,
    begun,
    cannot_start_anew,
    give,
    meet_weather,
    started,
    steps_ahead,
)
from .signal import Signal, described
from .written import as_duration, as_settings, as_written

if TYPE_CHECKING:
    from ..fmi.instance import Variable
    from ..sim.actions import ActionKind
    from ..sim.fault_schedule import Fault
    from ..sim.master import Master, Snapshot
    from .recording import Recording

Observer = TypeVar("Observer", bound=Callable[..., object])


class Injection:
    """A fault that a simulation was given."""

    def __init__(self, master: Master, fault: Fault) -> None:
        self._master, self._fault = master, fault

    def clear(self) -> None:
        """End it now, whether it has begun or not. Raises SimulationError."""
        self._master.faults.end(self._master, self._fault)


class State:
    """The whole state of a simulation at one communication point; `Simulation.save` makes one."""

    def __init__(self, simulation: Simulation, snapshot: Snapshot) -> None:
        self.time = snapshot.time
        """Simulated time, s."""
        self.simulation = simulation
        """The simulation that saved it, and that alone can restore it."""
        self.snapshot = snapshot
        """State of the master."""
        self.origin = simulation._origin
        """Settings with which the simulation started."""


class Simulation:
    """A rig or a trial that the caller steps, in the caller's process.

    ``rig`` is the name of a rig or a trial (of a rig if both have it), the path of a ``.toml``
    file, or of an SSP or OSP-IS package. A trial brings its settings, sea, wind, current, events
    and faults; its criteria and its stop time are `run_trial`'s. ``set`` gives
    parameters, and start values of inputs, by ``component.port`` as a rig's file does: numbers in
    the port's unit (SI), text with a unit (``"10 deg"``) or the name of a preset, sequences and
    arrays with one element per axis; ``component.isolated`` gives a component a process of its own
    (true, false or "sandboxed"); a trial has keys such as ``sea.height`` beside them. ``seed`` is
    what all noise derives from (None: the trial's, or 1), ``variant`` one of the
    vehicle's, ``engine`` as for `run_trial`, ``step`` the communication step in s or as text in
    place of the rig's, ``choices`` those of the rig: ``{"vehicle": "gloria"}``. Time starts at 0.

    The simulation is at a communication point between any two calls. The same calls give the
    same numbers, those of a trial with events at the same times.

    A component that crashes, such as a native FMU, or that calls C's ``exit`` ends the process,
    unless the rig or ``set`` says that it is isolated; `run_trial` survives that. No device is
    opened and no other host reached: a rig whose links need one is refused. Use it from one
    thread, and close it, or use it as a context manager.

    Raises InputError for bad input, or a rig that cannot start with it.
    """

    def __init__(
        self,
        rig: str | Path,
        *,
        set: Mapping[str, Any] | None = None,
        seed: int | None = None,
        variant: str | None = None,
        engine: str = "direct",
        step: float | str | None = None,
        choices: Mapping[str, str] | None = None,
    ) -> None:
        from ..links.hardware import confined

        self._observers: list[Callable[[Simulation], object]] = []
        self._error = ""
        with confined():
            made = assembled(
                rig, set, seed=seed, variant=variant, engine=engine, step=step, choices=choices
            )
            try:
                self._master = started(made)
            except BaseException:
                made.system.discard()
                raise
        self._made = made
        self._origin = Origin.of(made.system)
        self._free = weakref.finalize(self, made.system.discard)

    # ------------------------------------------------------------------ time

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._master.time

    @property
    def step_size(self) -> float:
        """Communication step, s."""
        return self._master.step_ns / 1e9

    def step(self, count: int = 1) -> None:
        """Take ``count`` communication steps, calling the observers after each.

        Raises SimulationError if a component cannot go on, or has ended the simulation in the
        step before; the simulation can only be read, restored or closed then.
        """
        if count < 0:
            raise InputError(f"step: the count is {count}, it cannot be negative")
        while count:
            self._refuse_ended()
            try:
                self._master.meet_arrivals()
                most = 1 if self._observers else steps_ahead(self._made, self._master, count)
                count -= self._master.advance(most)
                act_on(self._made, self._master)
            except BaseException as error:  # an interrupted step ends at no communication point
                self._error = str(error) or type(error).__name__
                raise
            for observer in tuple(self._observers):
                observer(self)

    def run(self, until: float | str) -> None:
        """Step until the simulated time ``until``, s or text such as ``"10 s"``.

        Raises InputError for a time that has passed or is not a whole number of communication
        steps away; SimulationError as `step` does.
        """
        from ..system.rig import duration_ns

        ahead = duration_ns(str(as_duration(until)), "run") - self._master.time_ns
        count, rest = divmod(ahead, self._master.step_ns)
        if rest or count < 0:
            raise InputError(
                f"run: {until!r} is not a whole number of communication steps of "
                f"{self.step_size!r} s from {self.time!r} s on"
            )
        self.step(count)

    # ------------------------------------------------------------------ values

    @cached_property
    def signals(self) -> dict[str, Signal]:
        """All outputs by name, in the order of the rig: what a record holds."""
        return described(self._master.system, "output")

    @cached_property
    def inputs(self) -> dict[str, Signal]:
        """All inputs by name."""
        return described(self._master.system, "input")

    @cached_property
    def parameters(self) -> dict[str, Signal]:
        """All parameters by name."""
        return described(self._master.system, "parameter")

    def get(self, name: str) -> Any:
        """Return the present value of an output, an input or a parameter, in its own unit.

        One scalar (``hull.position.x``) as a float, int, bool, str or bytes; a whole port
        (``hull.position``) as an array of shape (n,), its elements in the order of declaration.
        An input that is connected has what arrives now; overrides count. Raises InputError.
        """
        import numpy as np

        self._refuse_closed()
        component, variables = self._variables(name)
        values = self._master.values(component, [v.name for v in variables])
        if f"{component}.{variables[0].name}" == name:
            return values[0]
        return np.array(values, dtype=object if variables[0].type in (str, bytes) else None)

    def set(self, name: str, value: Any) -> None:
        """Set an input that nothing feeds, or a tunable parameter, from now on.

        ``value`` as in the constructor; outputs that depend on it at once follow. As a ``set``
        event of a trial at this time. Raises InputError.
        """
        self._act("set", name, value)

    def inject(
        self, what: str, where: str | Sequence[str], *, for_: str | float | None = None, **more: Any
    ) -> Injection:
        """Let a fault of the catalogue act on ``where`` from now on, and return it.

        Keys and values are those of a trial's ``faults``; numbers are in the port's unit, times in
        s: ``inject("bias", "gnss.position_n.x", value=5.0, grows_over=10)``. ``for_`` says how
        long, ``at`` when, if not now. Raises InputError.
        """
        from ..sim.faults import resolved
        from ..system.fault_entry import FaultEntry
        from ..system.files import validated

        self._refuse_ended()
        places = where if isinstance(where, str) else list(where)
        written = {"what": what, "where": places, "for": for_, **more}
        content = {key: as_written(value) for key, value in written.items() if value is not None}
        for key in {"at", "for", "grows_over", "time", "jitter", "every"} & content.keys():
            content[key] = as_duration(content[key])
        entry = validated(FaultEntry, content, Path("inject"))
        master = self._master
        number = len(master.faults.faults)
        fault = resolved(master.system, entry, number, master.time_ns, "inject")
        if fault.begin_ns < master.time_ns:
            raise InputError(f"inject: at = {content['at']!r} has passed at t = {self.time!r} s")
        master.faults.add(fault)
        master.faults.act(master)
        return Injection(master, fault)

    def override(self, name: str, value: Any) -> None:
        """Replace an output for all its readers, or a connected input, until `release`.

        For what a program commands step by step; another value of the same name replaces the one
        before. What fails is injected. Raises InputError.
        """
        self._act("override", name, value)

    def release(self, name: str) -> None:
        """End an override. Raises InputError."""
        self._act("release", name, None)

    # ------------------------------------------------------------------ observers

    def observe(self, observer: Observer) -> Observer:
        """Call ``observer`` with this simulation after every communication step; return it.

        It may read, set, override and save, and raise to end a `run`.
        """
        self._observers.append(observer)
        return observer

    def unobserve(self, observer: Callable[..., object]) -> None:
        """Call an observer no more. Raises InputError for one that was not there."""
        if observer not in self._observers:
            raise InputError(f"unobserve: {observer!r} does not observe this simulation")
        self._observers.remove(observer)

    def record(self, *patterns: str) -> Recording:
        """Record the outputs that match a pattern (``hull.*``; default: all), from now on.

        The first row is of the present, then there is one after every communication step.
        Raises InputError for a pattern that matches nothing.
        """
        from .recording import Recording

        wanted = {name for pattern in patterns or ("*",) for name in self._matching(pattern)}
        recorded = [signal for name, signal in self.signals.items() if name in wanted]
        places = {".".join(name): place for place, name in enumerate(self._master.names)}
        chosen = [places[signal.name] for signal in recorded]
        recording = Recording(recorded, lambda: [self._master.signals[place] for place in chosen])
        recording(self)
        return self.observe(recording)

    # ------------------------------------------------------------------ states

    def reset(self, *, set: Mapping[str, Any] | None = None, seed: int | None = None) -> None:
        """Start anew at time 0, as a new simulation with these settings and this seed would.

        ``set`` changes parameters and start values from now on, fixed ones too, ``seed`` what all
        noise derives from; what a program has set, overridden or injected since the start is
        gone. Observers stay. Raises InputError for what does not fit, which changes nothing, for
        text that is built into components in C, and if the rig cannot start with it.
        """
        from ..links.hardware import confined

        self._refuse_closed()
        system = self._master.system
        if stuck := cannot_start_anew(system):
            raise InputError(f"reset: {', '.join(stuck)} cannot start anew; make a new simulation")
        before = self._origin
        try:
            with confined():
                give(self._made, as_settings(set), seed)
                self._error = "it could not start anew"
                for part in system.parts.values():
                    part.instance.reset()
                self._master = begun(self._made)
        except BaseException:
            before.give_back(system)
            raise
        self._origin, self._error = Origin.of(system), ""

    def save(self) -> State:
        """Return the whole state: time, components with their noise, overrides.

        Observers are no part of it. It is released when nothing refers to it any more. Raises
        InputError naming the components that cannot save and restore theirs: links to the
        outside, and some FMUs.
        """
        self._refuse_ended()
        state = State(self, self._master.save())
        weakref.finalize(state, self._release, state.snapshot).atexit = False
        return state

    def restore(self, state: State) -> None:
        """Return to a state that this simulation saved, as often as needed.

        Also after a step that failed. Raises InputError for the state of another simulation,
        SimulationError if a component cannot restore it.
        """
        self._refuse_closed()
        if state.simulation is not self:
            raise InputError("restore: this is the state of another simulation")
        self._error = "its state was not restored"
        if state.origin is not self._origin:  # of before a reset: with the weather of then
            state.origin.give_back(self._master.system)
            meet_weather(self._master.system)
            self._origin = state.origin
        self._master.restore(state.snapshot)
        self._error = ""

    # ------------------------------------------------------------------ the end

    def close(self) -> None:
        """End the components and release them; more than once does nothing.

        Raises SimulationError if a component cannot end.
        """
        if self._free.alive:
            try:
                if not self._error:
                    self._master.terminate()
            finally:
                self._free.detach()
                self._master.system.free()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        name = self._master.system.rig.read_from.name
        return (
            f"<Simulation of {name} at t = {self.time!r} s{'' if self._free.alive else ', closed'}>"
        )

    # ------------------------------------------------------------------ inside

    def _refuse_closed(self) -> None:
        if not self._free.alive:
            raise InputError("this simulation is closed")

    def _refuse_ended(self) -> None:
        self._refuse_closed()
        if self._error:
            raise SimulationError(f"this simulation ended at t = {self.time!r} s: {self._error}")
        if ended := self._master.end_notes():
            raise SimulationError("; ".join(ended))

    def _act(self, kind: ActionKind, name: str, value: Any) -> None:
        from ..sim.actions import action

        self._refuse_ended()
        action(self._master.system, kind, name, as_written(value), kind).apply(self._master)

    def _release(self, snapshot: Snapshot) -> None:
        if self._free.alive:
            with contextlib.suppress(SimulationError):  # of a component that is broken
                self._master.free(snapshot)

    def _variables(self, name: str) -> tuple[str, Sequence[Variable]]:
        """Return the component and the scalars that a name means."""
        from ..system.references.values import port_names, port_scalars

        part, port = self._master.system.located(name, name)[0]
        component = part.name
        variables = part.instance.variables
        scalars = port_scalars(variables, port)
        if not scalars:
            raise InputError(f"{component}: {unknown('port', port, port_names(variables))}")
        return component, scalars

    def _matching(self, pattern: str) -> list[str]:
        """Return the outputs that a pattern or the name of a port means."""
        from ..sim.recorder import matching

        if "*" in pattern or "?" in pattern:
            return matching(list(self.signals), [pattern])
        component, scalars = self._variables(pattern)
        names = [f"{component}.{variable.name}" for variable in scalars]
        if names[0] not in self.signals:
            raise InputError(f"record: {pattern} is no output; outputs alone are recorded")
        return names
