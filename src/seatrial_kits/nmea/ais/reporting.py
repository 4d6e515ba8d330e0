"""Reporting intervals of AIS stations, by speed, turn and navigational status.

Source: Rec. ITU-R M.1371-5, Annex 1, tables 1 and 2; Annex 2, 4.3.3 (changes of course and speed).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from seatrial.model.component import NS

from .station import AT_ANCHOR, KNOT, MOORED

STATIC_S = 360.0
"""Interval of the static reports."""
AT_REST_S = 180.0
_FAR = math.inf
_CLASS_A = ((14.0, 10.0, 10.0 / 3.0), (23.0, 6.0, 2.0), (_FAR, 2.0, 2.0))
"""Up to so many knots: interval, and interval while the course changes, s."""
_SO = ((2.0, AT_REST_S), (14.0, 30.0), (23.0, 15.0), (_FAR, 5.0))
_CS = ((2.0, AT_REST_S), (_FAR, 30.0))
_TURN = math.radians(5.0)
"""Difference from the mean heading of the last `_MEAN_S` from which the course changes."""
_MEAN_S, _STEADY_S = 30, 20.0
_SLOWER_S = 180.0
"""A lower speed counts once it has been kept for so long."""
_SPREAD = 0.1
"""Reports are this share of the interval before or after their time, at random: slots."""
_STATIC_AFTER_S = 2.0
"""From the first position report to the first static report: assumed."""


def interval_s(equipment: str, speed: float | None, turning: bool, status: int) -> float:
    """Return the interval of position reports; ``speed`` in m/s, None if it is not known."""
    knots = 0.0 if speed is None else speed / KNOT
    if equipment == "A":
        if status in (AT_ANCHOR, MOORED):
            return AT_REST_S if knots <= 3.0 else 10.0
        _, steady, changing = next(row for row in _CLASS_A if knots <= row[0])
        return changing if turning else steady
    table = _SO if equipment == "B-SO" else _CS
    return next(seconds for limit, seconds in table if knots <= limit)


class Schedule:
    """Times at which a station reports; a view of ``memory``, plain data of the caller's.

    ``drawn`` gives number k of the station's random numbers, 0 to 1.
    """

    def __init__(
        self, memory: dict[str, Any], equipment: str, drawn: Callable[[int], float]
    ) -> None:
        self._memory, self._equipment, self._drawn = memory, equipment, drawn

    @property
    def started(self) -> bool:
        """Whether it is switched on."""
        return bool(self._memory)

    def start(self, now_ns: int) -> None:
        """Switch it on: the first report comes at a time of its own in the next 10 s."""
        first = now_ns + round(10.0 * NS * self._drawn(0))
        self._memory |= {
            "nominal": first,
            "due": first,
            "static": first + round(_STATIC_AFTER_S * NS),
            "reports": 0,
            "interval": 0.0,
            "speed": None,
            "kept": now_ns,
            "headings": [],
            "looked": now_ns - NS,
            "turned": -1,
        }

    def look(self, now_ns: int, speed: float | None, heading: float | None, status: int) -> None:
        """Take in how the ship moves; a shorter interval acts at once."""
        m = self._memory
        wanted, held = (
            interval_s(self._equipment, each, False, status) for each in (speed, m["speed"])
        )
        if wanted <= held or now_ns - m["kept"] >= round(_SLOWER_S * NS):
            m["speed"], m["kept"] = speed, now_ns
        before = m["interval"]
        turning = self._turning(now_ns, heading)
        m["interval"] = interval_s(self._equipment, m["speed"], turning, status)
        if m["interval"] < before and m["reports"]:
            m["nominal"] = max(now_ns, m["last"] + round(m["interval"] * NS))
            m["due"] = min(m["due"], m["nominal"])

    def position_due(self, until_ns: int) -> int | None:
        """Return when a position report is due before ``until_ns``; it is taken as sent.

        After `look`, which sets the interval.
        """
        m = self._memory
        if m["due"] >= until_ns:
            return None
        due: int = m["due"]
        m["reports"] += 1
        m["last"] = due
        interval = m["interval"] * NS
        m["nominal"] += round(interval)
        shift = (2.0 * self._drawn(m["reports"]) - 1.0) * _SPREAD
        m["due"] = m["nominal"] + round(shift * interval)
        return due

    def static_due(self, until_ns: int) -> int | None:
        """Return when static reports are due before ``until_ns``; they are taken as sent."""
        due: int = self._memory["static"]
        if due >= until_ns:
            return None
        self._memory["static"] = due + round(STATIC_S * NS)
        return due

    def _turning(self, now_ns: int, heading: float | None) -> bool:
        """Return whether the course changes, or did in the last 20 s."""
        m = self._memory
        headings: list[list[float]] = m["headings"]
        if heading is None:
            headings.clear()
            m["turned"] = -1
            return False
        if now_ns >= m["looked"] + NS:
            m["looked"] = now_ns
            headings.append([math.cos(heading), math.sin(heading)])
            del headings[:-_MEAN_S]
        mean = math.atan2(sum(y for _, y in headings), sum(x for x, _ in headings))
        if abs(math.remainder(heading - mean, math.tau)) > _TURN:
            m["turned"] = now_ns
        return bool(m["turned"] >= 0 and now_ns - m["turned"] <= round(_STEADY_S * NS))
