"""First-order wave loads on slender hulls by strips, as forces per metre of wave amplitude."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from .numbers import GRAVITY, WATER_DENSITY, Array, Complex, Numbers


@dataclass(frozen=True, eq=False)
class Strips:
    """Sections of a hull, or of two alike hulls, from stern to bow, at zero speed.

    Arrays over sections; a coefficient may have a second axis over the frequencies that forces
    are asked for. With constant coefficients the forces are those of relative motion: take a33
    and b33 such that their integrals are the craft's own added mass and damping in heave, so that
    both sides of its equation describe one hydrodynamics. Diffraction at the ends and interaction
    between hulls are left out: within 2 % of the amplitude in heave and 4 % of the slope in pitch
    for waves of 1.5 lengths (head seas) and 10 beams (beam seas).
    """

    x: Array
    """Ahead of midships, m, evenly spaced: the middles of the strips."""
    beam: Array
    """b at the water line, m."""
    area: Array
    """S under water, m2."""
    draught: Array
    """T, m."""
    a33: Array
    """Added mass in heave, kg/m."""
    b33: Array
    """Damping in heave, N s/m2."""
    a22: Array
    """Added mass in sway, kg/m."""
    b22: Array
    """Damping in sway, N s/m2."""
    a42: Array
    """Added mass of roll by sway, kg."""
    b42: Array
    """Damping of roll by sway, N s/m."""
    hulls: tuple[float, ...] = (0.0,)
    """y of each hull's centre line, m to starboard."""
    round: bool = False
    """Sections are arcs about their middle at the water line, where pressure has no moment of
    roll; otherwise they are boxes."""
    haskind: bool = False
    """Size of the force in heave from b33 at its frequency (Haskind), phase as by relative
    motion. The craft's radiation must then be of the same a33 and b33 at each frequency."""
    density: float = WATER_DENSITY
    gravity: float = GRAVITY

    def __post_init__(self) -> None:
        if len(self.x) < 2 or not np.allclose(np.diff(self.x), self.x[1] - self.x[0]):
            raise InputError("strips need at least two sections, evenly spaced from stern to bow")

    @property
    def spacing(self) -> float:
        """Length of a strip, m."""
        return float(self.x[1] - self.x[0])

    def forces(self, omega: Array, k: Array, chi: Numbers) -> Complex:
        """Return X, Y, Z, K, M, N per metre of amplitude, {b} about midships at the water line.

        A column per frequency w, rad/s, with its wave number k, rad/m, and direction relative to
        the bow, rad: 0 following sea, pi head sea, pi/2 to starboard. Of exp(i theta), theta the
        wave's phase at midships; without stretching, for the mean wetted surface.
        """
        x = self.x[:, None]
        up, ahead, starboard, moment = self._sections(omega, k, chi)
        along = np.exp(-1j * k * x * np.cos(chi))
        lifted, turned = up * along, starboard * along
        f1, f2, f3 = (ahead * along).sum(0), turned.sum(0), lifted.sum(0)
        m4, m5, m6 = (moment * along).sum(0), (x * lifted).sum(0), (x * turned).sum(0)
        total = np.zeros((6, len(omega)), dtype=complex)
        for y in self.hulls:
            across = np.exp(-1j * k * y * np.sin(chi))
            total += across * np.stack([f1, f2, -f3, m4 - y * f3, m5, m6 - y * f1])
        return np.asarray(total * self.spacing)

    def _sections(
        self, omega: Array, k: Array, chi: Numbers
    ) -> tuple[Complex, Complex, Complex, Complex]:
        """Forces up, ahead and to starboard, N/m, and roll moment, N, where the wave is 1 m."""
        weight, sine, cosine = self.density * self.gravity, np.sin(chi), np.cos(chi)
        beam, area, draught = (v[:, None] for v in (self.beam, self.area, self.draught))
        # In a section without area at an end nothing acts, but its mean draught is 0/0.
        depth = np.divide(area, beam, out=np.zeros_like(area), where=beam > 0.0)
        a33, b33, a22, b22, a42, b42 = (
            v if v.ndim == 2 else v[:, None]
            for v in (self.a33, self.b33, self.a22, self.b22, self.a42, self.b42)
        )
        buoyancy = weight * beam * np.sinc(k * beam * sine / (2.0 * np.pi))
        up: Complex = (buoyancy - a33 * omega**2 + 1j * omega * b33) * np.exp(-k * depth)
        if self.haskind:
            up = np.sqrt(self.density * self.gravity**2 * b33 / omega) * np.exp(1j * np.angle(up))
        velocity = omega * np.exp(-0.5 * k * depth)
        rate: Complex = np.asarray(1j * omega * velocity)
        mass = self.density * area
        ahead: Complex = mass * rate * cosine
        starboard: Complex = ((mass + a22) * rate + b22 * velocity) * sine
        moment: Complex = (a42 * rate + b42 * velocity) * sine
        if self.round:
            return up, ahead, starboard, moment
        fade = np.exp(-k * draught)
        # int_0^T z e^-kz dz
        lever = (1.0 - fade * (1.0 + k * draught)) / k**2
        tilt = weight * 1j * k * sine * (beam**3 / 12.0 * fade - beam * lever)
        return up, ahead, starboard, moment + tilt

    def added_mass_and_damping(self) -> tuple[Array, Array]:
        """Return A and B of heave, roll (of twin hulls) and pitch, (3, 3) or (3, 3, w).

        In {b}, from a33 and b33 alone: what the craft's equations must have beside the forces.
        """
        return self._integrated(self.a33), self._integrated(self.b33)

    def _integrated(self, coefficient: Array) -> Array:
        by_x = [np.tensordot(self.x**n, coefficient, (0, 0)) * self.spacing for n in range(3)]
        heave, first, second = (len(self.hulls) * part for part in by_x)
        y = np.array(self.hulls)
        roll, coupled = (y**2).sum() * by_x[0], y.sum() * by_x[0]
        skew = -y.sum() * by_x[1]
        return np.array([[heave, coupled, -first], [coupled, roll, skew], [-first, skew, second]])
