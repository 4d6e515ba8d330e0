"""What a node has received of the vessel: values by quantity, from whom, and until when they count."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from ...component import NS
from .catalogue import DATA
from .codec import Message, numbers

_TRUE, _MAGNETIC, _APPARENT = 0, 1, 2
_PER_RPM = math.tau / 60.0
_INTERVALS = 3
"""Intervals of a PGN for which a value counts at least."""

_FAR_NS = 1 << 62

Values = dict[str, tuple[float, ...] | None]


class Received:
    """Values by quantity; ``memory`` is a dict of plain data, the caller's.

    Of several nodes that send the same quantity the one is listened to that was received first, until
    it says that it is not available, or nothing in time; then the next. A value counts for
    ``timeout_ns``, and for three standard intervals of its PGN at least.
    """

    def __init__(self, memory: dict[str, Any], timeout_ns: int, rudder_instance: int) -> None:
        self._memory = memory
        self._timeout_ns, self._rudder_instance = timeout_ns, rudder_instance

    def take(self, when_ns: int, said: Message) -> list[str]:
        """Take in a message; return the quantities that it changed."""
        reader = _READERS.get(said.pgn)
        if reader is None:
            return []
        if said.pgn == 127245 and said.fields.get("instance") not in (self._rudder_instance, None):
            return []
        changed = []
        interval_ns = round(DATA[said.pgn].interval_s * NS)
        until_ns = when_ns + max(self._timeout_ns, _INTERVALS * interval_ns)
        for name, values in reader(said.fields).items():
            known = self._memory.get(name)
            if known and known["source"] != said.source and self._counts(known, when_ns):
                continue
            if values is not None:
                found = {"values": list(values), "until": until_ns, "source": said.source}
                self._memory[name] = found
                changed.append(name)
            elif known and known["source"] == said.source:
                known["until"] = -1
                changed.append(name)
        return changed

    def names(self) -> list[str]:
        """Return the quantities that have been received of."""
        return list(self._memory)

    def get(self, name: str, now_ns: int) -> tuple[list[float] | None, bool]:
        """Return the last values of a quantity, None if there were none, and whether they count."""
        known = self._memory.get(name)
        if known is None:
            return None, False
        return known["values"], self._counts(known, now_ns)

    def expires(self, now_ns: int) -> int:
        """Return when the next value that counts will no longer, ns; far ahead if none does."""
        ends = [known["until"] for known in self._memory.values()]
        return min((until + 1 for until in ends if until >= now_ns), default=_FAR_NS)

    @staticmethod
    def _counts(known: dict[str, Any], now_ns: int) -> bool:
        return bool(known["until"] >= now_ns)


def _heading(f: dict[str, Any]) -> Values:
    """True heading: if the compass is magnetic, what it shows + deviation + variation."""
    shown = numbers(f, "heading")
    reference = f.get("reference")
    if shown is None or reference not in (_TRUE, _MAGNETIC):
        return {"heading": None}
    if reference == _TRUE:
        return {"heading": shown}
    if f.get("variation") is None:
        return {"heading": None}
    true: float = shown[0] + (f.get("deviation") or 0.0) + f["variation"]
    return {"heading": (true % math.tau,)}


def _rudder(f: dict[str, Any]) -> Values:
    ways = {0: 0.0, 1: 1.0, 2: -1.0}
    direction = f.get("directionOrder")
    return {
        "rudder": numbers(f, "position"),
        "rudder_order": numbers(f, "angleOrder"),
        "rudder_direction": (ways[direction],) if direction in ways else None,
    }


def _course(f: dict[str, Any]) -> Values:
    found = numbers(f, "cog", "sog")
    if found is None or f.get("cogReference") != _TRUE:
        return {"velocity": None}
    course, speed = found
    return {"velocity": (speed * math.cos(course), speed * math.sin(course))}


def _wind(f: dict[str, Any]) -> Values:
    if f.get("reference") != _APPARENT:
        return {}
    found = numbers(f, "windSpeed", "windAngle")
    if found is None:
        return {"wind": None}
    return {"wind": (found[0], math.remainder(found[1] - math.pi, math.tau))}


def _engine(f: dict[str, Any]) -> Values:
    instance, speed = f.get("instance"), numbers(f, "speed")
    if instance is None:
        return {}
    return {f"engine {instance}": None if speed is None else (speed[0] * _PER_RPM,)}


def _heading_control(f: dict[str, Any]) -> Values:
    counted_from_north = f.get("headingReference") in (_TRUE, None, 3)  # 3: not available
    mode = f.get("steeringMode")
    return {
        "heading_to_steer": numbers(f, "headingToSteerCourse") if counted_from_north else None,
        "track": numbers(f, "track") if counted_from_north else None,
        "commanded_rudder": numbers(f, "commandedRudderAngle"),
        "steering_mode": (float(mode or 0),) if mode in range(6) else None,
    }


_READERS: dict[int, Callable[[dict[str, Any]], Values]] = {
    127237: _heading_control,
    127245: _rudder,
    127250: _heading,
    127251: lambda f: {"rate_of_turn": numbers(f, "rate")},
    127257: lambda f: {"attitude": numbers(f, "roll", "pitch", "yaw")},
    127488: _engine,
    128259: lambda f: {"water_speed": numbers(f, "speedWaterReferenced")},
    128267: lambda f: {"depth": numbers(f, "depth")},
    129025: lambda f: {"place": numbers(f, "latitude", "longitude")},
    129026: _course,
    129029: lambda f: {
        "place": numbers(f, "latitude", "longitude"),
        "altitude": numbers(f, "altitude"),
    },
    130306: _wind,
}
