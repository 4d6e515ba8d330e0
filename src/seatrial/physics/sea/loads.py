"""Wave loads in time: responses per metre of amplitude, tabulated by heading, times the waves."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from .in_order import summed
from .numbers import Array, Complex, Numbers
from .orbital import Phases
from .waves import Waves

Response = Callable[[Array, Array, Numbers], Complex]
"""Six forces per metre of amplitude, (6, components), of w, rad/s, k, rad/m, and chi, rad."""

Drift = Callable[[Array, Numbers], Array]
"""Mean X, Y, N per square metre of amplitude, (3, components), of w, rad/s, and chi, rad."""

HEADINGS = 180
"""Of the craft, at which loads are tabulated."""
_DRIFTS = [0, 1, 5]


class WaveLoads:
    """Loads of ``waves`` on a craft: tau = sum a Re(F(w, chi) exp(i theta)), and slow drift.

    F is tabulated at each component's frequency and 180 headings of the craft, each when the craft
    first comes near it, and interpolated in real and imaginary part between them. The wave's phase
    is at the craft's position, so that encounter needs nothing else. Drift is Newman's (`drift`),
    Re[conj(sum a exp(i theta)) sum a D(w, chi) exp(i theta)].
    """

    def __init__(self, waves: Waves, response: Response, drift: Drift | None = None) -> None:
        self.waves, self.phases = waves, Phases(waves)
        self._response, self._drift = response, drift
        self._step = math.tau / HEADINGS
        self._tables: dict[int, Array] = {}

    @property
    def drifts(self) -> bool:
        """Whether there is drift."""
        return self._drift is not None

    def table(self, heading: int) -> Array:
        """Return what components contribute at a heading, by its number (n, 2, 6 or 10).

        Of the cosine of each, then of its sine: six loads; where there is drift, its three per
        metre, and the amplitude.
        """
        if heading not in self._tables:
            waves = self.waves
            chi = waves.direction - heading * self._step
            per_wave = self._response(waves.omega, waves.k, chi) * waves.amplitude
            # Re(F (c + i s)) = (Re F, -Im F) (c, s): real numbers are faster.
            parts = np.stack([per_wave.real.T, -per_wave.imag.T], 1)
            if self._drift is not None:
                mean = (self._drift(waves.omega, chi) * waves.amplitude).T
                more = np.concatenate([mean, waves.amplitude[:, None]], 1)
                parts = np.concatenate([parts, np.stack([more, more], 1)], 2)
            self._tables[heading] = np.ascontiguousarray(parts)
        return self._tables[heading]

    def at(self, t: float, x: float, y: float, heading: float) -> Array:
        """Return X, Y, Z, K, M, N, N and N m in {b}, at ``t``, s, and place, m, heading, rad."""
        turned = heading % math.tau / self._step
        whole = math.floor(turned)
        share = turned - whole
        phasors = np.stack(self.phases.at(t, x, y), -1)[:, :, None]
        near, far = (summed(self.table(cell % HEADINGS) * phasors) for cell in (whole, whole + 1))
        of_cosines, of_sines = (1.0 - share) * near + share * far
        load: Array = of_cosines[:6] + of_sines[:6]
        if self._drift is not None:
            load[_DRIFTS] += of_cosines[9] * of_cosines[6:9] + of_sines[9] * of_sines[6:9]
        return load


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
