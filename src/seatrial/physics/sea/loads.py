"""Wave loads in time: responses per metre of amplitude, tabulated by heading, times the waves."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from .numbers import Array, Complex, Numbers
from .orbital import Phases
from .waves import Waves

Response = Callable[[Array, Array, Numbers], Complex]
"""Six forces per metre of amplitude, (6, components), of w, rad/s, k, rad/m, and chi, rad."""

Drift = Callable[[Array, Numbers], Array]
"""Mean X, Y, N per square metre of amplitude, (3, components), of w, rad/s, and chi, rad."""

_HEADINGS = 180
_DRIFTS = [0, 1, 5]


class WaveLoads:
    """Loads of ``waves`` on a craft: tau = sum a Re(F(w, chi) exp(i theta)), and slow drift.

    F is tabulated at each component's frequency and 180 headings of the craft, each when the craft
    first comes near it, and interpolated in real and imaginary part between them. The wave's phase
    is at the craft's position, so that encounter needs nothing else. Drift is Newman's (`drift`),
    Re[conj(sum a exp(i theta)) sum a D(w, chi) exp(i theta)].
    """

    def __init__(self, waves: Waves, response: Response, drift: Drift | None = None) -> None:
        self.waves = waves
        self._response, self._drift = response, drift
        self._step = math.tau / _HEADINGS
        self._rows = 6 if drift is None else 12
        # The rows of a heading stand above those of the next: both in one product.
        self._table = np.empty(((_HEADINGS + 1) * self._rows, 2 * len(waves.omega)))
        self._known = [False] * (_HEADINGS + 1)
        self._phases = Phases(waves)
        self._both = np.empty((2, self._rows))
        self._flat = self._both.reshape(-1)
        self._shares = np.empty(2)
        self._tabulate(0)

    def _tabulate(self, heading: int) -> None:
        """Fill in the rows of a heading, by its number."""
        waves = self.waves
        chi = waves.direction - heading % _HEADINGS * self._step
        per_wave = self._response(waves.omega, waves.k, chi) * waves.amplitude
        # Re(F (c + i s)) = (Re F, -Im F) (c, s): real numbers are faster.
        table = np.concatenate([per_wave.real, -per_wave.imag], -1)
        if self._drift is not None:
            mean = self._drift(waves.omega, chi) * waves.amplitude
            zero = np.zeros_like(mean)
            parts = [np.concatenate(pair, -1) for pair in ((mean, zero), (zero, mean))]
            table = np.concatenate([table, *parts])
        self._table[self._rows * heading : self._rows * (heading + 1)] = table
        self._known[heading] = True

    def at(self, t: float, x: float, y: float, heading: float) -> Array:
        """Return X, Y, Z, K, M, N, N and N m in {b}, at ``t``, s, and place, m, heading, rad."""
        whole, share = divmod((heading % math.tau) / self._step, 1.0)
        cell = int(whole) % _HEADINGS
        for near in (cell, cell + 1):
            if not self._known[near]:
                self._tabulate(near)
        rows = self._table[self._rows * cell : self._rows * (cell + 2)]
        rows.dot(self._phases.move(t, x, y), out=self._flat)
        self._shares[0], self._shares[1] = 1.0 - share, share
        load: Array = self._shares.dot(self._both)
        if self._drift is not None:
            cosines, sines = self._phases.cosines, self._phases.sines
            a = self.waves.amplitude
            load[_DRIFTS] += a.dot(cosines) * load[6:9] + a.dot(sines) * load[9:]
        return load[:6]


def tabulated(omega: npt.ArrayLike, chi: npt.ArrayLike, forces: npt.ArrayLike) -> Response:
    """Return the response that a panel code's table gives.

    ``forces`` (6, w, chi) per metre of amplitude, of exp(i theta), theta the phase at the origin
    of {b}; ``omega`` rising, rad/s; ``chi`` rising within one turn, rad. Linear in real and
    imaginary part, periodic in chi; beyond the table's frequencies the values at its ends.
    """
    rows, columns = np.asarray(omega, dtype=float), np.asarray(chi, dtype=float)
    table = np.asarray(forces, dtype=complex)
    round_chi = np.append(columns, columns[0] + math.tau)
    round_table = np.concatenate([table, table[:, :, :1]], 2)

    def response(w: Array, k: Array, relative: Numbers) -> Complex:
        at = np.interp(w, rows, np.arange(len(rows)))
        turned = columns[0] + np.remainder(relative - columns[0], math.tau)
        across = np.interp(turned, round_chi, np.arange(len(round_chi)))
        across = np.broadcast_to(across, at.shape)
        i = np.minimum(at.astype(int), max(0, len(rows) - 2))
        j = np.minimum(across.astype(int), len(round_chi) - 2)
        p, q = at - i, across - j
        up = np.minimum(i + 1, len(rows) - 1)
        low = (1 - p) * round_table[:, i, j] + p * round_table[:, up, j]
        high = (1 - p) * round_table[:, i, j + 1] + p * round_table[:, up, j + 1]
        return np.asarray((1 - q) * low + q * high)

    return response
