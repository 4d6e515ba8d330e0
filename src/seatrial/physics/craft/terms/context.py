"""Motion, attitude and parameters of a craft, which hydrodynamic terms are functions of."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import casadi as ca


@dataclass(frozen=True)
class Context:
    """Arguments of terms, as CasADi expressions; {n} north-east-down, {b} body axes."""

    position: Any
    """Body origin in {n}, m."""
    attitude: Any
    """Euler angles phi, theta, psi, rad."""
    R: Any
    """Rotation from {b} to {n}."""
    nu: Any
    """Velocity of the body origin over ground, m/s, and angular rate, rad/s, {b}."""
    nu_r: Any
    """``nu`` less the velocity of the water."""
    M: Any
    """Mass matrix about the body origin, with added mass (6, 6)."""
    inputs: SimpleNamespace
    """Inputs of the craft by name."""
    parameters: SimpleNamespace
    """Parameters of the craft by name; texts are plain strings."""

    @property
    def vertical(self) -> Any:
        """Unit vector downwards, {b}."""
        return self.R[2, :].T

    @property
    def is_floating(self) -> bool:
        """Say if the surface is known: ``restoring`` = "floating"."""
        return bool(self.parameters.restoring == "floating")

    def at(self, place: Any) -> Any:
        """Return the velocity of a point of the craft through the water, {b}, m/s."""
        return self.nu_r[:3] + ca.cross(self.nu_r[3:], place)

    def depth(self, place: Any) -> Any:
        """Return the depth of a point of the craft below the surface, m.

        In waves the surface is that above the body origin.
        """
        z = self.position[2] + getattr(self.inputs, "water_elevation", 0)
        return z + self.vertical.T @ place


def wrench(force: Any, place: Any) -> Any:
    """Return the load (6,) of a force at a point of the craft: the force, and its moment."""
    return ca.vertcat(force, ca.cross(place, force))


def smooth_step(x: Any) -> Any:
    """Return 0 below x = 0, 1 above 1, and 3 x^2 - 2 x^3 between."""
    held = ca.fmin(ca.fmax(x, 0), 1)
    return held**2 * (3 - 2 * held)
