"""Memory of radiated waves (Cummins) as states: a passive sum of second-order blocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from .numbers import Array, Complex


@dataclass(frozen=True, eq=False)
class Memory:
    """K(s) = sum a s/(s^2 + 2 z w s + w^2), a, z, w > 0: the force is K times the velocity.

    It takes energy away at every frequency, and there is no force at constant speed.
    """

    gain: Array
    """a, N s/m times rad/s."""
    damping: Array
    """z, 1."""
    omega: Array
    """w, rad/s."""

    def response(self, omega: Array) -> Complex:
        """Return K(i w)."""
        s = 1j * omega[:, None]
        below = s**2 + 2.0 * self.damping * self.omega * s + self.omega**2
        return np.asarray((self.gain * s / below).sum(1))

    def matrices(self) -> tuple[Array, Array, Array]:
        """Return A, B, C of x' = A x + B u, force = C x, two states for each block."""
        n = len(self.gain)
        a, b, c = np.zeros((2 * n, 2 * n)), np.zeros(2 * n), np.zeros(2 * n)
        for i in range(n):
            j = 2 * i
            a[j, j + 1] = 1.0
            a[j + 1, j] = -(self.omega[i] ** 2)
            a[j + 1, j + 1] = -2.0 * self.damping[i] * self.omega[i]
            b[j + 1] = 1.0
            c[j + 1] = self.gain[i]
        return a, b, c


def fitted(omega: Array, added: Array, damping: Array, infinite: float, blocks: int = 3) -> Memory:
    """Return the memory nearest to B(w) + i w (A(w) - A_inf) in the sense of least squares.

    ``omega``, rad/s, rising; ``added`` A and ``damping`` B of one entry of a panel code's table.
    """
    wanted = damping + 1j * omega * (added - infinite)
    scale, middle = abs(wanted).max(), omega[np.argmax(damping)]

    def made(parameters: Array) -> Memory:
        gain, z, w = np.exp(parameters.reshape(3, blocks))
        return Memory(gain * scale * middle, z, w * middle)

    def error(parameters: Array) -> Array:
        off = (made(parameters).response(omega) - wanted) / scale
        return np.concatenate([off.real, off.imag])

    spread = np.log(np.geomspace(0.5, 2.0, blocks))
    start = np.concatenate([np.zeros(blocks), np.full(blocks, np.log(0.4)), spread])
    return made(least_squares(error, start).x)
