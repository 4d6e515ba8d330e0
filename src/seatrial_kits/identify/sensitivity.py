"""One sample period of a plant with its exact derivatives by what is to be identified."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

from seatrial.model.expressions import Model, runge_kutta


def sensitive_period(
    model: Model,
    unknowns: ca.SX,
    p: Any,
    read: Callable[[Any, Any], Any],
    substeps: int,
    moved: Sequence[int] | None = None,
    known: Any = None,
) -> ca.Function:
    """Return one period: (state with sensitivities, input, q and period) to the next.

    ``unknowns`` q (k,) are the symbols that the stacked parameters ``p`` and ``read`` are made
    of, with those that are ``known``, which then stand between q and the period. ``read(x, u)``
    gives the readings (m,) at the beginning of the period. The state is x (n,)
    with dx/dq (n, k) stacked column by column; the other result is the readings with
    their sensitivities (m, k), likewise. Runge-Kutta of order 4, in ``substeps`` parts, integrates
    the state and its variational equations alike, which gives the exact derivatives of the state's
    own steps. ``moved`` are the places of the states that depend on q, None: all; dx/dq has the
    rows of those alone.
    """
    x, u = ca.SX.sym("x", len(model.x_names)), ca.SX.sym("u", len(model.u_names))
    places = list(range(x.numel())) if moved is None else list(moved)
    own = ca.SX.sym("S", len(places), unknowns.numel())
    sensitivity = ca.SX(x.numel(), unknowns.numel())
    sensitivity[places, :] = own
    state = ca.vertcat(x, ca.vec(own))
    given = ca.vertcat(unknowns, ca.SX(0, 1) if known is None else known)

    def varied(name: str, f: Any, rows: Sequence[int]) -> ca.Function:
        total = ca.jacobian(f, x) @ sensitivity + ca.jacobian(f, unknowns)
        stacked = ca.vertcat(f, ca.vec(total[rows, :]))
        return ca.Function(name, [state, u, given], [ca.densify(ca.cse(stacked))])

    readings = read(x, u)
    slope = varied("slope", model.rhs(x, u, p), places)
    rows = varied("rows", readings, range(readings.numel()))
    z, v = ca.MX.sym("z", state.numel()), ca.MX.sym("v", u.numel())
    last = ca.MX.sym("given", given.numel() + 1)
    q, period = last[:-1], last[-1]
    after = z
    for _ in range(substeps):
        after = runge_kutta(slope, after, (v, v, v), q, period / substeps)
    return ca.Function("period", [z, v, last], [after, rows(z, v, q)])
