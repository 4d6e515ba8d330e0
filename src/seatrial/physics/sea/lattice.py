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

PER_OCTAVE = 12
"""Bands to the octave of a sea whose hours differ, where it has little energy."""
DENSE = 0.1
"""Share of the largest density of a band above which such a sea has much energy."""
WAVES, STRATA = 60, 5
"""Waves there, all of one energy, and parts of that energy in which they are drawn."""

_OFFSET = 2**20
"""Added to a band's index, so that it counts from above 0."""


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


def draws(kind: str, seed: int, stream: int, indices: Iterable[int]) -> Array:
    """Return a uniform number, 0 to 1, of each band; it depends on nothing but the arguments.

    Keyed as `Noise` is: Philox with seed and ``kind`` as its key and the index as its counter,
    so that another height, range, or step of the run leaves the draws as they were.
    """
    source = np.random.Philox(key=[seed, zlib.crc32(kind.encode())])
    generator, state = np.random.Generator(source), source.state
    counter = state["state"]["counter"]

    def drawn(index: int) -> float:
        counter[:] = 0, 0, stream, index + _OFFSET
        source.state = state  # a generator of its own for each takes five times as long
        return generator.random()

    return np.array([drawn(index) for index in indices])


def frequencies(kind: str, seed: int, indices: Iterable[int], at: Array) -> Array:
    """Return the frequency drawn in each band, rad/s: a sum of them does not repeat.

    ``at`` are the edges of the bands, rad/s.
    """
    return np.asarray(at[:-1] + np.diff(at) * draws(kind, seed, PLACE, indices))


def shares(kind: str, seed: int) -> Array:
    """Return the shares of the energy, 0 to 1, below which `WAVES` frequencies lie.

    In each of the `STRATA` equal parts of the energy as many are drawn, independently of each
    other: some are then as near to each other as chance has it, and beat over hours. With one
    frequency in each of many bands nearly none are.
    """
    parts = np.repeat(np.arange(STRATA), WAVES // STRATA)
    return np.asarray((parts + draws(kind, seed, PLACE, range(WAVES))) / STRATA)


def upper_frequency(
    peak: float, length: float, heave: float = 0.0, gravity: float = GRAVITY
) -> float:
    """Return up to what frequency, rad/s, a craft needs waves of a sea with its peak at ``peak``.

    The highest of 5 peak, 1.3 times the natural frequency of heave, rad/s, and the frequency of
    waves of half the craft's length, m.
    """
    require_positive(peak=peak, length=length)
    return max(5.0 * peak, 1.3 * heave, math.sqrt(math.tau * gravity / (0.5 * length)))
