"""Rotations as CasADi expressions, for equations of motion; conventions as in `kinematics`."""

from __future__ import annotations

from typing import Any

import casadi as ca

from .kinematics import rotation_rows


def rotation_matrix(attitude: Any) -> Any:
    """Return R (3, 3) of a CasADi column (phi, theta, psi), with v_n = R v_b."""
    angles = ca.vertsplit(attitude)
    rows = rotation_rows([ca.sin(a) for a in angles], [ca.cos(a) for a in angles])
    return ca.vertcat(*(ca.horzcat(*row) for row in rows))


def euler_rate_matrix(attitude: Any) -> Any:
    """Return T (3, 3) of a CasADi column (phi, theta, psi): Euler-angle rates are T (p, q, r).

    Singular at theta = +-pi/2, where Euler angles do not describe an attitude uniquely.
    """
    phi, theta, _psi = ca.vertsplit(attitude)
    return ca.vertcat(
        ca.horzcat(1, ca.sin(phi) * ca.tan(theta), ca.cos(phi) * ca.tan(theta)),
        ca.horzcat(0, ca.cos(phi), -ca.sin(phi)),
        ca.horzcat(0, ca.sin(phi) / ca.cos(theta), ca.cos(phi) / ca.cos(theta)),
    )


def skew(a: Any) -> Any:
    """Return S (3, 3) of a CasADi column, with S(a) b = a x b ([Timm2026], eq. 20)."""
    x, y, z = ca.vertsplit(a)
    return ca.vertcat(ca.horzcat(0, -z, y), ca.horzcat(z, 0, -x), ca.horzcat(-y, x, 0))
