"""Wind loads on craft: Isherwood, Blendermann, and areas with coefficients."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import numpy as np

from ...errors import InputError, unknown
from .numbers import Array, require_positive

DATA_FILES = ("isherwood.csv",)

AIR_DENSITY = 1.225
"""kg/m3"""

BLENDERMANN = {
    "car_carrier": (0.95, 0.55, 0.6, 0.8, 1.2),
    "cargo_loaded": (0.85, 0.65, 0.55, 0.4, 1.7),
    "cargo_container_on_deck": (0.85, 0.55, 0.5, 0.4, 1.4),
    "container_loaded": (0.9, 0.55, 0.55, 0.4, 1.4),
    "destroyer": (0.85, 0.6, 0.65, 0.65, 1.1),
    "diving_support": (0.9, 0.6, 0.8, 0.55, 1.7),
    "drilling": (1, 0.85, 0.925, 0.1, 1.7),
    "ferry": (0.9, 0.45, 0.5, 0.8, 1.1),
    "fishing": (0.95, 0.7, 0.7, 0.4, 1.1),
    "lng_tanker": (0.7, 0.6, 0.65, 0.5, 1.1),
    "offshore_supply": (0.9, 0.55, 0.8, 0.55, 1.2),
    "passenger_liner": (0.9, 0.4, 0.4, 0.8, 1.2),
    "research": (0.85, 0.55, 0.65, 0.6, 1.4),
    "speed_boat": (0.9, 0.55, 0.6, 0.6, 1.1),
    "tanker_loaded": (0.7, 0.9, 0.55, 0.4, 3.1),
    "tanker_ballast": (0.7, 0.75, 0.55, 0.4, 2.2),
    "tender": (0.85, 0.55, 0.55, 0.65, 1.1),
}
"""By type: CD_t, CD_l,AF from ahead and from astern, delta, kappa ([Blendermann1994])."""


def angle_of_attack(u: float, v: float) -> float:
    """Return gamma, rad: of a craft moving at u, v, m/s in {b}, relative to the air.

    0: wind from ahead; positive: from port, so that it pushes to starboard.
    """
    return -math.atan2(v, u)


@dataclass(frozen=True)
class Silhouette:
    """Windage of a ship. Raises InputError for an area or length not above 0."""

    length: float
    """Over all, m."""
    frontal: float
    """A_F, m2."""
    lateral: float
    """A_L, m2."""

    def __post_init__(self) -> None:
        require_positive(length=self.length, frontal=self.frontal, lateral=self.lateral)

    @property
    def scales(self) -> list[float]:
        """What a pressure has to be multiplied with for X, Y, K and N, m2 and m3."""
        height = self.lateral / self.length
        return [self.frontal, self.lateral, self.lateral * height, self.lateral * self.length]

    def loads(self, coefficients: Array, speed: float, density: float = AIR_DENSITY) -> Array:
        """Return X, Y, N, N, and K, N, N m, of C_X, C_Y, C_K, C_N at a relative ``speed``, m/s.

        In the order X, Y, K, N; K about the water line.
        """
        return np.asarray(0.5 * density * (speed * speed) * coefficients * self.scales)


@dataclass(frozen=True)
class Isherwood:
    """Coefficients of merchant ships ([Isherwood1972]), linear between rows of 10 degrees.

    Without roll: C_K is 0.
    """

    shape: Silhouette
    beam: float
    """m"""
    perimeter: float
    """S of the lateral projection, without the water line, m."""
    centroid: float
    """C of the lateral area, from the bow, m."""
    masts: int
    """M, groups of masts."""
    superstructure: float
    """A_SS, lateral area of the superstructure, m2."""

    def coefficients(self, gamma: float) -> Array:
        """Return C_X, C_Y, C_K, C_N at the angle gamma, rad."""
        turned = math.remainder(gamma, math.tau)
        at = abs(math.degrees(turned)) / 10.0
        row = math.floor(at)
        share = at - row
        near, far = self.rows[row], self.rows[min(row + 1, 18)]
        side = math.copysign(1.0, turned)
        return np.asarray(((1.0 - share) * near + share * far) * [1.0, side, 1.0, side])

    @cached_property
    def rows(self) -> Array:
        """C_X, C_Y, C_K, C_N every 10 degrees from ahead, from starboard (19, 4)."""
        a, b, c = np.split(_isherwood(), [7, 14], axis=1)
        ship, length = self.shape, self.shape.length
        arguments = np.array(
            [
                1.0,
                2.0 * ship.lateral / length**2,
                2.0 * ship.frontal / self.beam**2,
                length / self.beam,
                self.perimeter / length,
                self.centroid / length,
            ]
        )
        along = -(a[:, :6] @ arguments + a[:, 6] * self.masts)
        across = b[:, :6] @ arguments + b[:, 6] * self.superstructure / ship.lateral
        return np.stack([along, across, np.zeros(len(a)), c @ arguments], 1)


@cache
def _isherwood() -> Array:
    """Return A0..A6, B0..B6, C0..C5 of [Isherwood1972], in rows every 10 degrees from ahead."""
    path = Path(__file__).with_name(DATA_FILES[0])
    return np.loadtxt(path, delimiter=",", skiprows=1)[:, 1:]


@dataclass(frozen=True)
class Blendermann:
    """Coefficients by type of ship ([Blendermann1994]). Raises InputError for an unknown type."""

    shape: Silhouette
    kind: str
    """A key of `BLENDERMANN`."""
    ahead: float
    """s_L of the lateral area's centroid, ahead of midships, m."""
    height: float
    """s_H of it above the water line, m."""

    def __post_init__(self) -> None:
        if self.kind not in BLENDERMANN:
            raise InputError(unknown("type of ship", self.kind, BLENDERMANN))

    def coefficients(self, gamma: float) -> Array:
        """Return C_X, C_Y, C_K, C_N at the angle gamma, rad."""
        across, from_ahead, from_astern, delta, kappa = BLENDERMANN[self.kind]
        gamma = math.remainder(gamma, math.tau)
        along = from_ahead if abs(gamma) <= 0.5 * math.pi else from_astern
        ship = self.shape
        ratio = along * ship.frontal / ship.lateral / across
        sine = math.sin(2.0 * gamma)
        below = 1.0 - 0.5 * delta * (1.0 - ratio) * (sine * sine)
        side = across * math.sin(gamma) / below
        lever = self.ahead / ship.length - 0.18 * (abs(gamma) - 0.5 * math.pi)
        roll = kappa * self.height * ship.length / ship.lateral * side
        return np.array([-along * math.cos(gamma) / below, side, roll, lever * side])


@dataclass(frozen=True)
class Ship:
    """Wind loads on a merchant ship by its coefficients."""

    shape: Silhouette
    form: Isherwood | Blendermann

    def loads(self, u: float, v: float) -> Array:
        """Return X, Y, K, N of the ship's velocity relative to the air, m/s in {b}."""
        coefficients = self.form.coefficients(angle_of_attack(u, v))
        return self.shape.loads(coefficients, math.sqrt(u * u + v * v))


@dataclass(frozen=True)
class Areas:
    """A small craft: X = -q' C_X A_F u, Y = -q' C_Y A_L v, q' = rho V/2; N = x Y, K = h Y."""

    frontal: float
    """A_F, m2."""
    lateral: float
    """A_L, m2."""
    ahead: float = 0.0
    """x of the lateral centroid, m."""
    height: float = 0.0
    """h of it above the origin, m."""
    along: float = 0.7
    """C_X: 0.5 to 0.9."""
    across: float = 0.85
    """C_Y: 0.7 to 1.0."""

    def loads(self, u: float, v: float, density: float = AIR_DENSITY) -> Array:
        """Return X, Y, K, N of the craft's velocity relative to the air, m/s in {b}."""
        pressure = 0.5 * density * math.sqrt(u * u + v * v)
        side = -pressure * self.across * self.lateral * v
        ahead = -pressure * self.along * self.frontal * u
        return np.array([ahead, side, self.height * side, self.ahead * side])
