"""The space that a question looks at: the keys that vary, as numbers and as settings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial_kits.campaigns.campaign import Campaign
from seatrial_kits.campaigns.designs import joint_quantiles, laws_of, lower_factor
from seatrial_kits.campaigns.distributions import Distribution, Law, read_distribution
from seatrial_kits.campaigns.scatter import Scatter

_TAILS = np.array([0.00135, 0.99865])
"""Probabilities at which a distribution without an end is cut: three standard deviations."""
_TINY = 2.0**-40


@dataclass(frozen=True)
class Space:
    """Keys with their distributions.

    A point is given by a *share* of each key's range, 0 at its low end and 1 at its high one, or
    by a *probability* of each key.
    """

    keys: tuple[str, ...]
    laws: tuple[Law, ...]
    lower: np.ndarray
    """Cholesky's factor of the correlation of the normal scores."""
    scatter: Scatter | None = None
    """Diagram of the last two keys together."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "ends", np.array([_ends(law) for law in self.laws]))

    ends: np.ndarray = None  # type: ignore[assignment]
    """Of each key's range, in its unit: those of its distribution, or three standard deviations."""

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the keys; empty for those that were written without one."""
        return tuple(law.unit for law in self.laws)

    def numbers(self, shares: np.ndarray) -> np.ndarray:
        """Return the values of the keys, in their units, at shares of their ranges."""
        low, high = self.ends.T
        whole = np.array([law.is_whole for law in self.laws])
        numbers = low + (high - low + whole) * np.asarray(shares)
        result: np.ndarray = np.where(whole, np.minimum(np.floor(numbers), high), numbers)
        return result

    def shares(self, numbers: np.ndarray) -> np.ndarray:
        """Return the shares of the ranges at values of the keys; of whole ones the middle."""
        low, high = self.ends.T
        whole = np.array([law.is_whole for law in self.laws])
        shares: np.ndarray = (numbers - low + 0.5 * whole) / (high - low + whole)
        return shares

    def settings(self, numbers: np.ndarray) -> list[dict[str, Any]]:
        """Return what each row of values sets."""
        columns = [law.settings(numbers[:, i]) for i, law in enumerate(self.laws)]
        return [dict(zip(self.keys, row, strict=True)) for row in zip(*columns, strict=True)]

    def quantiles(self, probabilities: np.ndarray) -> np.ndarray:
        """Return the values of the keys at independent probabilities."""
        inside = np.clip(probabilities, _TINY, 1.0 - _TINY)
        return np.stack(joint_quantiles(self.laws, self.scatter, inside), axis=1)

    def with_(self, other: Space) -> Space:
        """Return the space of these keys and then those of another, which are independent."""
        size, more = len(self.keys), len(other.keys)
        lower = np.block(
            [[self.lower, np.zeros((size, more))], [np.zeros((more, size)), other.lower]]
        )
        return Space(self.keys + other.keys, self.laws + other.laws, lower, other.scatter)

    def only(self, keys: Sequence[str], origin: str) -> Space:
        """Return the space of some keys; of all, if there are none. Raises InputError."""
        for key in keys:
            if key not in self.keys:
                raise InputError(f"{origin}: keys: {unknown('key', key, self.keys)}")
        if not keys:
            return self
        places = sorted({self.keys.index(key) for key in keys})
        laws = tuple(self.laws[i] for i in places)
        return Space(tuple(self.keys[i] for i in places), laws, np.eye(len(places)))

    def titles(self) -> list[str]:
        """Return the keys with their units."""
        pairs = zip(self.keys, self.units, strict=True)
        return [f"{key}, {unit}" if unit else key for key, unit in pairs]


def space_of(campaign: Campaign, question: str, origin: str) -> Space:
    """Return the space of a question: of their own ``vary``, or that of the campaign's design.

    Of ``tune`` the tuned keys come first, and then the varied ones, if any. Raises InputError
    for another question if nothing varies.
    """
    ask, design = campaign.file.ask, campaign.file.design
    if question == "tune":
        tuned = tuned_space(campaign, f"{origin}.tune")
        varies = bool(ask and ask.vary) or design is not None
        return tuned.with_(_varied(campaign, origin)) if varies else tuned
    return _varied(campaign, origin)


def tuned_space(campaign: Campaign, origin: str) -> Space:
    """Return the space of the tuned keys. Raises InputError without one, or if one varies too."""
    ask, design = campaign.file.ask, campaign.file.design
    keys = ask.tune.keys if ask is not None and ask.tune is not None else {}
    if not keys:
        raise InputError(
            f'{origin}: keys: at least one with its ends is needed, such as "pilot.kp" = [0.1, 10]'
        )
    varied = (ask.vary if ask else None) or (design.keys if design else ())
    if both := [key for key in keys if key in varied]:
        raise InputError(f"{origin}: keys: {both[0]} varies too: it can be tuned or drawn")
    laws = {}
    for key, ends in keys.items():
        here = f"{origin}: keys: {key}"
        if len(ends) != 2:
            raise InputError(f"{here}: low and high are needed, found {ends}")
        laws[key] = read_distribution(Distribution(uniform=ends), here)
    return Space(tuple(laws), tuple(laws.values()), np.eye(len(laws)))


def _varied(campaign: Campaign, origin: str) -> Space:
    ask, design = campaign.file.ask, campaign.file.design
    if ask is not None and ask.vary:
        laws = {k: read_distribution(e, f"{origin}: vary: {k}") for k, e in ask.vary.items()}
        return Space(tuple(laws), tuple(laws.values()), np.eye(len(laws)))
    if design is None:
        raise InputError(
            f"{origin}: nothing varies: [ask.vary], or [design.vary] of the campaign, needs a key "
            'such as "hull.mass" = { uniform = ["20 kg", "24 kg"] }'
        )
    here = f"{campaign.read_from.path}: design"
    laws, scatter = laws_of(design, here)
    return Space(tuple(laws), tuple(laws.values()), lower_factor(design, here), scatter)


def refuse_whole(space: Space, origin: str, why: str) -> None:
    """Raise InputError if a key has whole numbers, such as a seed."""
    for key, law in zip(space.keys, space.laws, strict=True):
        if law.is_whole:
            raise InputError(f"{origin}: vary: {key}: it has whole numbers; {why}")


def _ends(law: Law) -> Sequence[float]:
    ends = law.quantiles(np.array([0.0, 1.0]) if not law.is_whole else np.array([0.0, 1 - 1e-15]))
    if not np.isfinite(ends).all():
        ends = law.quantiles(_TAILS)
    return [float(end) for end in ends]
