"""The sea of a trial as plain numbers and words: what every component makes the same waves of."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from ...errors import InputError, unknown
from .numbers import GRAVITY
from .spectra import (
    Bretschneider,
    Jonswap,
    Spectrum,
    Tma,
    Torsethaugen,
    pierson_moskowitz_of_height,
)
from .spreading import Spreading, cos_2s, cos_n
from .waves import Waves, irregular, regular

NONE = "none"
HIGHEST = 4.0 * math.pi
"""rad/s: a sea has waves up to here, or to 5 times its highest peak if that is more."""

_STEEPEST = 1.0 / 7.0
"""Height over length of a regular wave in deep water that breaks."""

_SPECTRA: dict[str, Callable[[SeaState], Spectrum]] = {
    "bretschneider": lambda s: Bretschneider(s.height, s.period),
    "jonswap": lambda s: Jonswap(s.height, s.period, s.gamma),
    "pierson-moskowitz": lambda s: pierson_moskowitz_of_height(s.height),
    "tma": lambda s: Tma(s.height, s.period, s.depth, s.gamma),
    "torsethaugen": lambda s: Torsethaugen(s.height, s.period),
}
SPECTRA = (NONE, "regular", *_SPECTRA)
_SPREADINGS: dict[str, Callable[[float], Spreading]] = {"cos-2s": cos_2s, "cos-n": cos_n}
SPREADINGS = tuple(_SPREADINGS)


@dataclass(frozen=True)
class SeaState:
    """A sea by its parameters; those of two craft are equal, and so their waves are.

    `waves` and `spectrum_of_it` raise InputError for what is missing or contradicts itself.
    """

    spectrum: str = NONE
    """One of `SPECTRA`; ``regular`` is one wave."""
    height: float = 0.0
    """Hs, m; of a regular wave its height."""
    period: float = 0.0
    """Tp, s."""
    direction: float = 0.0
    """Where the waves go to, rad from north."""
    gamma: float = 3.3
    spreading: float = 0.0
    """s or n of the spreading, 0 for one direction."""
    spreading_form: str = "cos-2s"
    seed: int = 1
    components_per_octave: int = 20
    highest: float = 0.0
    """Highest frequency, rad/s; 0: as `HIGHEST` says."""
    depth: float = 0.0
    """Depth of the water, m; 0: deep."""

    @property
    def is_calm(self) -> bool:
        """Say that there is no sea."""
        return self.spectrum == NONE

    @property
    def water_depth(self) -> float:
        """Depth of the water, m, infinite where it is deep."""
        return self.depth or math.inf

    def spectrum_of_it(self) -> Spectrum | None:
        """Return the spectrum; None of a regular wave or of no sea."""
        self._check()
        if self.spectrum in (NONE, "regular"):
            return None
        return _SPECTRA[self.spectrum](self)

    def waves(self) -> Waves | None:
        """Return the waves, or None if there is no sea."""
        return _waves(self)

    def upper(self, spectrum: Spectrum) -> float:
        """Return the highest frequency of the waves, rad/s."""
        return self.highest or max(HIGHEST, 5.0 * max(spectrum.peaks))

    def _check(self) -> None:
        if self.spectrum not in SPECTRA:
            raise InputError(unknown("spectrum", self.spectrum, SPECTRA))
        if self.is_calm:
            return
        if not self.height > 0.0:
            raise InputError(f"height is {self.height!r} m, more than 0 is needed in a sea")
        if self.spectrum == "pierson-moskowitz":
            if self.period:
                raise InputError(
                    f"period is {self.period!r} s, but the height of a pierson-moskowitz sea fixes "
                    "its period: leave it out, or take bretschneider"
                )
        elif not self.period > 0.0:
            raise InputError(f"period is {self.period!r} s, more than 0 is needed: Tp of the sea")
        steepness = math.tau * self.height / (GRAVITY * self.period**2) if self.period else 0.0
        if steepness > _STEEPEST:
            raise InputError(
                f"height {self.height:g} m at a period of {self.period:g} s is a steepness of "
                f"{steepness:.2g}, and waves break at {_STEEPEST:.2g}: period is Tp, in s"
            )
        if self.spectrum == "tma" and not self.depth:
            raise InputError("depth is 0, and a tma sea is one of a depth: give it")
        if self.spectrum == "regular" and self.spreading:
            raise InputError("spreading: a regular wave has one direction")
        if self.seed != int(self.seed):
            raise InputError(f"seed is {self.seed!r}, a whole number is needed")


@lru_cache(16)
def _waves(state: SeaState) -> Waves | None:
    spectrum = state.spectrum_of_it()
    if state.is_calm:
        return None
    if spectrum is None:
        return regular(state.height, state.period, state.direction, state.water_depth)
    spread = _SPREADINGS[state.spreading_form](state.spreading) if state.spreading else None
    return irregular(
        spectrum,
        direction=state.direction,
        seed=int(state.seed),
        high=state.upper(spectrum),
        spreading=spread,
        depth=state.water_depth,
        per_octave=int(state.components_per_octave),
    )
