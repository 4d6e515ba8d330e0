"""Steadiness of a signal that has noise: means over the halves of a window."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple


class Halves(NamedTuple):
    """Means of a signal over the first and the second half of a window."""

    first: float
    second: float

    def agree(self, share: float, least: float) -> bool:
        """Return whether they differ by no more than a share of the second, or ``least``."""
        return abs(self.second - self.first) <= max(share * abs(self.second), least)


def halves(window: list[float], samples: int) -> Halves | None:
    """Return the means over both halves of the latest samples, None of a window not yet full."""
    half = max(1, samples // 2)
    if len(window) < 2 * half:
        return None
    return Halves(sum(window[-2 * half : -half]) / half, sum(window[-half:]) / half)


def noise(window: list[float], samples: int) -> float:
    """Return twice the standard error of the difference of both means by the noise of a compass.

    The window has rates that are differences of headings over a period p. White noise s of these
    leaves (h_2 - 2 h_1 + h_0) / (n p) in the difference of two means over n rates, 6^0.5 s / (n p);
    a rate less the one before has 6^0.5 s / p, and nearly nothing of a slow change (von Neumann
    1941).
    """
    latest = window[-2 * max(1, samples // 2) :]
    squares = sum((b - a) ** 2 for a, b in pairwise(latest))
    return 2.0 * math.sqrt(squares / (len(latest) - 1)) / (len(latest) // 2)
