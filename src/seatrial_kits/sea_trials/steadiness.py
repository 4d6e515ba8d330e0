"""Steadiness of a signal that has noise: means over the halves of a window."""

from __future__ import annotations

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
