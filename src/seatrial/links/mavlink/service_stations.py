"""Ground stations: who is there, and what happens when nobody is left."""

from __future__ import annotations

from collections.abc import Callable

from pymavlink.dialects.v20 import all as mavlink

from .codec import Message
from .failsafe import Failsafe
from .radio import Air, Sender
from .service import INFO, Service
from .settings import Settings
from .vehicle import Vehicle

_MOST = 32
_LOST = "all ground stations lost"


class StationService(Service):
    """Ground stations by their HEARTBEAT (of type GCS), each lost after the time-out without.

    The time-out counts by simulated and by wall time (``clock``, s): stations beat by theirs,
    and would be lost between two beats of theirs when a trial is much faster.

    When the last one is lost the failsafe acts, unless it is told not to watch them; before the
    first one was seen nothing happens.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        air: Air,
        failsafe: Failsafe,
        settings: Settings,
        clock: Callable[[], float],
    ) -> None:
        super().__init__(vehicle, air)
        self._failsafe, self._settings, self._clock = failsafe, settings, clock
        self.seen: dict[tuple[int, int], tuple[float, float]] = {}
        """(system, component) of those that are there, and when each was heard last, by both
        times, s."""
        self._left_alone = False

    def handle(self, message: Message, sender: Sender, now: float) -> None:
        """Note a ground station."""
        if message.get_type() != "HEARTBEAT" or message.type != mavlink.MAV_TYPE_GCS:
            return
        who = (sender.system, sender.component)
        if who not in self.seen:
            if len(self.seen) >= _MOST:
                return
            self.vehicle.say(INFO, f"Ground station {sender.system}:{sender.component}")
        self.seen[who] = (now, self._clock())
        if self._left_alone:
            self._left_alone = False
            self._failsafe.end(_LOST, "Ground station is back")

    def tick(self, now: float) -> None:
        """Lose those that have been silent too long."""
        timeout, wall = self._settings.station_timeout, self._clock()
        there = {
            who: (at, wall_at)
            for who, (at, wall_at) in self.seen.items()
            if min(now - at, wall - wall_at) <= timeout
        }
        lost, self.seen = len(there) < len(self.seen), there
        self.vehicle.stations = len(there)
        if lost and not there and self._settings.watches_stations:
            self._left_alone = True
            self._failsafe.act(_LOST)
