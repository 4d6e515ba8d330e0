"""The sea of a trial as plain numbers and words: what every component makes the same waves of."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from ...errors import InputError, unknown
from .numbers import GRAVITY
from .spectra import (
    Bretschneider,
    Jonswap,
    Spectrum,
    Tma,
    Torsethaugen,
    Trains,
    pierson_moskowitz_of_height,
)
from .spreading import Spreading, cos_2s, cos_n
from .waves import Waves, irregular, regular, together

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


AMPLITUDES = ("fixed", "drawn")
SWELLS = 3
"""Most swells beside a sea, as forecasts have them."""


class Swell(NamedTuple):
    """A train of waves from elsewhere: JONSWAP, cos-2s."""

    number: int
    height: float
    """Hs, m."""
    period: float
    """Tp, s."""
    direction: float
    """Direction to which the swell goes, rad from north."""
    gamma: float
    spreading: float

    @property
    def spectrum(self) -> Jonswap:
        """Return its spectrum. Raises InputError for one that cannot be."""
        return Jonswap(self.height, self.period, self.gamma)


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
    """Direction to which the waves go, rad from north."""
    gamma: float = 3.3
    spreading: float = 0.0
    """s or n of the spreading, 0 for one direction."""
    spreading_form: str = "cos-2s"
    seed: int = 1
    components_per_octave: int = 0
    """Waves to the octave; 0: `waves.irregular` chooses them so that hours differ."""
    highest: float = 0.0
    """Highest frequency, rad/s; 0: as `HIGHEST` says."""
    depth: float = 0.0
    """Depth of the water, m; 0: deep."""
    amplitudes: str = "fixed"
    """One of `AMPLITUDES`: those of the spectrum, or Rayleigh-distributed about them."""
    swell_height: tuple[float, ...] = ()
    """Hs of each swell beside the sea, m, 0 of none."""
    swell_period: tuple[float, ...] = ()
    swell_direction: tuple[float, ...] = ()
    swell_gamma: tuple[float, ...] = ()
    swell_spreading: tuple[float, ...] = ()
    """Exponent s of cos-2s, 0 for one direction."""

    @property
    def swells(self) -> tuple[Swell, ...]:
        """The swells that there are, in order."""
        rows = zip(
            self.swell_height,
            self.swell_period,
            self.swell_direction,
            self.swell_gamma,
            self.swell_spreading,
            strict=True,
        )
        return tuple(Swell(n, *row) for n, row in enumerate(rows, 1) if row[0])

    @property
    def is_calm(self) -> bool:
        """Say that there is no sea and no swell."""
        return self.spectrum == NONE and not self.swells

    @property
    def water_depth(self) -> float:
        """Depth of the water, m, infinite where it is deep."""
        return self.depth or math.inf

    def spectrum_of_it(self) -> Spectrum | None:
        """Return the spectrum, swells included; None of a regular wave alone or of no sea."""
        self._check()
        trains: list[Spectrum] = [swell.spectrum for swell in self.swells]
        if (own := self._own()) is not None:
            trains.insert(0, own)
        return Trains(tuple(trains)) if len(trains) > 1 else next(iter(trains), None)

    def waves(self) -> Waves | None:
        """Return the waves, or None if there is no sea."""
        return _waves(self)

    def upper(self, spectrum: Spectrum) -> float:
        """Return the highest frequency of the waves, rad/s."""
        return self.highest or max(HIGHEST, 5.0 * max(spectrum.peaks))

    def _own(self) -> Spectrum | None:
        """Return the spectrum of the sea without its swells."""
        return None if self.spectrum in (NONE, "regular") else _SPECTRA[self.spectrum](self)

    def _check(self) -> None:
        if self.spectrum not in SPECTRA:
            raise InputError(unknown("spectrum", self.spectrum, SPECTRA))
        if self.amplitudes not in AMPLITUDES:
            raise InputError(unknown("amplitudes", self.amplitudes, AMPLITUDES))
        for swell in self.swells:
            _require_steep(f"swell {swell.number}: ", swell.height, swell.period)
        if self.seed != int(self.seed):
            raise InputError(f"seed is {self.seed!r}, a whole number is needed")
        if self.spectrum == NONE:
            return
        if not self.height > 0.0:
            raise InputError(f"height is {self.height!r} m, more than 0 is needed in a sea")
        if self.spectrum == "pierson-moskowitz":
            if self.period:
                raise InputError(
                    f"period is {self.period!r} s, but the height of a pierson-moskowitz sea fixes "
                    "its period: leave it out, or take bretschneider"
                )
        else:
            _require_steep("", self.height, self.period)
        if self.spectrum == "tma" and not self.depth:
            raise InputError("depth is 0, and a tma sea is one of a depth: give it")
        if self.spectrum == "regular" and self.spreading:
            raise InputError("spreading: a regular wave has one direction")


def _require_steep(which: str, height: float, period: float) -> None:
    """Raise InputError for a sea without a period, or one that breaks."""
    if not period > 0.0:
        raise InputError(f"{which}period is {period!r} s, more than 0 is needed: Tp of the sea")
    steepness = math.tau * height / (GRAVITY * period**2)
    if steepness > _STEEPEST:
        raise InputError(
            f"{which}height {height:g} m at a period of {period:g} s is a steepness of "
            f"{steepness:.2g}, and waves break at {_STEEPEST:.2g}: period is Tp, in s"
        )


@lru_cache(16)
def _waves(state: SeaState) -> Waves | None:
    whole = state.spectrum_of_it()
    if state.is_calm:
        return None
    trains = [_swell(state, swell) for swell in state.swells]
    if (own := state._own()) is not None:
        assert whole is not None
        spread = _SPREADINGS[state.spreading_form](state.spreading) if state.spreading else None
        trains.insert(0, _train(state, "sea", own, state.direction, spread, state.upper(whole)))
    elif state.spectrum != NONE:
        one = regular(state.height, state.period, state.direction, state.water_depth)
        trains.insert(0, one)
    return together(trains) if len(trains) > 1 else trains[0]


def _swell(state: SeaState, swell: Swell) -> Waves:
    spread = cos_2s(swell.spreading) if swell.spreading else None
    # The tail of a swell is that of a sea's: 5 times its peak holds all but 0.1 % of m0.
    high = 5.0 * max(swell.spectrum.peaks)
    kind = f"swell {swell.number}"
    return _train(state, kind, swell.spectrum, swell.direction, spread, high)


def _train(
    state: SeaState,
    kind: str,
    spectrum: Spectrum,
    direction: float,
    spread: Spreading | None,
    high: float,
) -> Waves:
    return irregular(
        spectrum,
        direction=direction,
        seed=int(state.seed),
        high=high,
        spreading=spread,
        depth=state.water_depth,
        per_octave=int(state.components_per_octave),
        random_amplitudes=state.amplitudes == "drawn",
        kind=kind,
    )
