"""Components of waves and wind from a spectrum, on a fixed lattice of frequencies, keyed draws."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterable

import numpy as np

from ...errors import InputError
from .numbers import GRAVITY, Array, require_positive

PLACE, PHASE, DIRECTION, AMPLITUDE = range(4)
"""Streams of draws of a band."""

NARROW = math.pi / 3600.0
"""Width of bands, rad/s, half of the resolution of an hour: with drawn amplitudes hours then differ
as those of a Gaussian sea, within a tenth."""

_OFFSET = 2**20
"""Added to a band's index, so that it counts from above 0."""
_MOST_PARTS = 2**11
"""Of a band, in the index of its parts."""


def bands(low: float, high: float, per_octave: int) -> range:
    """Return the indices j of the bands [2^(j/q), 2^((j+1)/q)) rad/s that cover low to high.

    The lattice is the same for every sea. Raises InputError for an empty or impossible range.
    """
    require_positive(low=low, high=high, per_octave=per_octave)
    if not low < high:
        raise InputError(f"frequencies from {low!r} to {high!r} rad/s are no range")
    first = math.floor(per_octave * math.log2(low))
    return range(first, max(first + 1, math.ceil(per_octave * math.log2(high))))


def edges(indices: range, per_octave: int) -> Array:
    """Return the edges of the bands, rad/s: one more than there are bands."""
    return np.exp2(np.arange(indices.start, indices.stop + 1) / per_octave)


def divided(indices: range, per_octave: int, is_high: Array) -> tuple[list[int], Array]:
    """Return indices and edges of the bands, those that ``is_high`` names in narrow parts.

    Parts are narrower than `NARROW`, and depend on the place of the band alone.
    """
    ends = edges(indices, per_octave)
    keys: list[int] = []
    found: list[Array] = []
    for j, low, high, parts in zip(indices, ends[:-1], ends[1:], is_high, strict=True):
        wanted = math.floor((high - low) / NARROW) + 1 if parts else 1
        count = min(wanted, _MOST_PARTS)
        keys += [_MOST_PARTS * j + i for i in range(count)]
        found.append(low + (high - low) * np.arange(count) / count)
    return keys, np.concatenate([*found, ends[-1:]])


def draws(kind: str, seed: int, stream: int, indices: Iterable[int]) -> Array:
    """Return a uniform number, 0 to 1, of each band; it depends on nothing but the arguments.

    Keyed as `Noise` is: Philox with seed and ``kind`` as its key and the index as its counter,
    so that another height, range, or step of the run leaves the draws as they were.
    """
    key = [seed, zlib.crc32(kind.encode())]
    return np.array(
        [
            np.random.Generator(
                np.random.Philox(key=key, counter=[0, 0, stream, j + _OFFSET])
            ).random()
            for j in indices
        ]
    )


def frequencies(kind: str, seed: int, indices: Iterable[int], at: Array) -> Array:
    """Return the frequency drawn in each band, rad/s: a sum of them does not repeat.

    ``at`` are the edges of the bands, rad/s.
    """
    return np.asarray(at[:-1] + np.diff(at) * draws(kind, seed, PLACE, indices))


def upper_frequency(
    peak: float, length: float, heave: float = 0.0, gravity: float = GRAVITY
) -> float:
    """Return up to what frequency, rad/s, a craft needs waves of a sea with its peak at ``peak``.

    The highest of 5 peak, 1.3 times the natural frequency of heave, rad/s, and the frequency of
    waves of half the craft's length, m.
    """
    require_positive(peak=peak, length=length)
    return max(5.0 * peak, 1.3 * heave, math.sqrt(math.tau * gravity / (0.5 * length)))
