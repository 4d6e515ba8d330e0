"""Statistics of a bus: per identifier and node, over the whole run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from .controller import Controller
from .frame import Frame

_PERCENTILES = (50, 95, 99)
_PS_PER_US = 10**6


class Statistics:
    """Counts and latencies; a latency is from the request to the end of the frame.

    Latencies are kept to the microsecond, rounded up: so memory does not grow with time.
    """

    def __init__(self) -> None:
        self._latencies: dict[tuple[int, bool], Counter[int]] = {}
        self._error_frames: Counter[str] = Counter()

    def sent(self, frame: Frame, latency_ps: int) -> None:
        """Count a frame."""
        key = (frame.identifier, frame.extended)
        found = self._latencies.get(key)
        if found is None:
            found = self._latencies[key] = Counter()
        found[-(-latency_ps // _PS_PER_US)] += 1

    def broken(self, error: str) -> None:
        """Count an error frame."""
        self._error_frames[error] += 1

    def summary(
        self, duration_s: float, busy_s: float, controllers: Sequence[Controller]
    ) -> dict[str, Any]:
        """Return all of it as plain data, times in s."""
        return {
            "duration_s": duration_s,
            "load": round(busy_s / duration_s, 9) if duration_s else 0.0,
            "frames": sum(counts.total() for counts in self._latencies.values()),
            "error_frames": dict(sorted(self._error_frames.items())),
            "identifiers": [
                {
                    "identifier": f"0x{identifier:0{8 if extended else 3}X}",
                    "frames": counts.total(),
                    "rate_hz": round(counts.total() / duration_s, 6) if duration_s else 0.0,
                    "latency_s": _latency(counts),
                }
                for (identifier, extended), counts in sorted(self._latencies.items())
            ],
            "nodes": [
                {
                    "name": each.name,
                    "state": each.state.name.lower(),
                    **{name: getattr(each, name) for name in _COUNTS},
                }
                for each in controllers
            ],
        }


_COUNTS = ("asked", "sent", "received", "lost", "dropped", "waiting", "tec", "rec")


def _latency(counts: Counter[int]) -> dict[str, float]:
    values, total = sorted(counts), counts.total()
    found = {
        "min": values[0] / 1e6,
        "mean": round(sum(value * count for value, count in counts.items()) / total / 1e6, 9),
        "max": values[-1] / 1e6,
    }
    for percent in _PERCENTILES:
        rank, seen = -(-percent * total // 100), 0  # the nearest rank
        for value in values:
            seen += counts[value]
            if seen >= rank:
                found[f"p{percent}"] = value / 1e6
                break
    return found
