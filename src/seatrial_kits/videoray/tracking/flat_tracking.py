"""Flatness-based control of a vessel's velocities."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from seatrial.errors import InputError
from seatrial.model.component import Parameter

from .flat_outputs import Derivative, controllability_matrix, flat_output, tracking_gain
from .vessel_tracking import VesselTracking

_INDICES = (1, 2)
_DESIGNS = ("LTV", "LTI")
_SCALINGS = ("constant", "determinant")


class FlatTracking(VesselTracking):
    """Law of [Paulino2015]: flat outputs of the vessel linearised along its trajectory.

    With A, B the Jacobians of the vessel at (U, V, R), dx = nu - (U, V, R), Kronecker indices
    (1, 2) and C_K = (b1, b2, A b2), the flat outputs are F = alpha S C_K^-1 dx (4.15):

        F1 = m11 du + (m33 / l) dr + c1 dv,   F2 = dv            ("constant", see below)

    and the commands are tau_d + G dx, with which in the linear model

        F1' + K01 F1 = 0,   F2'' + K12 F2' + K02 F2 = 0

    ``gain`` is (K01, K02, K12). ``design`` "LTV" takes the derivatives of the trajectory into
    account; "LTI" takes A for constant at each instant. ``scaling`` is alpha: "constant", with
    which F1 and F2 are as above, or "determinant", det C_K for both, which gives (8.1) of the
    source. For a constant trajectory neither makes a difference to the commands.

    G is computed at the start over the whole trajectory, sample by sample, and looked up
    afterwards. Commands reach sway through yaw alone, by (A b2)_2 = E2 (l U m11 - R m33) /
    (m22 m33), which must not change sign.

    The law is a strictly local one: errors of sway are fought by turning, and products of
    errors of 1e-4 are enough to diverge on slow trajectories. No integral action.
    `ComputedTorque` has neither weakness.

    Raises InputError at the start if l U m11 - R m33 is zero or changes sign.
    """

    exercised: ClassVar = {"surge_profile": "polynomial", "duration": 1.0, "command_limit": 1e9}

    transient = VesselTracking.transient | {"_gains"}
    structural: ClassVar[Sequence[str]] = (*VesselTracking.structural, "gain")
    tabulated: ClassVar = {"_prepare": ("_rows", "_gains")}

    gain = Parameter((2.0, 4.0, 4.0), ("1/s", "1/s2", "1/s"), "gains", axes=("K01", "K02", "K12"))
    design = Parameter("LTV", "1", "whether A is taken as varying or constant", choices=_DESIGNS)
    scaling = Parameter("constant", "1", "alpha of the flat outputs", choices=_SCALINGS)

    def demand(self, k: int) -> tuple[float, float]:
        """Return the commands of the law."""
        row = self._row(k)
        du, dv, dr = (
            x - nominal for x, nominal in zip(self._measured(), row.velocity, strict=True)
        )
        gains = self._gains[min(k, len(self._gains) - 1)]
        first, second = (
            command + g_u * du + g_v * dv + g_r * dr
            for command, (g_u, g_v, g_r) in zip(row.command, gains, strict=True)
        )
        return first, second

    def _prepare(self) -> None:
        super()._prepare()
        self._require_controllable()
        gains = _gain_function(self.design, self.scaling)
        motion = np.array([[*r.velocity, *r.acceleration, *r.jerk] for r in self._rows]).T
        model = [*self.mass, *self.damping, *self.thrust, self.lever_arm, self.yaw_coupling_sign]
        count = len(self._rows)
        found = gains.map(count)(motion, np.array(model), np.array(self.gain))
        self._gains: list[list[list[float]]] = (
            np.array(found).reshape(2, count, 3).transpose(1, 0, 2).tolist()
        )

    def _require_controllable(self) -> None:
        m11, _m22, m33 = self.mass
        found = []
        for row in self._rows:
            U, _V, R = row.velocity
            found.append(self.lever_arm * U * m11 - R * m33)
        least, most = min(found), max(found)
        if not least * most > 0.0:
            raise InputError(
                f"{self.name}: l U m11 - R m33 goes from {least:.4g} to {most:.4g} kg.m2/s along "
                "the trajectory; with flat outputs it must be on one side of 0 throughout"
            )


def vessel_jacobians(nu: Any, p: SimpleNamespace) -> tuple[Any, Any]:
    """Return A (3, 3) and B (3, 2) of a `SurfaceVessel` at nu = (u, v, r), CasADi expressions.

    ``p`` has the parameters of the vessel: mass, damping (3,), thrust (2,), lever_arm and
    yaw_coupling_sign. The Jacobian of [Paulino2015], eq. 5.18, with respect to nu and commands,
    not the matrix of its eq. 6.5, which is that of a product A(x) x.
    """
    u, v, r = ca.vertsplit(nu)
    m11, m22, _m33 = ca.vertsplit(p.mass)
    coriolis = ca.vertcat(-m22 * v * r, m11 * u * r, -p.yaw_coupling_sign * (m11 - m22) * u * v)
    E1, E2 = ca.vertsplit(p.thrust)
    effect = ca.vertcat(ca.horzcat(E1, E2), ca.DM.zeros(1, 2), p.lever_arm * ca.horzcat(E1, -E2))
    return ca.jacobian((-p.damping * nu - coriolis) / p.mass, nu), effect / ca.repmat(p.mass, 1, 2)


@cache
def _gain_function(design: str, scaling: str) -> Any:
    """Return G (2, 3) as a function of the motion (9,), the vessel's parameters and gains."""
    motion, model, K = ca.SX.sym("motion", 9), ca.SX.sym("model", 10), ca.SX.sym("K", 3)
    p = SimpleNamespace(
        mass=model[0:3],
        damping=model[3:6],
        thrust=model[6:8],
        lever_arm=model[8],
        yaw_coupling_sign=model[9],
    )

    def derivative(expression: Any) -> Any:
        """Return d/dt along the trajectory, of which two derivatives are known."""
        if design == "LTI":
            return ca.SX.zeros(expression.shape)
        return ca.jtimes(expression, motion[:6], motion[3:])

    A, B = vessel_jacobians(motion[:3], p)
    F = vessel_flat_output(A, B, p, scaling, derivative)
    G = tracking_gain(A, B, F, _INDICES, ((K[0],), (K[1], K[2])), derivative)
    return ca.Function("gain", [motion, model, K], [G])


def vessel_flat_output(
    A: Any, B: Any, p: SimpleNamespace, scaling: str, derivative: Derivative
) -> Any:
    """Return the matrix (2, 3) of the vessel's flat outputs with the ``scaling`` of the law."""
    C_K = controllability_matrix(A, B, _INDICES, derivative)
    # The first row of C_K^-1 is (m11, c1, m33 / l) / (2 E1), the last one (0, 1 / q, 0).
    constant = [2.0 * p.thrust[0], C_K[1, 2]]
    determinant = [ca.det(C_K)] * 2
    return flat_output(C_K, _INDICES, constant if scaling == "constant" else determinant)
