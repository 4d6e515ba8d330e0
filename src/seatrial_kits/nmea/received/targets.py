"""Other ships, stations and marks received over AIS."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

LIFE_NS = 420_000_000_000
"""Time for which a station is shown after its last report: 7 min."""
_MOST = 2000
"""Stations that are kept at most: the ones received last."""

Report = Mapping[str, Any]
"""``mmsi``, and what it has of ``latitude``, ``longitude`` (deg), ``course``, ``heading`` (rad,
true), ``speed`` (m/s), ``name``, ``length``, ``beam`` (m)."""


class Targets:
    """Stations by MMSI; ``memory`` is a dict of plain data, the caller's."""

    def __init__(self, memory: dict[str, Any]) -> None:
        self._memory = memory

    def take(self, when_ns: int, report: Report, place: Sequence[float] | None) -> None:
        """Take in a report; ``place`` is its position north and east of the origin, m, if any."""
        key = str(report["mmsi"])
        entry: dict[str, Any] = self._memory.pop(key, {})
        if place is not None:
            course, speed = report.get("course"), report.get("speed")
            velocity = None
            if speed is not None and (course is not None or speed == 0.0):
                course = course or 0.0
                velocity = [speed * math.cos(course), speed * math.sin(course)]
            entry |= {"when": when_ns, "place": list(place[:2]), "velocity": velocity}
            entry["heading"] = report.get("heading")
        for name in ("name", "length", "beam"):
            if report.get(name):
                entry[name] = report[name]
        self._memory[key] = entry  # the newest last
        while len(self._memory) > _MOST:
            del self._memory[next(iter(self._memory))]

    def lately(self, now_ns: int) -> dict[int, dict[str, Any]]:
        """Return the stations with a position that was received within `LIFE_NS`, by MMSI."""
        return {
            int(key): entry
            for key, entry in self._memory.items()
            if entry.get("when", -LIFE_NS - 1) >= now_ns - LIFE_NS
        }

    def nearest(self, now_ns: int, place: Sequence[float], most: int) -> list[tuple[int, Any]]:
        """Return MMSI and entry of the nearest stations to a place, m, the nearest first."""

        def distance(each: tuple[int, Any]) -> float:
            north, east = each[1]["place"]
            return math.hypot(north - place[0], east - place[1])

        return sorted(self.lately(now_ns).items(), key=distance)[:most]

    def expires(self, now_ns: int) -> int:
        """Return when the next report expires, ns; far ahead if none does."""
        ends = (entry["when"] + LIFE_NS + 1 for entry in self.lately(now_ns).values())
        return min(ends, default=1 << 62)
