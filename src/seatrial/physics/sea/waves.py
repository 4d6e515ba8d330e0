"""Linear waves as a sum of components: elevation, and motion and pressure of the water."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from ...errors import InputError
from . import lattice
from .dispersion import wave_number
from .numbers import GRAVITY, Array, Complex, fixed, require_depth, require_positive
from .spectra import Spectrum, band_energies
from .spreading import Spreading

_FINE = 16
"""Parts of a band, each with even energy, in which shares of the energy are sought."""


@dataclass(frozen=True)
class WaterMotion:
    """Motion of waves at points; the last axis is over the components of a vector, in {n}."""

    elevation: Array
    """Elevation of the surface above the mean, m, positive up."""
    slope: Array
    """Slope of the elevation to north and east, rad."""
    velocity: Array
    """m/s, north, east, down."""
    acceleration: Array
    """m/s2, north, east, down."""
    head: Array
    """Dynamic pressure over rho g, m."""


@dataclass(frozen=True, eq=False)
class Waves:
    """A sea: linear waves sum a cos(w t - k (x cos b + y sin b) + e) in water of a depth.

    Airy's theory. Not modelled: second order, breaking, and that a current changes waves.
    Raises InputError if lengths differ or a frequency or the depth is not above 0.
    """

    amplitude: Array
    """a, m."""
    omega: Array
    """w, rad/s, above 0."""
    direction: Array
    """b, where it goes to, rad from north, clockwise."""
    phase: Array
    """e, rad."""
    depth: float = math.inf
    """h, m."""
    gravity: float = GRAVITY

    def __post_init__(self) -> None:
        for name in ("amplitude", "omega", "direction", "phase"):
            object.__setattr__(self, name, fixed(getattr(self, name)))
        shapes = {self.amplitude.shape, self.omega.shape, self.direction.shape, self.phase.shape}
        if len(shapes) > 1 or self.omega.ndim != 1:
            raise InputError("amplitudes, frequencies, directions and phases differ in number")
        if not (self.omega > 0.0).all():
            raise InputError("frequencies of waves must be above 0")
        require_depth(self.depth)

    @cached_property
    def k(self) -> Array:
        """Wave numbers, rad/m."""
        return fixed(wave_number(self.omega, self.depth, self.gravity))

    @cached_property
    def _headings(self) -> Array:
        return fixed(np.stack([np.cos(self.direction), np.sin(self.direction)]))

    @cached_property
    def _numbers(self) -> Array:
        return fixed(self.k * self._headings)

    def phases(self, t: float, place: npt.ArrayLike) -> Array:
        """Return theta, rad, of each component at ``place`` (..., 2), m north and east."""
        return np.asarray(self.omega * t + self.phase - np.dot(place, self._numbers))

    def phasors(self, t: float, place: Array) -> Complex:
        """Return a exp(i theta), m, of each component: what multiplies a response per metre."""
        theta = self.phases(t, place)
        return np.asarray(self.amplitude * (np.cos(theta) + 1j * np.sin(theta)))

    def elevation(self, t: float, place: npt.ArrayLike) -> Array:
        """Return the elevation, m, positive up, at ``place`` (..., 2), m north and east."""
        theta = self.phases(t, np.asarray(place, dtype=float))
        return np.asarray(np.cos(theta) @ self.amplitude)

    def motion(self, t: float, point: npt.ArrayLike, *, stretched: bool = True) -> WaterMotion:
        """Return the motion of the water at ``point`` (..., 3), m in {n}, z down from the mean.

        Stretched (Wheeler), z is drawn to h (z + zeta)/(h + zeta): for points, where the water is
        that of the actual surface. Without: for loads on the mean wetted surface.
        """
        at = np.asarray(point, dtype=float)
        theta = self.phases(t, at[..., :2])
        c, s = self.amplitude * np.cos(theta), self.amplitude * np.sin(theta)
        elevation = c.sum(-1)
        z = at[..., 2]
        if stretched:
            z = z + elevation
            z = z if math.isinf(self.depth) else z * self.depth / (self.depth + elevation)
        along, down, pressure = self._profiles(z)
        speed_c, speed_s = self.omega * along * c, self.omega * down * s
        rate_s, rate_c = self.omega**2 * along * s, self.omega**2 * down * c
        heading = self._headings.T
        return WaterMotion(
            elevation,
            s @ self._numbers.T,
            np.concatenate([speed_c @ heading, speed_s.sum(-1)[..., None]], -1),
            np.concatenate([-rate_s @ heading, rate_c.sum(-1)[..., None]], -1),
            (pressure * c).sum(-1),
        )

    def _profiles(self, z: Array) -> tuple[Array, Array, Array]:
        """cosh/sinh, sinh/sinh and cosh/cosh over depth, written so that nothing overflows."""
        decay = np.exp(-self.k * z[..., None])
        if math.isinf(self.depth):
            return decay, decay, decay
        m = np.exp(-2.0 * self.k * (self.depth - z[..., None]))
        q = np.exp(-2.0 * self.k * self.depth)
        below = -np.expm1(-2.0 * self.k * self.depth)
        return decay * (1.0 + m) / below, decay * (1.0 - m) / below, decay * (1.0 + m) / (1.0 + q)


def regular(height: float, period: float, direction: float, depth: float = math.inf) -> Waves:
    """Return one wave of ``height`` from trough to crest, m, and ``period``, s.

    Its crest is at the origin at t = 0. Raises InputError for what is not above 0.
    """
    require_positive(height=height, period=period)
    one = np.ones(1)
    return Waves(0.5 * height * one, math.tau / period * one, direction * one, 0.0 * one, depth)


def irregular(
    spectrum: Spectrum,
    *,
    direction: float,
    seed: int,
    high: float,
    spreading: Spreading | None = None,
    depth: float = math.inf,
    per_octave: int = 20,
    random_amplitudes: bool = False,
    kind: str = "sea",
) -> Waves:
    """Return a realisation of ``spectrum``, a component for each band of the fixed lattice.

    From half the lowest peak to ``high``, rad/s (`lattice.upper_frequency`), widened to whole
    bands. a = sqrt(2 int S dw) over the band, so that m0 of the range is exact; with
    ``random_amplitudes`` they are Rayleigh-distributed about it. With ``per_octave`` 0 hours
    differ as those of a Gaussian sea: where the density is above a tenth of its peak there are
    `lattice.WAVES` of equal energy, with frequencies drawn independently of each other, and
    bands, `lattice.PER_OCTAVE` to the octave, elsewhere. Frequency, phase, and one direction each
    are drawn by ``seed``; trains of another ``kind`` have draws of their own. ``direction`` is
    where the sea goes to, rad. Raises InputError for an empty range.
    """
    count = per_octave or lattice.PER_OCTAVE
    bands = lattice.bands(0.5 * min(spectrum.peaks), high, count)
    edges = lattice.edges(bands, count)
    energy = _energies(spectrum, bands, count)

    def train(kind: str, indices: Sequence[int], omega: Array, energy: Array) -> Waves:
        def drawn(stream: int) -> Array:
            return lattice.draws(kind, seed, stream, indices)

        if random_amplitudes:
            energy = energy * -np.log1p(-drawn(lattice.AMPLITUDE))
        spread = spreading.angle(drawn(lattice.DIRECTION)) if spreading else np.zeros(len(indices))
        phase = math.tau * drawn(lattice.PHASE)
        return Waves(np.sqrt(2.0 * energy), omega, direction + spread, phase, depth)

    omega = lattice.frequencies(kind, seed, bands, edges)
    if per_octave:
        return train(kind, bands, omega, energy)
    density = energy / np.diff(edges)
    is_dense = density > lattice.DENSE * density.max()
    others = [band for band, dense in zip(bands, is_dense, strict=True) if not dense]
    among = f"{kind} peak"
    peak = _of_shares(spectrum, bands, is_dense, lattice.shares(among, seed))
    even = np.full(lattice.WAVES, energy[is_dense].sum() / lattice.WAVES)
    return together(
        [
            train(among, range(lattice.WAVES), peak, even),
            train(kind, others, omega[~is_dense], energy[~is_dense]),
        ]
    )


@lru_cache(64)
def _energies(spectrum: Spectrum, bands: range, per_octave: int) -> Array:
    """Return what every realisation of a spectrum has: the energies of bands, m2."""
    return fixed(band_energies(spectrum, lattice.edges(bands, per_octave)))


def _of_shares(
    spectrum: Spectrum, bands: range, is_dense: npt.NDArray[np.bool_], shares: Array
) -> Array:
    """Return the frequencies, rad/s, below which ``shares`` of the energy of dense bands lie."""
    fine = range(_FINE * bands.start, _FINE * bands.stop)
    edges = lattice.edges(fine, _FINE * lattice.PER_OCTAVE)
    density = spectrum.density(edges)
    energy = 0.5 * (density[1:] + density[:-1]) * np.diff(edges)
    below = np.cumsum(energy * np.repeat(is_dense, _FINE))
    return np.asarray(np.interp(shares * below[-1], np.append(0.0, below), edges))


def together(trains: Sequence[Waves]) -> Waves:
    """Return the waves of all ``trains``, of one water depth, at once."""
    names = ("amplitude", "omega", "direction", "phase")
    joined = [np.concatenate([getattr(train, name) for train in trains]) for name in names]
    amplitude, omega, direction, phase = joined
    return Waves(amplitude, omega, direction, phase, trains[0].depth)
