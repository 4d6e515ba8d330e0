"""Bus log of a run: logs and statistics in the run's folder."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from seatrial.errors import SimulationError

from .bus_log import BusLog
from .controller import Controller
from .frame import Frame
from .simulated_bus import PS, Broken, Sent, SimulatedBus

_PS_PER_NS = 1000


class RunLog:
    """The logs of `BusLog`, and at the end ``NAME.json`` (`Statistics`); nothing without a folder.

    Each attempt to send is entered once: a step that is repeated after a rollback brings the
    same frames again.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._folder: Path | None = None
        self._log: BusLog | None = None
        self._statistics = Statistics()
        self._entered = 0

    def open(self, folder: str) -> None:
        """Begin the files in ``folder``, once; an empty text is none."""
        if folder and self._log is None:
            self._folder = Path(folder)
            self._log = BusLog(self._folder, self._name)

    def sent(self, attempt: int, sent: Sent, latency_ps: int) -> None:
        """Enter a frame."""
        if self._log is not None and attempt > self._entered:
            self._entered = attempt
            self._log.frame(-(-sent.end_ps // _PS_PER_NS), sent.frame)
            self._statistics.sent(sent.frame, latency_ps)

    def broken(self, attempt: int, broken: Broken) -> None:
        """Enter an error frame."""
        if self._log is not None and attempt > self._entered:
            self._entered = attempt
            self._log.error(-(-broken.end_ps // _PS_PER_NS), broken.error)
            self._statistics.broken(broken.error.name.lower())

    def close(self, bus: SimulatedBus, begun_ps: int) -> None:
        """Write what is left, and the statistics; a new one may be opened."""
        if self._log is None or self._folder is None:
            return
        log, self._log = self._log, None
        log.close()
        duration = (bus.now_ps - begun_ps) / PS
        found = self._statistics.summary(duration, bus.busy_ps / PS, bus.controllers)
        path = self._folder / f"{self._name}.json"
        try:
            with path.open("x", encoding="utf-8", newline="\n") as file:
                file.write(json.dumps(found, indent=1) + "\n")
        except OSError as error:
            raise SimulationError(f"cannot write {path}: {error.strerror}") from None


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
