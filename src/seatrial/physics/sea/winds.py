"""The wind of a trial as plain numbers and words: what every component makes the same one of."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

from ...errors import InputError
from .current import towards
from .numbers import Array, fixed
from .wind_spectra import (
    Gusts,
    davenport,
    froya,
    gust_energies,
    gusts,
    harris,
    logarithmic,
    norsok,
    power_law,
)

PROFILES: dict[str, Callable[[float, float], float]] = {
    "uniform": lambda mean, z: mean,
    "power": lambda mean, z: float(power_law(mean, z)),
    "logarithmic": lambda mean, z: float(logarithmic(mean, z)),
    "froya": froya,
}
SPECTRA: dict[str, Callable[[Array, float], Array]] = {
    "davenport": davenport,
    "harris": harris,
    "norsok": norsok,
}
NONE = "none"


@dataclass(frozen=True, eq=False)
class WindState:
    """A wind by its parameters; those of two craft are equal, and so the winds are.

    Its mean by height, gusts of a spectrum, and one gust of a cosine's shape; the same
    everywhere at one height. Raises InputError for a name that is unknown.
    """

    speed: float = 0.0
    """Mean at 10 m, m/s."""
    direction: float = 0.0
    """Direction to which the wind blows, rad from north."""
    profile: str = "uniform"
    spectrum: str = NONE
    gust: float = 0.0
    """Peak of the one gust over the mean at 10 m, m/s."""
    gust_start: float = 60.0
    gust_duration: float = 10.0
    seed: int = 1

    def __post_init__(self) -> None:
        if self.profile not in PROFILES:
            raise InputError(f"profile is {self.profile!r}, allowed {', '.join(PROFILES)}")
        if self.spectrum not in (NONE, *SPECTRA):
            allowed = ", ".join((NONE, *SPECTRA))
            raise InputError(f"spectrum is {self.spectrum!r}, allowed {allowed}")
        if self.spectrum != NONE and not self.speed > 0.0:
            raise InputError(f"spectrum is {self.spectrum!r}, and speed is {self.speed!r}: give it")

    @property
    def is_absent(self) -> bool:
        """Say that there is no wind."""
        return not (self.speed or self.gust)

    def mean(self, height: float) -> float:
        """Return the mean speed, m/s, at ``height``, m."""
        return PROFILES[self.profile](self.speed, height)

    def velocity(self, t: float, height: float) -> Array:
        """Return the velocity of the air, m/s north and east, at ``t``, s, and ``height``, m."""
        speed = self.mean(height)
        if self.gusts is not None:
            speed += self.gusts.speed(t)
        passed = (t - self.gust_start) / self.gust_duration
        if 0.0 < passed < 1.0:
            speed += 0.5 * self.gust * (1.0 - math.cos(math.tau * passed))
        return towards(max(0.0, speed), self.direction)

    @cached_property
    def gusts(self) -> Gusts | None:
        """What comes on top of the mean speed, None of a steady wind."""
        if self.spectrum == NONE:
            return None
        return gusts(_gust_energies(self.spectrum, self.speed), int(self.seed))


@lru_cache(16)
def _gust_energies(spectrum: str, mean: float) -> Array:
    """Return what the gusts of every seed have: the energies of bands, m2/s2."""
    return fixed(gust_energies(lambda f: SPECTRA[spectrum](f, mean)))
