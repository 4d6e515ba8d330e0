"""Radiation and excitation of a hull from a panel code, in the project's axes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from seatrial.errors import InputError
from seatrial.physics.sea.loads import Response, tabulated
from seatrial.physics.sea.numbers import Array, Complex

TURNED = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
"""Signs of six motions or forces between z up, y to port and z down, y to starboard."""

_WIDEST = math.radians(45.0)
_FADED = 1.25


@dataclass(frozen=True, eq=False)
class PanelTables:
    """Tables of one hull at zero speed, SI, about the origin of x ahead, y to starboard, z down.

    Motions and forces in the order surge, sway, heave, roll, pitch, yaw.
    """

    omega: Array
    """Frequencies of radiation, rad/s, (w,), rising."""
    added: Array
    """A, (w, 6, 6)."""
    damping: Array
    """B, (w, 6, 6)."""
    infinite: Array
    """A at infinite frequency, (6, 6)."""
    wave_omega: Array
    """Frequencies of the waves, rad/s, rising."""
    chi: Array
    """Direction of waves from the bow, rad, clockwise from above: 0 following sea, (c,)."""
    excitation: Complex
    """Force of fixed hull per metre of amplitude, (6, w, c), of exp(i theta) at the origin."""

    def moved(self, place: Array) -> PanelTables:
        """Return the tables about a point that the origin lies ``place``, m, from.

        With H = [[1, -S(place)], [0, 1]]: A becomes H^T A H, the excitation H^T F, and its phase
        that at the new point.
        """
        x, y, z = np.asarray(place, dtype=float).tolist()
        skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        H = np.eye(6)
        H[:3, 3:] = -skew
        return replace(
            self,
            added=H.T @ self.added @ H,
            damping=H.T @ self.damping @ H,
            infinite=H.T @ self.infinite @ H,
            excitation=np.einsum("ji,jwc->iwc", H, self.excitation),
        )

    def response(self, ahead: float = 0.0, gravity: float = 9.81) -> Response:
        """Return the excitation by frequency and direction; of the phase ``ahead`` m astern of it.

        Linear between directions and frequencies; below the table its first row, above it fades
        out within a quarter of the highest frequency: short waves push on both ends of a hull.
        """
        phase = np.square(self.wave_omega)[:, None] / gravity * ahead * np.cos(self.chi)
        forces = self.excitation * np.exp(-1j * phase)
        omega = np.append(self.wave_omega, _FADED * self.wave_omega[-1])
        table = np.concatenate([forces, np.zeros_like(forces[:, :1])], 1)
        return tabulated(omega, self.chi, table)


def all_round(chi: Array, excitation: Complex) -> tuple[Array, Complex]:
    """Return directions over one turn, rising, and the forces in them.

    Directions of one side alone, within 0 to pi, are met from the other side too, by a hull that
    is alike on both. Raises InputError for directions more than 45 degrees apart.
    """
    chi = np.remainder(np.round(chi, 9), round(math.tau, 9))
    order = np.argsort(chi, kind="stable")
    chi, excitation = chi[order], excitation[:, :, order]
    once = np.append(True, np.diff(chi) > 1e-6)
    chi, excitation = chi[once], excitation[:, :, once]
    below, above = chi.max() <= math.pi + 1e-6, chi[chi > 1e-6].min(initial=9.0) >= math.pi - 1e-6
    if below or above:
        mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])[:, None, None]
        inside = np.abs(np.sin(chi)) > 1e-6
        chi = np.concatenate([chi, math.tau - chi[inside]])
        excitation = np.concatenate([excitation, mirror * excitation[:, :, inside]], 2)
        order = np.argsort(chi)
        chi, excitation = chi[order], excitation[:, :, order]
    gaps = np.diff(np.append(chi, chi[0] + math.tau))
    if gaps.max() > _WIDEST + 1e-3:
        degrees = ", ".join(f"{d:g}" for d in np.degrees(chi).round(3))
        raise InputError(f"wave directions lie more than 45 degrees apart: {degrees}")
    return chi, excitation
