"""Durations counted in bins of powers of two: how long the steps of a component take."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..model.component import NS

BINS = 64


class StepTimes:
    """Durations, such as the wall times of the steps of one component.

    ``bins[b]`` counts the durations whose number of nanoseconds has bit length b: bin b covers
    2^(b-1) ns up to 2^b ns, bin 0 is 0 ns, the last one all that is longer.
    Adding one costs the same however long a run is.
    """

    __slots__ = ("bins", "count", "longest_at_ns", "longest_ns", "total_ns")

    def __init__(self) -> None:
        self.count = 0
        self.total_ns = 0
        self.longest_ns = 0
        self.longest_at_ns: int | None = None
        """Simulated time of the longest one, None before the first."""
        self.bins = [0] * BINS

    def add(self, elapsed_ns: int, at_ns: int) -> None:
        """Count a duration in ns of what began at the simulated time ``at_ns``."""
        self.count += 1
        self.total_ns += elapsed_ns
        self.bins[min(elapsed_ns.bit_length(), BINS - 1)] += 1
        if elapsed_ns > self.longest_ns or self.longest_at_ns is None:
            self.longest_ns = elapsed_ns
            self.longest_at_ns = at_ns

    def merge(
        self, count: int, total_ns: int, longest_ns: int, longest_at_ns: int, bins: Sequence[int]
    ) -> None:
        """Add durations that were counted elsewhere, later than these."""
        if longest_ns > self.longest_ns or self.longest_at_ns is None:
            self.longest_ns, self.longest_at_ns = longest_ns, longest_at_ns
        self.count += count
        self.total_ns += total_ns
        self.bins = [own + more for own, more in zip(self.bins, bins, strict=True)]

    def as_json(self) -> dict[str, Any]:
        """Return what ``timing.json`` says, times in s; empty bins beyond the last are left out.

        A percentile is the upper edge of the bin that it falls into, at most the longest.
        """
        return {
            "steps": self.count,
            "total_s": self.total_ns / NS,
            "mean_s": self.total_ns / NS / max(1, self.count),
            "p50_at_most_s": self.at_most(0.5) / NS,
            "p99_at_most_s": self.at_most(0.99) / NS,
            "longest_s": self.longest_ns / NS,
            "longest_at_s": None if self.longest_at_ns is None else self.longest_at_ns / NS,
            "bins": trimmed(self.bins),
        }

    def at_most(self, share: float) -> int:
        """Return the ns that the given share of durations does not exceed, a bin's upper edge."""
        seen = 0
        for bit_length, count in enumerate(self.bins):
            seen += count
            if count and seen >= share * self.count:
                return min(self.longest_ns, (1 << bit_length) - 1)
        return 0


def trimmed(bins: Sequence[int]) -> list[int]:
    """Return the bins up to the last one that holds anything."""
    last = max((b for b, count in enumerate(bins) if count), default=-1)
    return list(bins[: last + 1])
