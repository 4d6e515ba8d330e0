"""The component: ports, state and time of everything that touches a signal.

Whoever writes one declares its ports as class attributes and three methods::

    class Filter(Component):
        time_constant = Parameter(1.0, "s", "time constant", min=1e-3)
        u = Input("V", "signal")
        y = Output("V", "filtered signal")

        def start(self, t):
            self.y = 0.0

        def step(self, t, h):
            self.y += (self.u - self.y) * -math.expm1(-h / self.time_constant)

Whoever runs one (an FMU, the master in process) calls `setup`, `initialise`, `begin`, then
`advance` again and again, with `write` and `read` in between; `refresh` and time snapping
happen inside.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter
from typing import Any, ClassVar

from ..errors import InputError, SimulationError, unknown
from .declarations import (
    check_feedthrough,
    check_terminals,
    check_views,
    declared_ports,
    declared_terms,
    with_terms,
)
from .mixins import Logging, Noise, Reachable
from .port_checks import check_parameter, misfit
from .ports import Input, Output, Parameter, Port, Scalar, ScalarPort, lay_out
from .serialisation import copied, is_c_text
from .terminals import Terminal, terminal
from .terms import Terms

__all__ = [
    "NS",
    "Component",
    "Input",
    "Logging",
    "Noise",
    "Output",
    "Parameter",
    "Reachable",
    "Terminal",
    "Terms",
    "seconds",
    "terminal",
]

NS = 1_000_000_000
"""Nanoseconds in a second: time is counted in whole nanoseconds everywhere."""


_LATEST = 2e6  # s: up to 2**51 ns, a double of seconds gives its nanoseconds back

_INT32 = 2**31
_INSTANTIATED, _INITIALISING, _RUNNING = range(3)


def seconds(ns: int) -> float:
    """Return ``ns`` nanoseconds as the double nearest to that many seconds."""
    return ns / NS


class Component:
    """Base of all components.

    To write one, declare ports and override:

    - ``start(t)``: set the state for time ``t``, parameters being known.
    - ``step(t, h)``: read inputs as of ``t``, advance the state to ``t + h``.
    - ``outputs(t)``: set outputs from inputs and state at ``t``, without changing the state.
      It runs after `start`, after every `step`, and whenever inputs changed since.

    All state lives in attributes that are plain data (numbers, strings, lists, dicts, arrays,
    None), so that it can be copied, restored and serialised. ``transient`` names attributes
    that are not state. A component with an outside world (a socket, firmware) sets
    ``rolls_back = False``; one whose numbers jump at instants and are constant between them,
    ``discrete = True``; one that takes whole multiples of a step only says it in ``fixed_step``, s.
    Which inputs act on which outputs at the same instant is found out (`fmi.dependencies`).
    ``feedthrough`` declares it, per output port, for the outputs of which less is true.

    ``terminals`` are groups of ports that are connected together (`terminals`), by their names.
    ``views`` says what reports draw of it: by kind of view (`ports.VIEWS`), the ports that it
    takes.
    ``structural`` names parameters, numbers too, that say what there is rather than how much of it
    (how many waypoints, where thrusters are): native FMUs have them built in.
    ``tabulated`` names methods that make tables of those alone at the start, with the attributes
    that hold them: native FMUs have the tables.
    ``exercised`` has values by port with which everything in it acts, where the start values do
    not do: tests run the component with them.

    Times are seconds, already snapped to the grid of the communication step.
    """

    feedthrough: ClassVar[Mapping[str, Sequence[str]]] = {}
    rolls_back: ClassVar[bool] = True
    discrete: ClassVar[bool] = False
    fixed_step: ClassVar[float] = 0.0
    terminals: ClassVar[Mapping[str, Terminal]] = {}
    views: ClassVar[Mapping[str, Mapping[str, str]]] = {}
    structural: ClassVar[Sequence[str]] = ()
    tabulated: ClassVar[Mapping[str, Sequence[str]]] = {}
    exercised: ClassVar[Mapping[str, Any]] = {}
    transient: ClassVar[frozenset[str]] = frozenset({"name"})

    ports: ClassVar[dict[str, Port]] = {}
    scalars: ClassVar[tuple[ScalarPort, ...]] = ()
    _declared: ClassVar[frozenset[str]] = frozenset()
    scalar_by_name: ClassVar[dict[str, ScalarPort]] = {}
    _settable: ClassVar[dict[type, frozenset[int]]] = {}
    _always_settable: ClassVar[dict[type, frozenset[int]]] = {}
    _of_type: ClassVar[dict[type, frozenset[int]]] = {}
    _real_outputs: ClassVar[tuple[int, ...]] = ()
    _of_real_outputs: ClassVar[Any] = staticmethod(lambda _: ())
    _other_outputs: ClassVar[tuple[int, ...]] = ()
    _inputs: ClassVar[frozenset[int]] = frozenset()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls._declared = frozenset(n for n, v in vars(cls).items() if isinstance(v, Port))
        cls.ports, cls.scalars = lay_out(declared_ports(cls))
        for name, port in cls.ports.items():
            setattr(cls, name, port)
        cls.scalar_by_name = {scalar.name: scalar for scalar in cls.scalars}
        named = {**cls.ports, **cls.scalar_by_name}
        terms = declared_terms(cls)
        check_feedthrough(cls.__name__, {**cls.ports, **terms}, cls.feedthrough)
        if "feedthrough" in vars(cls):
            cls.feedthrough = with_terms(cls.feedthrough, terms)
        check_views(cls.__name__, cls.views)
        check_terminals(cls.__name__, cls.terminals, named, list(terms))
        for kind in (float, int, bool, str):
            of_type = [s for s in cls.scalars if s.port.type is kind]
            # A dict of its own per class: a shared one would mix the classes.
            cls._of_type = {**cls._of_type, kind: frozenset(s.reference for s in of_type)}
            inputs = [s for s in of_type if s.port.kind != "output"]
            cls._settable = {**cls._settable, kind: frozenset(s.reference for s in inputs)}
            always = [s for s in inputs if not _is_fixed(s.port)]
            cls._always_settable = {
                **cls._always_settable,
                kind: frozenset(s.reference for s in always),
            }
        cls._inputs = frozenset(s.reference for s in cls.scalars if s.port.kind == "input")
        cls._real_outputs = tuple(
            s.reference for s in cls.scalars if s.port.kind == "output" and s.port.type is float
        )
        cls._of_real_outputs = staticmethod(_getter(cls._real_outputs))
        cls._other_outputs = tuple(
            s.reference
            for s in cls.scalars
            if s.port.kind == "output" and s.port.type in (int, str)
        )

    def __init__(self, name: str = "component") -> None:
        self.name = name
        self.values: list[Any] = [v for p in self.ports.values() for v in p.start]
        self._now_ns = 0
        self._phase = _INSTANTIATED
        self._stale = True
        self._restart = True

    # ------------------------------------------------------------------ written by components

    def start(self, t: float) -> None:
        """Set the initial state. Parameters are known; inputs may still change."""

    def step(self, t: float, h: float) -> None:
        """Advance the state from ``t`` to ``t + h`` with inputs held as they are."""

    def outputs(self, t: float) -> None:
        """Set the outputs from inputs and state at ``t``; must not change the state."""

    def close(self) -> None:
        """Release what is outside (sockets, ports); called at the end, maybe more than once."""

    # ------------------------------------------------------------------ called by whoever runs it

    @property
    def now(self) -> float:
        """Simulated time the component has reached, s."""
        return seconds(self._now_ns)

    @property
    def now_ns(self) -> int:
        """Simulated time the component has reached, ns."""
        return self._now_ns

    def set(self, name: str, value: Any) -> None:
        """Set a port, whole or one scalar of it, by name.

        Raises InputError if there is no such port, it cannot be set now, or the value does
        not fit its type, axes or choices.
        """
        try:
            if name in self.ports:
                port = self.ports[name]
                values = port._spread(value)
                self._write(range(port.offset, port.offset + port.size), values, port.type)
            elif name in self.scalar_by_name:
                scalar = self.scalar_by_name[name]
                self._write([scalar.reference], [scalar.port._scalar(value)], scalar.port.type)
            else:
                raise InputError(unknown("port", name, [*self.ports, *self.scalar_by_name]))
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(f"{self.name}.{name}: {error}") from None

    def get(self, name: str) -> Any:
        """Return a port's value (a list if it has axes) or one scalar's, by name."""
        if name not in self.ports and name not in self.scalar_by_name:
            raise InputError(unknown("port", name, [*self.ports, *self.scalar_by_name]))
        self.refresh()
        if name in self.ports:
            value = getattr(self, name)
            return list(value) if isinstance(value, tuple) else value
        return self.values[self.scalar_by_name[name].reference]

    def write(self, references: Sequence[int], values: Sequence[Scalar], kind: type) -> None:
        """Set scalars of one type by reference. Raises InputError as `set` does."""
        self._write(references, values, kind)

    def read(self, references: Sequence[int], kind: type) -> list[Any]:
        """Return scalars of one type by reference, recomputed if inputs changed since."""
        self._refuse_misfit(references, kind)
        if self._stale:
            self.refresh()
        values = self.values
        return [values[r] for r in references]

    def reader(self, references: Sequence[int], kind: type) -> Callable[[], list[Any]]:
        """Return what does the same as `read` of these references, again and again."""
        self._refuse_misfit(references, kind)
        of = _getter(references)

        def read() -> list[Any]:
            if self._stale:
                self.refresh()
            return of(self.values)

        return read

    def writer(self, references: Sequence[int], kind: type) -> Callable[[Sequence[Scalar]], None]:
        """Return what does the same as `write` to these references, again and again."""
        if kind is str or not self._inputs.issuperset(references):
            return lambda values: self._write(references, values, kind)

        places = _places(references)

        def write(values: Sequence[Any]) -> None:
            if not math.isfinite(sum(values)):
                self._write(references, values, kind)
            own = self.values
            if places is not None:
                own[places] = values
            else:
                for reference, value in zip(references, values, strict=True):
                    own[reference] = value
            self._stale = True

        return write

    def refresh(self) -> None:
        """Recompute the outputs if an input or parameter was set since they were computed.

        During initialisation a parameter set since the start starts the component again.
        """
        if self._stale and self._phase != _INSTANTIATED:
            if self._restart:
                self.check_parameters()
                self.start(self.now)
                self._restart = False
            self.outputs(self.now)
            self._check_outputs()
            self._stale = False

    def setup(self, start_time: float) -> None:
        """Set the start time, before `initialise`. Raises InputError if that is too late."""
        if not abs(start_time) < _LATEST:
            raise InputError(
                f"{self.name}: start time is {start_time!r} s; times are exact to the nanosecond "
                f"up to {_LATEST:g} s only"
            )
        self._now_ns = round(start_time * NS)

    def initialise(self) -> None:
        """Start; inputs and parameters may still be set, and outputs read, until `begin`.

        Raises InputError for a parameter outside its min, max or choices.
        """
        self._phase = _INITIALISING
        self._restart = self._stale = True
        self.refresh()

    def check_parameters(self) -> None:
        """Raise InputError for a parameter outside its min, max or choices."""
        for scalar in self.scalars:
            check_parameter(self.name, scalar, self.values[scalar.reference])

    def begin(self) -> None:
        """End the initialisation: from now on fixed parameters cannot be set."""
        self.refresh()
        self._phase = _RUNNING

    def advance(self, t: float, h: float, *, publish: bool = True) -> None:
        """Step from ``t`` to ``t + h`` (s), both as the caller's doubles have them.

        Time is snapped: the component counts whole nanoseconds itself and takes the caller's
        ``t`` for the time it has reached, if they differ by less than 1 % of ``h``. The outputs
        follow now, or if not ``publish``, when they are read: by then inputs may have changed.

        Raises SimulationError if an output is not finite afterwards.
        """
        h_ns = round(h * NS)
        given = round(t * NS)
        if abs(given - self._now_ns) > max(1, h_ns // 100):
            self._now_ns = given
        self.step(self._now_ns / NS, h_ns / NS)
        self._now_ns += h_ns
        self._stale = not publish
        if publish:
            self.outputs(self.now)
            self._check_outputs()

    def begin_anew(self) -> None:
        """Return to before `setup`, with all parameters and inputs at their start values."""
        for scalar in self.scalars:
            self.values[scalar.reference] = scalar.port.start[scalar.index]
        self._phase = _INSTANTIATED

    def get_state(self) -> dict[str, Any]:
        """Return a copy of the whole state, hidden variables included, as plain data.

        Raises TypeError naming an attribute that is not plain data, and SimulationError for a
        component that does not roll back.
        """
        if not self.rolls_back:
            raise SimulationError(
                f"{self.name} reaches outside the simulation: it has no state to save"
            )
        return {
            name: copied(value, f"{self.name}.{name}")
            for name, value in vars(self).items()
            if name not in self.transient
        }

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned; ``state`` may be used again afterwards."""
        for name in [n for n in vars(self) if n not in self.transient and n not in state]:
            delattr(self, name)
        for name, value in state.items():
            setattr(self, name, copied(value, name))

    # ------------------------------------------------------------------ inside

    def _write(self, references: Sequence[int], values: Sequence[Scalar], kind: type) -> None:
        running = self._phase == _RUNNING
        allowed = (self._always_settable if running else self._settable)[kind]
        if not allowed.issuperset(references):
            raise InputError(f"{self.name}: {misfit(self.scalars, references, allowed, kind)}")
        if kind is float and not math.isfinite(sum(values)):  # type: ignore[arg-type]
            for reference, value in zip(references, values, strict=True):
                if not math.isfinite(value):  # type: ignore[arg-type]
                    name = self.scalars[reference].name
                    raise InputError(f"{self.name}.{name}: {value} is not a finite number")
        if not self._inputs.issuperset(references):
            if running:  # a tunable parameter; before, all are checked at the start
                for reference, value in zip(references, values, strict=True):
                    if value != self.values[reference]:  # written again and again, often the same
                        check_parameter(self.name, self.scalars[reference], value)
            elif self._phase == _INITIALISING:
                self._restart = True
        own = self.values
        for reference, value in zip(references, values, strict=True):
            own[reference] = value
        self._stale = True

    def _refuse_misfit(self, references: Sequence[int], kind: type) -> None:
        if not self._of_type[kind].issuperset(references):
            raise InputError(
                f"{self.name}: {misfit(self.scalars, references, self._of_type[kind], kind)}"
            )

    def _check_outputs(self) -> None:
        values = self.values
        if not math.isfinite(sum(self._of_real_outputs(values))):
            for reference in self._real_outputs:
                if not math.isfinite(values[reference]):
                    self._refuse_output(reference)
        for reference in self._other_outputs:
            value = values[reference]
            if not (is_c_text(value) if isinstance(value, str) else -_INT32 <= value < _INT32):
                self._refuse_output(reference)

    def _refuse_output(self, reference: int) -> None:
        scalar, value = self.scalars[reference], self.values[reference]
        why = {int: ", which does not fit 32 bits", str: ", which is no C text"}
        raise SimulationError(
            f"{self.name}: output {scalar.name} is {value!r}{why.get(scalar.port.type, '')} "
            f"at t = {self.now!r} s"
        )


def _is_fixed(port: Port) -> bool:
    return isinstance(port, Parameter) and not port.tunable


def _places(references: Sequence[int]) -> slice | None:
    """Return the slice that references are, if they stand side by side in their order."""
    first = references[0] if references else 0
    after = first + len(references)
    return slice(first, after) if [*references] == [*range(first, after)] else None


def _getter(references: Sequence[int]) -> Callable[[list[Any]], list[Any]]:
    places = _places(references)
    if places is not None:
        return itemgetter(places)
    return lambda values: [values[r] for r in references]
