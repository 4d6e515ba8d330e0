"""Spectra of waves: Bretschneider, Pierson-Moskowitz, JONSWAP, Torsethaugen, TMA.

Densities are one-sided, S(w) in m2 s over w in rad/s (S(f) = 2 pi S(w)). Hs is the significant
wave height 4 sqrt(m0), m; Tp = 2 pi/wp the period of the spectrum's peak, s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Protocol

import numpy as np

from ...errors import InputError
from .dispersion import depth_factor, wave_number
from .numbers import GRAVITY, Array, require_positive
from .quadrature import integrals


class Spectrum(Protocol):
    """A density of energy over frequency, a value: equal ones have equal densities."""

    def __hash__(self) -> int:
        """Return the same of equal spectra, whose integrals are kept."""

    @property
    def peaks(self) -> tuple[float, ...]:
        """Frequencies of peaks, rad/s, the highest first; the density may have a kink there."""

    def density(self, omega: Array) -> Array:
        """Return S, m2 s, at ``omega`` > 0, rad/s."""

    def outside(self) -> str | None:
        """Return in words why this is outside of what the spectrum was made for, or None."""


@dataclass(frozen=True)
class Bretschneider:
    """Bretschneider's spectrum, which is ITTC's of two parameters and the modified PM.

        S = (5/16) Hs^2 wp^4 w^-5 exp(-1.25 (wp/w)^4)

    m4 diverges: it depends on where the tail is cut. Tz = 0.710371 Tp, T1 = 0.771771 Tp.
    Raises InputError for a height or period that is not above 0.
    """

    height: float
    """Hs, m."""
    period: float
    """Tp, s."""

    def __post_init__(self) -> None:
        require_positive(height=self.height, period=self.period)

    @property
    def peaks(self) -> tuple[float, ...]:
        """Frequency of the peak, rad/s."""
        return (math.tau / self.period,)

    def density(self, omega: Array) -> Array:
        """Return S, m2 s, at ``omega`` > 0, rad/s."""
        (peak,) = self.peaks
        ratio = peak / omega
        level = 0.3125 * self.height**2 / peak
        return np.asarray(level * ratio**5 * np.exp(-1.25 * ratio**4))

    def outside(self) -> str | None:
        """Return None: any height and period."""
        return None


def pierson_moskowitz_of_wind(speed: float, gravity: float = GRAVITY) -> Bretschneider:
    """Return the spectrum of a fully developed sea under a wind of ``speed``, m/s, at 19.5 m.

    S = A w^-5 exp(-B w^-4), A = 0.0081 g^2, B = 0.74 (g/U)^4 ([Pierson1964]):
    Hs = 0.209246 U^2/g, wp = 0.877163 g/U. Raises InputError for a speed that is not above 0.
    """
    require_positive(speed=speed)
    return _pierson_moskowitz(0.74 * (gravity / speed) ** 4, gravity)


def pierson_moskowitz_of_height(height: float, gravity: float = GRAVITY) -> Bretschneider:
    """Return the spectrum of a fully developed sea of height Hs, m, which fixes its period.

    As of wind, with B = 4 A/Hs^2. Raises InputError for a height that is not above 0.
    """
    require_positive(height=height)
    return _pierson_moskowitz(4.0 * 0.0081 * gravity**2 / height**2, gravity)


def _pierson_moskowitz(b: float, gravity: float) -> Bretschneider:
    a = 0.0081 * gravity**2
    return Bretschneider(2.0 * math.sqrt(a / b), math.tau / (0.8 * b) ** 0.25)


@dataclass(frozen=True)
class Jonswap:
    """JONSWAP's spectrum ([Hasselmann1973]) of given height.

        S = A S_Bretschneider gamma^exp(-(w - wp)^2/(2 s^2 wp^2)),  s = 0.07 to wp, 0.09 above

    A depends on gamma alone and is such that Hs is exact. Raises InputError for a height or
    period that is not above 0, or gamma below 1.
    """

    height: float
    """Hs, m."""
    period: float
    """Tp, s."""
    gamma: float = 3.3
    """Peak enhancement: 1 is Bretschneider's spectrum."""

    def __post_init__(self) -> None:
        require_positive(height=self.height, period=self.period)
        if not 1.0 <= self.gamma < math.inf:
            raise InputError(f"gamma is {self.gamma!r}, at least 1 is needed")

    @property
    def peaks(self) -> tuple[float, ...]:
        """Frequency of the peak, rad/s."""
        return (math.tau / self.period,)

    def density(self, omega: Array) -> Array:
        """Return S, m2 s, at ``omega`` > 0, rad/s."""
        enhanced = enhancement(omega / self.peaks[0], self.gamma)
        base = Bretschneider(self.height, self.period).density(omega)
        return np.asarray(jonswap_normalisation(self.gamma) * base * enhanced)

    def outside(self) -> str | None:
        """Return None: any height and period."""
        return None


def enhancement(ratio: Array, gamma: float) -> Array:
    """Return JONSWAP's gamma^exp(...) at ``ratio`` = w/wp."""
    width = np.where(ratio <= 1.0, 0.07, 0.09)
    return np.asarray(gamma ** np.exp(-0.5 * ((ratio - 1.0) / width) ** 2))


@cache
def jonswap_normalisation(gamma: float) -> float:
    """Return A of `Jonswap`: 1 / int 5 r^-5 exp(-1.25 r^-4) gamma^(...) dr, exactly 1 for 1."""

    def added(ratio: Array) -> Array:
        bare = 5.0 * ratio**-5 * np.exp(-1.25 * ratio**-4)
        return np.asarray(bare * (enhancement(ratio, gamma) - 1.0))

    # The enhancement is over at 3 wp, and below 0.2 wp there is nothing to enhance.
    return 1.0 / (1.0 + float(integrals(added, np.array([0.2, 1.0, 3.0])).sum()))


@dataclass(frozen=True)
class Torsethaugen:
    """Torsethaugen's simplified spectrum of wind sea and swell ([Torsethaugen2004]).

    Two parts of heights H1 and H2 = sqrt(Hs^2 - H1^2); the sea is wind sea mostly if Tp is
    at most Tf = 6.6 Hs^(1/3). Each part, with s as in JONSWAP,

        (3.26/16) H^2 wj^3 w^-4 exp(-(wj/w)^4) A gamma^exp(...),
        A = (1 + 1.1 (ln gamma)^1.19)/gamma

    As published: Hm0 is -0.4 to 1.0 % off Hs, m3 and above diverge. Raises InputError for a
    height or period that is not above 0.
    """

    height: float
    """Hs, m."""
    period: float
    """Tp, s, of the first part."""
    gravity: float = GRAVITY

    def __post_init__(self) -> None:
        require_positive(height=self.height, period=self.period)

    @cached_property
    def parts(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Height, m, period, s, and gamma of the two parts, the one at the peak first."""
        hs, tp, g = self.height, self.period, self.gravity
        limit = 6.6 * hs ** (1.0 / 3.0)
        if tp <= limit:  # wind sea mostly
            e = min(1.0, (limit - tp) / (limit - 2.0 * math.sqrt(hs)))
            share = 0.7 + 0.3 * math.exp(-((e / 0.5) ** 2))
            gamma = 35.0 * (math.tau * share * hs / (g * tp**2)) ** (6.0 / 7.0)
            second = math.sqrt(1.0 - share**2) * hs
            second_period = limit + 2.0
        else:
            e = min(1.0, (tp - limit) / (25.0 - limit))
            share = 0.6 + 0.4 * math.exp(-((e / 0.3) ** 2))
            steep = math.tau * hs / (g * limit**2)
            gamma = 35.0 * steep ** (6.0 / 7.0) * (1.0 + 6.0 * e)
            second = math.sqrt(1.0 - share**2) * hs
            second_period = 6.6 * second ** (1.0 / 3.0)
        return (share * hs, tp, max(1.0, gamma)), (second, second_period, 1.0)

    @property
    def peaks(self) -> tuple[float, ...]:
        """Frequencies of the peaks of the two parts that have a height, rad/s."""
        return tuple(sorted((math.tau / t for h, t, _ in self.parts if h > 0.0), reverse=True))

    def density(self, omega: Array) -> Array:
        """Return S, m2 s, at ``omega`` > 0, rad/s."""
        total = np.zeros_like(omega)
        for height, period, gamma in self.parts:
            if height > 0.0:
                total = total + self._part(omega, height, math.tau / period, gamma)
        return total

    @staticmethod
    def _part(omega: Array, height: float, peak: float, gamma: float) -> Array:
        normal = (1.0 + 1.1 * math.log(gamma) ** 1.19) / gamma
        level = 3.26 / 16.0 * height**2 / peak * normal
        ratio = peak / omega
        shape = ratio**4 * np.exp(-(ratio**4))
        return np.asarray(level * shape * enhancement(1.0 / ratio, gamma))

    def outside(self) -> str | None:
        """Say if height or period are outside of the fit: 0.5 to 11 m, 3.5 to 19 s."""
        if 0.5 <= self.height <= 11.0 and 3.5 <= self.period <= 19.0:
            return None
        return (
            f"Torsethaugen's spectrum is a fit to the North Sea for heights of 0.5 to 11 m and "
            f"periods of 3.5 to 19 s; here they are {self.height:g} m and {self.period:g} s"
        )


@dataclass(frozen=True)
class Tma:
    """TMA spectrum of a finite depth h ([Bouws1985]): S = phi S_JONSWAP.

        phi = tanh^2(kh)/(1 + 2kh/sinh 2kh)

    phi takes energy away. With ``keep_height`` all is raised so that Hs is what is given.
    Raises InputError for a height, period or depth that is not above 0, or gamma below 1.
    """

    height: float
    """Hs, m: of this spectrum with ``keep_height``, else of the JONSWAP spectrum in it."""
    period: float
    """Tp, s, of the JONSWAP spectrum in it."""
    depth: float
    """Depth of the water, m."""
    gamma: float = 3.3
    keep_height: bool = True
    gravity: float = GRAVITY

    def __post_init__(self) -> None:
        require_positive(depth=self.depth)
        Jonswap(self.height, self.period, self.gamma)

    @property
    def peaks(self) -> tuple[float, ...]:
        """Frequency of the peak of the JONSWAP spectrum in it, rad/s."""
        return (math.tau / self.period,)

    def density(self, omega: Array) -> Array:
        """Return S, m2 s, at ``omega`` > 0, rad/s."""
        return self._scale * self._lowered(omega)

    @cached_property
    def _scale(self) -> float:
        if not self.keep_height:
            return 1.0
        (peak,) = self.peaks
        low, high = peak * np.array([0.1, 100.0])
        # Beyond 100 wp phi is 1, unless the water is a film.
        tail = self.height**2 / 16.0 * jonswap_normalisation(self.gamma) * -math.expm1(-1.25e-8)
        lowered = integrals(self._lowered, np.array([low, peak, high])).sum() + tail
        return float(self.height**2 / 16.0 / lowered)

    def _lowered(self, omega: Array) -> Array:
        k = wave_number(omega, self.depth, self.gravity)
        factor = np.tanh(k * self.depth) ** 2 / (1.0 + depth_factor(k, self.depth))
        return np.asarray(factor * Jonswap(self.height, self.period, self.gamma).density(omega))

    def outside(self) -> str | None:
        """Return None: any height, period and depth."""
        return None


@dataclass(frozen=True)
class Trains:
    """Spectra of several wave trains at one place: their sum."""

    trains: tuple[Spectrum, ...]

    @property
    def peaks(self) -> tuple[float, ...]:
        """Frequencies of the peaks, rad/s, those of the train that has most at its peak first."""

        def most(train: Spectrum) -> float:
            return float(train.density(np.array(train.peaks[:1]))[0])

        return tuple(peak for train in sorted(self.trains, key=most)[::-1] for peak in train.peaks)

    def density(self, omega: Array) -> Array:
        """Return S, m2 s, at ``omega`` > 0, rad/s."""
        return np.asarray(sum(train.density(omega) for train in self.trains))

    def outside(self) -> str | None:
        """Return what the trains say, or None."""
        return "; ".join(said for train in self.trains if (said := train.outside())) or None


def moment(spectrum: Spectrum, order: int, low: float, high: float) -> float:
    """Return m_n = int w^n S dw, m2 (rad/s)^n, from ``low`` to ``high``, rad/s."""

    def weighted(omega: Array) -> Array:
        return np.asarray(omega**order * spectrum.density(omega))

    return float(integrals(weighted, edges_with_peaks(spectrum, np.array([low, high]))).sum())


def band_energies(spectrum: Spectrum, edges: Array) -> Array:
    """Return int S dw, m2, of each band between neighbours of ``edges``, rad/s, rising.

    The energy of a band does not depend on the other bands.
    """
    energies = integrals(spectrum.density, edges)
    for peak in spectrum.peaks:  # a band with a kink in it is integrated on both sides
        i = int(np.searchsorted(edges, peak)) - 1
        if 0 <= i < len(edges) - 1 and peak < edges[i + 1]:
            with_peak = edges_with_peaks(spectrum, edges[i : i + 2])
            energies[i] = integrals(spectrum.density, with_peak).sum()
    return energies


def edges_with_peaks(spectrum: Spectrum, edges: Array) -> Array:
    """Return ``edges`` and the spectrum's peaks between them, rising."""
    inner = [peak for peak in spectrum.peaks if edges[0] < peak < edges[-1]]
    return np.unique(np.append(edges, inner))


@dataclass(frozen=True)
class Statistics:
    """Heights and periods of a spectrum between two frequencies, from its moments."""

    m0: float
    height: float
    """Hm0 = 4 sqrt(m0), m."""
    mean_period: float
    """T1 = 2 pi m0/m1, s."""
    zero_crossing_period: float
    """Tz = 2 pi sqrt(m0/m2), s."""
    energy_period: float
    """Te = 2 pi m_-1/m0, s."""
    width: float
    """Omega = m0^2 / int S^2 dw, rad/s: a record of T s has CoV(Hm0) = sqrt(2 pi/(Omega T))/2."""


def statistics(spectrum: Spectrum, low: float, high: float) -> Statistics:
    """Return the `Statistics` of ``spectrum`` between ``low`` and ``high``, rad/s."""
    m_1, m0, m1, m2 = (moment(spectrum, n, low, high) for n in (-1, 0, 1, 2))
    edges = edges_with_peaks(spectrum, np.array([low, high]))
    squares = integrals(lambda omega: spectrum.density(omega) ** 2, edges).sum()
    return Statistics(
        m0,
        4.0 * math.sqrt(m0),
        math.tau * m0 / m1,
        math.tau * math.sqrt(m0 / m2),
        math.tau * m_1 / m0,
        float(m0**2 / squares),
    )
