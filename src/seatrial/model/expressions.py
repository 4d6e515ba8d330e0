"""Compiled functions of a plant's equations, which are CasADi expressions."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .ports import Port

Vector = NDArray[np.float64]
Equations = Callable[
    [SimpleNamespace, SimpleNamespace, SimpleNamespace], tuple[Mapping[str, Any], Mapping[str, Any]]
]

Pairs = set[tuple[str, str]]


@dataclass(frozen=True)
class Model:
    """Compiled equations: CasADi functions of stacked vectors, and their names.

    ``rhs(x, u, p)`` is dx/dt, ``rk4(x, u, p, h)`` one classical Runge-Kutta step,
    ``out(x, u, p)`` the outputs that are not states, ``jacobians(x, u, p)`` the matrices
    A, B, C, D. x, u, p stack the states, inputs and real parameters as declared.
    """

    rhs: ca.Function
    rk4: ca.Function
    out: ca.Function
    jacobians: ca.Function
    x_names: tuple[str, ...]
    u_names: tuple[str, ...]
    y_names: tuple[str, ...]


def compile_model(
    name: str,
    equations: Equations,
    states: Sequence[Port],
    inputs: Sequence[Port],
    parameters: Sequence[Port],
    outputs: Sequence[Port],
    texts: Mapping[str, str],
) -> Model:
    """Compile ``equations`` for the given ports; ``texts`` are the text parameters' values.

    Raises TypeError if the equations' result does not match the ports, and InputError, with
    file and line, for whatever they raise.
    """
    x, u, p = (_symbols(ports) for ports in (states, inputs, parameters))
    named_p = SimpleNamespace(**vars(p.named), **texts)
    derivatives, other = _evaluated(name, equations, x.named, u.named, named_p)
    dx = _stacked(f"{name}: derivatives", derivatives, states)
    y = _stacked(f"{name}: outputs", other, outputs)
    rhs = ca.Function("rhs", [x.all, u.all, p.all], [ca.cse(dx)])
    h = ca.SX.sym("h")
    stepped = runge_kutta(rhs, x.all, (u.all, u.all, u.all), p.all, h)
    matrices = [ca.densify(ca.jacobian(f, v)) for f in (dx, y) for v in (x.all, u.all)]
    return Model(
        rhs=rhs,
        rk4=ca.Function("rk4", [x.all, u.all, p.all, h], [stepped]),
        out=ca.Function("out", [x.all, u.all, p.all], [ca.densify(y)]),
        jacobians=ca.Function("jacobians", [x.all, u.all, p.all], matrices),
        x_names=_names(states),
        u_names=_names(inputs),
        y_names=_names(outputs),
    )


def _evaluated(
    name: str, equations: Equations, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> Any:
    """Return what the equations give: derivatives, and outputs beside the states.

    Raises InputError that points at the line of the equations that raised.
    """
    try:
        found = equations(x, u, p)
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        code = getattr(equations, "__code__", None)
        own = [frame for frame in frames if code and frame.filename == code.co_filename]
        line = (own or frames)[-1]
        known = [f"{key} has {', '.join(vars(each)) or 'nothing'}" for key, each in _of(x, u, p)]
        hint = f" ({'; '.join(known)})" if isinstance(error, AttributeError) else ""
        raise InputError(
            f"{name}: {Path(line.filename).name}, line {line.lineno}: {line.line}: "
            f"{type(error).__name__}: {error}{hint}"
        ) from error
    if not (isinstance(found, tuple) and len(found) == 2):
        raise TypeError(f"{name}: equations return derivatives and outputs, found {found!r}")
    return found


def _of(*named: SimpleNamespace) -> Iterator[tuple[str, SimpleNamespace]]:
    return zip("xup", named, strict=True)


def rk4_between(rhs: ca.Function) -> ca.Function:
    """Return a Runge-Kutta step (x, u0, u, u1, p, h): inputs at its beginning, middle and end.

    ``rhs`` is that of a `Model`.
    """
    x, u, p = (ca.SX.sym(name, rhs.size1_in(i)) for i, name in enumerate("xup"))
    u0, u1 = (ca.SX.sym(name, rhs.size1_in(1)) for name in ("u0", "u1"))
    h = ca.SX.sym("h")
    return ca.Function("rk4", [x, u0, u, u1, p, h], [runge_kutta(rhs, x, (u0, u, u1), p, h)])


def runge_kutta(rhs: ca.Function, x: Any, u: tuple[Any, Any, Any], p: Any, h: Any) -> Any:
    """Return x after a classical Runge-Kutta step, with ``u`` at its beginning, middle and end."""
    k1 = rhs(x, u[0], p)
    k2 = rhs(x + h / 2 * k1, u[1], p)
    k3 = rhs(x + h / 2 * k2, u[1], p)
    k4 = rhs(x + h * k3, u[2], p)
    return ca.cse(x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))


class Sundials:
    """Integrates the states of a model by SUNDIALS' CVODES, compiled, with the exact Jacobian.

    Backward differentiation, of variable order and step. ``u`` returns the stacked inputs as an
    expression of time, s, and stacked state, asked for times before the end of a piece alone.
    """

    def __init__(
        self, model: Model, u: Callable[[Any, Any], Any], p: Vector, *, rtol: float, atol: float
    ) -> None:
        share, piece = ca.SX.sym("share"), ca.SX.sym("piece", 3)  # of a piece: begin, length, last
        x = ca.SX.sym("x", model.rhs.size1_in(0))
        t = ca.fmin(piece[0] + share * piece[1], piece[2])
        ode = piece[1] * model.rhs(x, u(t, x), ca.DM(p))
        self._problem = {"x": x, "t": share, "p": piece, "ode": ode}
        self._options = {
            "reltol": rtol,
            "abstol": atol,
            "max_num_steps": 1_000_000,
            "show_eval_warnings": False,
        }
        self._solvers: dict[tuple[float, ...], ca.Function] = {}

    def piece(self, start: Vector, times: Sequence[float]) -> Vector:
        """Return the states, one row for each time behind the first, where they are ``start``.

        Raises ArithmeticError if the integration fails.
        """
        begin, length = times[0], times[-1] - times[0]
        shares = tuple((time - begin) / length for time in times[1:])
        try:
            if shares not in self._solvers:
                self._solvers[shares] = ca.integrator(
                    "reference", "cvodes", self._problem, 0.0, list(shares), self._options
                )
            piece = [begin, length, np.nextafter(times[-1], begin)]
            return np.asarray(self._solvers[shares](x0=start, p=piece)["xf"]).T
        except RuntimeError as error:
            reason = str(error).strip().splitlines()[-1]
            raise ArithmeticError(f"integration stopped after t = {begin}: {reason}") from None


def coupled(out: ca.Function, inputs: Sequence[Port], outputs: Sequence[Port]) -> Pairs:
    """Return the (output, input) port pairs that the expressions of ``out(x, u, p)`` couple."""
    rows, columns = out.jac_sparsity(0, 1).get_triplet()
    owner_y = [port.name for port in outputs for _ in range(port.size)]
    owner_u = [port.name for port in inputs for _ in range(port.size)]
    return {(owner_y[r], owner_u[c]) for r, c in zip(rows, columns, strict=True)}


def compile_outputs(
    name: str,
    equations: Equations,
    states: Sequence[Port],
    inputs: Sequence[Port],
    parameters: Sequence[Port],
    outputs: Sequence[Port],
    texts: Mapping[str, str],
) -> ca.Function:
    """Return ``out`` of `compile_model` alone. Raises as it does."""
    x, u, p = (_symbols(ports) for ports in (states, inputs, parameters))
    named_p = SimpleNamespace(**vars(p.named), **texts)
    _, other = _evaluated(name, equations, x.named, u.named, named_p)
    y = _stacked(f"{name}: outputs", other, outputs)
    return ca.Function("out", [x.all, u.all, p.all], [y])


def bind(
    function: ca.Function, arguments: Sequence[Vector], result: Vector
) -> tuple[Any, Callable[[], None]]:
    """Bind a function to arrays; the returned callable evaluates it from and into them.

    The caller keeps the arrays and the first element of the pair alive.
    """
    buffer, evaluate = function.buffer()
    bound: Any = buffer  # CasADi's own annotations describe the C signature
    for index, argument in enumerate(arguments):
        if argument.size:
            bound.set_arg(index, argument.data)
    if result.size:
        bound.set_res(0, result.data)
    return buffer, evaluate


@dataclass(frozen=True)
class _Symbols:
    all: ca.SX
    named: SimpleNamespace


def _symbols(ports: Sequence[Port]) -> _Symbols:
    named = {port.name: ca.SX.sym(port.name, port.size) for port in ports}
    return _Symbols(ca.vertcat(*named.values()) if named else ca.SX(0, 1), SimpleNamespace(**named))


def _names(ports: Sequence[Port]) -> tuple[str, ...]:
    return tuple(name for port in ports for name in port.scalar_names)


def _stacked(what: str, values: Mapping[str, Any], ports: Sequence[Port]) -> ca.SX:
    expected = {port.name: port for port in ports}
    if set(values) != set(expected):
        raise TypeError(f"{what}: {sorted(values)} do not match the ports {sorted(expected)}")
    parts = []
    for name, port in expected.items():
        part = ca.SX(values[name])
        if part.shape != (port.size, 1):
            raise TypeError(f"{what}: {name} has shape {part.shape}, its port {(port.size, 1)}")
        parts.append(part)
    return ca.densify(ca.vertcat(*parts)) if parts else ca.SX(0, 1)
