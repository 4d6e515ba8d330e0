"""Plants: components with continuous states, written as CasADi expressions.

A plant states its equations once. From them come the fixed-step integrator that runs inside a
communication step, a variable-step reference, exact Jacobians, linearisation and trim.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from ..errors import InputError, unknown
from .component import Component, Output, Parameter
from .expressions import (
    Model,
    Pairs,
    Sundials,
    Vector,
    bind,
    compile_model,
    compile_outputs,
    coupled,
)
from .ports import Port

_Run = tuple[slice, slice]
"""Places of values of ports side by side, among all and among their own, stacked."""

InputFunction = Callable[[float, SimpleNamespace], Mapping[str, Any]]


class State(Output):
    """A continuous state, published as an output; its start value is ``NAME_start``."""

    def __set_name__(self, owner: type, name: str) -> None:
        super().__set_name__(owner, name)
        start = Parameter(
            self.start[0] if self.axes is None else tuple(self.start),
            self.unit,
            f"start value of {name}: {self.description}",
            axes=self.axes,
        )
        start.__set_name__(owner, f"{name}_start")
        setattr(owner, f"{name}_start", start)


@dataclass(frozen=True)
class Linearisation:
    """x' = A x + B u, y = C x + D u about a point; y are the outputs that are not states."""

    A: Vector
    B: Vector
    C: Vector
    D: Vector
    x_names: tuple[str, ...]
    u_names: tuple[str, ...]
    y_names: tuple[str, ...]


@dataclass(frozen=True)
class Reference:
    """A variable-step solution: ``t`` (n,), ``x`` (n, states) and the states' names."""

    t: Vector
    x: Vector
    x_names: tuple[str, ...]

    def __getitem__(self, name: str) -> Vector:
        """Return one scalar state over time, by name."""
        return self.x[:, self.x_names.index(name)]


class Plant(Component):
    """Base of components with continuous states.

    Declare ports with `State`, `Input`, `Output`, `Parameter` and override `equations`.
    Steps use the classical Runge-Kutta method of order 4 with equal sub-steps no longer than
    ``max_step``, inputs held. Feed-through follows from the expressions; one that is declared is
    checked against them. Text parameters choose
    between equations and reach `equations` as text; text inputs do not reach them.
    """

    max_step = Parameter(0.01, "s", "longest integration sub-step", min=1e-6)

    transient = Component.transient | {"_buffers", "_u", "_p", "_h", "_x1", "_y", "machine"}
    machine: Callable[[ca.Function], ca.Function] = staticmethod(lambda function: function)
    """Maker of other functions of a step, with the same numbers."""

    state_ports: ClassVar[tuple[Port, ...]] = ()
    input_ports: ClassVar[tuple[Port, ...]] = ()
    output_ports: ClassVar[tuple[Port, ...]] = ()
    """Outputs that are not states."""
    _state_runs: ClassVar[tuple[_Run, ...]] = ()
    _output_runs: ClassVar[tuple[_Run, ...]] = ()
    parameter_ports: ClassVar[tuple[Port, ...]] = ()
    """Numbers that the equations take."""
    _texts: ClassVar[tuple[str, ...]] = ()
    _u_slice: ClassVar[slice] = slice(0, 0)
    _p_references: ClassVar[tuple[int, ...]] = ()
    _has_tunables: ClassVar[bool] = False
    _models: ClassVar[dict[tuple[str, ...], Model]] = {}

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        ports = list(cls.ports.values())
        for port in ports:
            if port.kind == "input" and port.type is str:
                continue
            if port.kind != "parameter" and port.type is not float:
                raise TypeError(f"{cls.__name__}.{port.name}: a plant's ports are real numbers")
            if isinstance(port, Parameter) and port.type is str and port.tunable:
                raise TypeError(f"{cls.__name__}.{port.name}: equations cannot change in a run")
        cls._models = {}
        cls.state_ports = tuple(p for p in ports if isinstance(p, State))
        cls.input_ports = tuple(p for p in ports if p.kind == "input" and p.type is float)
        cls.output_ports = tuple(
            p for p in ports if p.kind == "output" and not isinstance(p, State)
        )
        cls._state_runs, cls._output_runs = _runs(cls.state_ports), _runs(cls.output_ports)
        # What a role says of is not the equations': the sea, a seed.
        parameters = [p for p in ports if isinstance(p, Parameter) and not p.role]
        cls._texts = tuple(p.name for p in parameters if p.type is str)
        cls.parameter_ports = tuple(p for p in parameters if p.type is float)
        # Ports of one kind stand side by side in the flat list of values.
        places = [s.reference for s in cls.scalars if s.port in cls.input_ports]
        if places and places[-1] - places[0] >= len(places):
            raise TypeError(f"{cls.__name__}: text inputs stand before or after all others")
        cls._u_slice = slice(places[0], places[-1] + 1) if places else slice(0, 0)
        reals = [s for s in cls.scalars if s.port in cls.parameter_ports]
        cls._p_references = tuple(s.reference for s in reals)
        cls._has_tunables = any(isinstance(p, Parameter) and p.tunable for p in ports)

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return (derivatives by state, values by other output), from symbols by port name.

        ``x``, ``u``, ``p`` hold one CasADi column vector per state, input and parameter; a
        text parameter is a plain string. ``self`` carries no values: the result is compiled
        once per class and choice of text parameters.
        """
        raise NotImplementedError

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Start from the start values; compile the equations if nobody has yet."""
        self._x = self._start_state()
        self._build_buffers()

    def step(self, t: float, h: float) -> None:
        """Integrate over ``h`` with inputs held."""
        count = max(1, math.ceil(h / self.max_step - 1e-9))
        self._load()
        self._h[0] = h / count
        advance = self._buffers["rk4"][1]
        for _ in range(count):
            advance()
            self._x[:] = self._x1

    def outputs(self, t: float) -> None:
        """Publish the states and what follows from them and the inputs."""
        self._publish(self._state_runs, self._x.tolist())
        if self.output_ports:
            self._load()
            self._buffers["out"][1]()
            self._publish(self._output_runs, self._y.tolist())

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        # Compiled functions read the state at a fixed address, so they are bound anew.
        super().set_state(state)
        if "_x" in state:
            self._build_buffers()

    # ------------------------------------------------------------------ tools

    def compiled(self) -> Model:
        """Return the compiled equations in the form that the text parameters choose."""
        key = tuple(getattr(self, name) for name in self._texts)
        if key not in self._models:
            self._models[key] = self._compile(dict(zip(self._texts, key, strict=True)))
        return self._models[key]

    def derivatives(self, x: Vector, u: Vector | None = None) -> Vector:
        """Return dx/dt at stacked state ``x`` and stacked inputs ``u`` (default: as set)."""
        return np.asarray(self.compiled().rhs(x, self._stacked_u(u), self._stacked_p())).ravel()

    def linearise(self, x: Vector, u: Vector | None = None) -> Linearisation:
        """Return the exact linearisation at stacked state ``x``, inputs ``u`` (default: as set)."""
        model = self.compiled()
        matrices = model.jacobians(x, self._stacked_u(u), self._stacked_p())
        a, b, c, d = (np.asarray(matrix) for matrix in matrices)
        return Linearisation(a, b, c, d, model.x_names, model.u_names, model.y_names)

    def trim(
        self,
        guess: Vector,
        u: Vector | None = None,
        *,
        hold: Sequence[str] = (),
        tol: float = 1e-12,
    ) -> Vector:
        """Return a stacked state near ``guess`` where dx/dt = 0, with inputs ``u`` (as set).

        States named in ``hold``, whole ports or scalars, keep their guess. Levenberg-Marquardt
        with the exact Jacobian. Raises ArithmeticError if no such state is found (largest
        |dx/dt| above ``tol`` times its scale at the guess, or 1), InputError for an unknown name.
        """
        from scipy.optimize import root

        model = self.compiled()
        known = [*model.x_names, *(port.name for port in self.state_ports)]
        for name in hold:
            if name not in known:
                raise InputError(f"{self.name}: {unknown('state', name, known)}")
        free = [i for i, n in enumerate(model.x_names) if not {n, n.partition(".")[0]} & set(hold)]
        x = np.array(guess, dtype=float)

        def full(z: Vector) -> Vector:
            x[free] = z
            return x

        result = root(
            lambda z: self.derivatives(full(z), u),
            x[free].copy(),
            jac=lambda z: self.linearise(full(z), u).A[:, free],
            method="lm",
            options={"xtol": 1e-15, "ftol": 1e-15},
        )
        residual = np.abs(self.derivatives(full(result.x), u)).max()
        if residual > tol * max(1.0, np.abs(self.derivatives(guess, u)).max()):
            raise ArithmeticError(f"no trim found: largest |dx/dt| is {residual:.3g}")
        return x

    def reference(
        self,
        t: Sequence[float] | Vector,
        u: InputFunction | None = None,
        breaks: Sequence[float] = (),
        *,
        method: str = "DOP853",
        rtol: float = 1e-10,
        atol: float = 1e-12,
    ) -> Reference:
        """Integrate from the start values with a variable step, piecewise between ``breaks``.

        ``u(t, x)`` returns values by input port name, ``x`` having one array per state port;
        inputs it does not name keep what was set. At the end of a piece it is asked just
        before the break, so that a jump there belongs to the next piece. Every time in ``t``
        ends a step of the integrator too: between its steps it could only interpolate, with
        an error that nobody controls. ``method`` is one of SciPy's RK23, RK45, DOP853, Radau
        and BDF, or SUNDIALS' CVODES, which is compiled and many times faster: there ``u`` is
        called once, with CasADi's symbols, and returns expressions; values between its
        steps are those of its own polynomials. Raises ArithmeticError if the
        integration fails, InputError if ``u`` names something that is no input.
        """
        times = np.asarray(t, dtype=float)
        if method == "CVODES":
            return self._by_sundials(times, u, breaks, rtol, atol)
        from scipy import integrate

        solver_class = getattr(integrate, method)
        model, p, x = self.compiled(), self._stacked_p(), self._start_state()
        arguments, dx = [x.copy(), self._stacked_u(None), p], np.zeros(len(x))
        _buffer, evaluate = bind(model.rhs, arguments, dx)
        last = times[-1]

        def slope(time: float, x: Vector) -> Vector:
            arguments[0][:] = x
            if u is not None:
                arguments[1][:] = self._with_inputs(u(min(time, last), self._named(x)))
            evaluate()
            return dx.copy()

        inner = {b for b in breaks if times[0] < b < times[-1]}
        solved = {times[0]: x}
        edges = sorted({*times.tolist(), *inner})
        first_step = None
        for a, b in itertools.pairwise(edges):
            last = float(np.nextafter(b, a))
            if first_step is not None:
                first_step = min(first_step, b - a)
            solver = solver_class(slope, a, x, b, rtol=rtol, atol=atol, first_step=first_step)
            while solver.status == "running":
                message = solver.step()
            if solver.status != "finished":
                raise ArithmeticError(f"integration stopped at t = {solver.t}: {message}")
            solved[b] = x = solver.y
            first_step = None if b in inner else solver.h_abs
        return Reference(times, np.array([solved[time] for time in times.tolist()]), model.x_names)

    # ------------------------------------------------------------------ inside

    def _by_sundials(
        self,
        times: Vector,
        u: InputFunction | None,
        breaks: Sequence[float],
        rtol: float,
        atol: float,
    ) -> Reference:
        def inputs(t: Any, x: Any) -> Any:
            if u is None:
                return self._stacked_u(None)
            try:
                given = u(t, self._named(x))
            except (TypeError, RuntimeError) as error:
                raise InputError(
                    f"{self.name}: CVODES takes inputs that are expressions of CasADi: {error}"
                ) from error
            return self._inputs_of(given)

        model, x = self.compiled(), self._start_state()
        sundials = Sundials(model, inputs, self._stacked_p(), rtol=rtol, atol=atol)
        solved = {times[0]: x}
        edges = [times[0], *sorted({b for b in breaks if times[0] < b < times[-1]}), times[-1]]
        for a, b in itertools.pairwise(edges):
            at = [a, *(time for time in times.tolist() if a < time < b), b]
            rows = sundials.piece(x, at)
            solved.update(zip(at[1:], rows, strict=True))
            x = rows[-1]
        return Reference(times, np.array([solved[time] for time in times.tolist()]), model.x_names)

    @classmethod
    def _compile(cls, texts: Mapping[str, str]) -> Model:
        model = compile_model(*cls._stated(texts))
        for output, given in sorted(coupled(model.out, cls.input_ports, cls.output_ports)):
            if given not in cls.feedthrough.get(output, (given,)):
                raise InputError(
                    f"{cls.__name__}.feedthrough says that {output!r} does not depend on "
                    f"{given!r}, but the equations couple them: name it there, or leave {output!r} "
                    "out, then the equations say it"
                )
        return model

    @classmethod
    def coupled(cls, texts: Mapping[str, str]) -> Pairs:
        """Return the (output, input) pairs that the equations couple, with these text parameters.

        Outputs are those that are not states. Raises InputError for whatever equations raise.
        """
        return coupled(compile_outputs(*cls._stated(texts)), cls.input_ports, cls.output_ports)

    @classmethod
    def _stated(cls, texts: Mapping[str, str]) -> tuple[Any, ...]:
        """Return the equations with the ports that they are for, as `compile_model` takes them."""
        if cls.equations is Plant.equations:
            raise TypeError(f"{cls.__name__} defines no equations")
        stub = cls.__new__(cls)  # has the methods and no values
        ports = cls.state_ports, cls.input_ports, cls.parameter_ports, cls.output_ports
        return cls.__name__, stub.equations, *ports, texts

    def _build_buffers(self) -> None:
        # A buffer does not keep its arrays alive: they stay attributes of the instance.
        model = self.compiled()
        self._u, self._p = self._stacked_u(None), self._stacked_p()
        self._h, self._x1 = np.zeros(1), np.zeros(len(model.x_names))
        self._y = np.zeros(len(model.y_names))
        self._buffers = {
            "rk4": bind(self.machine(model.rk4), [self._x, self._u, self._p, self._h], self._x1),
            "out": bind(self.machine(model.out), [self._x, self._u, self._p], self._y),
        }

    def _load(self) -> None:
        """Copy inputs and tunable parameters into the arrays that the functions read."""
        self._u[:] = self.values[self._u_slice]
        if self._has_tunables:
            self._p[:] = self._stacked_p()

    def _publish(self, runs: Sequence[_Run], stacked: list[float]) -> None:
        for there, here in runs:
            self.values[there] = stacked[here]

    def _start_state(self) -> Vector:
        starts = [self.ports[f"{s.name}_start"] for s in self.state_ports]
        return np.array([v for p in starts for v in self.values[p.offset : p.offset + p.size]])

    def _stacked_u(self, u: Vector | None) -> Vector:
        return np.array(self.values[self._u_slice] if u is None else u, dtype=float)

    def _stacked_p(self) -> Vector:
        return np.array([self.values[r] for r in self._p_references], dtype=float)

    def _named(self, x: Vector) -> SimpleNamespace:
        named: dict[str, Any] = {}
        place = 0
        for port in self.state_ports:
            named[port.name] = x[place : place + port.size] if port.axes else x[place]
            place += port.size
        return SimpleNamespace(**named)

    def _with_inputs(self, inputs: Mapping[str, Any]) -> Vector:
        values = self._stacked_u(None)
        for name, value in inputs.items():
            values[self._place_of(name)] = value
        return values

    def _inputs_of(self, inputs: Mapping[str, Any]) -> Any:
        """Return the same as `_with_inputs`, of expressions."""
        values = ca.SX(self._stacked_u(None))
        for name, value in inputs.items():
            values[self._place_of(name)] = ca.vertcat(*value) if _is_row(value) else value
        return values

    def _place_of(self, name: str) -> slice:
        """Return where an input stands among the stacked ones."""
        if name not in self.ports or self.ports[name].kind != "input":
            known = [port.name for port in self.input_ports]
            raise InputError(f"{self.name}: {unknown('input', name, known)}")
        port = self.ports[name]
        first = port.offset - self._u_slice.start
        return slice(first, first + port.size)


def _runs(ports: Sequence[Port]) -> tuple[_Run, ...]:
    """Return the runs of ports, as long as they can be: they are copied many times a second."""
    runs: list[_Run] = []
    place = 0
    for port in ports:
        first = port.offset
        if runs and runs[-1][0].stop == first:
            first -= runs[-1][0].stop - runs[-1][0].start
            runs.pop()
        end = port.offset + port.size
        runs.append(
            (slice(first, end), slice(place + port.size - (end - first), place + port.size))
        )
        place += port.size
    return tuple(runs)


def _is_row(value: Any) -> bool:
    return isinstance(value, (tuple, list))
