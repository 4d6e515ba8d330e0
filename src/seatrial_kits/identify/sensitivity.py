"""One sample period of a plant with its exact derivatives by what is to be identified."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

from seatrial.model.expressions import Model


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
    their sensitivities (m, k), likewise. They are the variational equations of the discrete
    step, Runge-Kutta of order 4 in ``substeps`` parts: exact for what is simulated. ``moved`` are
    the places of the states that depend on q, None: all; dx/dq has the rows of those alone.
    """
    period = ca.SX.sym("h")
    x, u = ca.SX.sym("x", len(model.x_names)), ca.SX.sym("u", len(model.u_names))
    after = x
    for _ in range(substeps):
        after = model.rk4(after, u, p, period / substeps)
    readings = read(x, u)
    places = list(range(x.numel())) if moved is None else list(moved)
    own = ca.SX.sym("S", len(places), unknowns.numel())
    sensitivity = ca.SX(x.numel(), unknowns.numel())
    sensitivity[places, :] = own

    def total(f: Any) -> Any:
        return ca.jacobian(f, x) @ sensitivity + ca.jacobian(f, unknowns)

    state = ca.vertcat(x, ca.vec(own))
    following = ca.vertcat(after, ca.vec(total(after)[places, :]))
    rows = ca.vertcat(readings, ca.vec(total(readings)))
    given = ca.vertcat(unknowns, ca.SX(0, 1) if known is None else known, period)
    return ca.Function("period", [state, u, given], [ca.densify(following), ca.densify(rows)])
