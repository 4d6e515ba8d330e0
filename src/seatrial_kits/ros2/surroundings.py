"""Ships around, as AIS has them: sentences as they come, and a list of targets."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from seatrial.links.text import Inbox
from seatrial.model.component import NS
from seatrial.plugins import offered

from .frames import enu, quaternion
from .published import BASE, MAP, Fields, Here

_FORGOTTEN_NS = 420 * NS
"""A ship that has not been received for so long is no target, as of an AIS transponder."""
_EVERY_NS = NS


class Traffic:
    """Messages of what an AIS receiver says; targets where the kit nmea reads its sentences.

    Each VDM and VDO becomes a nmea_msgs/Sentence, without its end of line. Positions of VDM
    are kept by MMSI, for 7 minutes: a geometry_msgs/PoseArray in map has them once a second in
    the order of MMSI, each turned by its true heading, or by its course where the ship sends none.
    """

    def __init__(self) -> None:
        self._inbox = Inbox({})
        self._read: Any = None
        self._known: dict[int, tuple[int, Fields]] = {}
        self._due_ns: int | None = None

    def messages(self, sentences: str, here: Here) -> Iterator[tuple[str, Fields]]:
        """Return topics and messages of the port's text, and of the targets when they are due."""
        new = self._inbox.take(sentences)
        if new and self._due_ns is None:
            # With the first sentence: most vehicles have no AIS, and its library takes time.
            self._due_ns, made = here.now_ns, offered("nmea.ais")
            self._read = made and made()
        for _, data in new:
            text = data.decode("ascii", "replace").rstrip("\r\n")
            yield "nmea", {"header": here.header(BASE), "sentence": text}
            self._take(data, here)
        if self._read and self._due_ns is not None and here.now_ns >= self._due_ns:
            self._due_ns = here.now_ns + _EVERY_NS
            yield "ais_targets", self._targets(here)

    def _take(self, line: bytes, here: Here) -> None:
        taken: tuple[Fields, bool] | None = self._read and self._read.take(line)
        found, own = taken or ({}, True)
        lat, lon = found.get("lat"), found.get("lon")
        if own or lat is None or lon is None or abs(lat) > 90.0 or abs(lon) > 180.0:
            return
        at = here.origin.position(lat, lon, here.origin.altitude)
        angle = next((a for a in (found.get("heading"), found.get("course")) if _is_angle(a)), None)
        pose: dict[str, Any] = {"position": enu(at)}
        pose["orientation"] = quaternion((0.0, 0.0, math.radians(angle or 0.0)))
        self._known[int(found["mmsi"])] = here.now_ns, pose

    def _targets(self, here: Here) -> Fields:
        oldest = here.now_ns - _FORGOTTEN_NS
        self._known = {name: each for name, each in self._known.items() if each[0] >= oldest}
        poses = [self._known[name][1] for name in sorted(self._known)]
        return {"header": here.header(MAP), "poses": poses}


def _is_angle(angle: float | None) -> bool:
    """Whether degrees are not those that stand for "not available", 511 and 360."""
    return angle is not None and 0.0 <= angle < 360.0
