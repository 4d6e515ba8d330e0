"""Innovation of a measurement: how far it is from what its rate predicts, over a gate."""

from __future__ import annotations

import math
from collections.abc import Sequence

_SMOOTHING_S = 2.0
_LOST_S = 10.0
"""Time without a measurement after which its ratio is 1."""


class Innovation:
    """Ratio of the innovation to a ``gate``, smoothed; 1 and more is a measurement not to be used.

    While nothing valid comes the ratio grows by 1 each 10 s. ``turns`` is for angles, rad.
    """

    def __init__(self, gate: float, *, turns: bool = False) -> None:
        self._gate, self._turns = gate, turns
        self._last: tuple[float, ...] | None = None
        self._at = 0.0
        self.ratio = 0.0

    def update(
        self, now: float, value: Sequence[float], rate: Sequence[float], *, valid: bool
    ) -> None:
        """Take in what is measured at a simulated time, s, and its rate, 1/s."""
        if not valid:
            if self._last is None:
                self.ratio = min(self.ratio + (now - self._at) / _LOST_S, 2.0)
            self._last, self._at = None, now
            return
        if self._last is None:
            self._last, self._at = tuple(value), now
            return
        if tuple(value) == self._last:
            return  # not measured anew
        elapsed = now - self._at
        missed = (
            v - before - r * elapsed for v, before, r in zip(value, self._last, rate, strict=True)
        )
        found = math.hypot(*(math.remainder(x, math.tau) if self._turns else x for x in missed))
        share = 1.0 - math.exp(-elapsed / _SMOOTHING_S)
        self.ratio += share * (min(found / self._gate, 2.0) - self.ratio)
        self._last, self._at = tuple(value), now
