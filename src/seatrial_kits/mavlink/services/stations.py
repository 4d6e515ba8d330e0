"""Ground stations: presence, and the failsafe when the last one is lost."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..service import INFO, Service, on_message
from ..settings import Settings
from ..transport import Sender, Transport
from ..vehicle import Vehicle
from .failsafe import Failsafe

_MOST = 32
_BEATS = 3
"""Beats that a station must have missed to be lost; as many are remembered."""
_LOST = "all ground stations lost"


@dataclass
class _Station:
    """Times of a station's last heartbeat, s: simulated time, and wall time."""

    at: float
    wall_at: float
    intervals: deque[float] = field(default_factory=lambda: deque(maxlen=_BEATS))
    """Of wall time, between its last beats."""

    def beat(self, now: float, wall: float) -> None:
        """Receive it again."""
        self.intervals.append(wall - self.wall_at)
        self.at, self.wall_at = now, wall

    def is_there(self, now: float, wall: float, timeout: float) -> bool:
        """Return whether its silence is no longer than it may be."""
        known = len(self.intervals) == _BEATS  # fewer may be one beat that came doubled
        patience = min(timeout, _BEATS * max(self.intervals)) if known else timeout
        return now - self.at <= timeout or wall - self.wall_at <= patience


class StationService(Service):
    """Ground stations by their HEARTBEAT (of type GCS).

    Each is lost after the time-out without, in simulated time, if it has missed three beats of
    its own too, by wall time (``clock``, s), or for that time-out: in a trial that is much faster
    stations would be lost between two beats.

    When the last one is lost (of an ArduPilot: the last of the system that steers it,
    ``settings.pilot_system``) the failsafe acts, unless it is set not to watch them, and again on
    whoever takes over without being one; before the first one was seen nothing happens. A vehicle
    that needs one to arm (``settings.station_to_arm``) does not arm before that either.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        transport: Transport,
        failsafe: Failsafe,
        settings: Settings,
        clock: Callable[[], float],
    ) -> None:
        super().__init__(vehicle, transport)
        self._failsafe, self._settings, self._clock = failsafe, settings, clock
        self._there: dict[tuple[int, int], _Station] = {}
        """By system and component."""
        self._left_alone = False

    def check(self) -> str | None:
        """Return the reason against arming, None if there is none."""
        settings = self._settings
        watches = settings.watches_stations and settings.failsafe != "none"
        needed = settings.station_to_arm and watches
        return "no ground station" if needed and not any(map(self._counts, self._there)) else None

    def _counts(self, who: tuple[int, int]) -> bool:
        """Return whether the failsafe misses a station: an ArduPilot that of one system alone."""
        return not self.vehicle.dialect.one_pilot or who[0] == self._settings.pilot_system

    @on_message(mavlink.MAVLINK_MSG_ID_HEARTBEAT)
    def _note(self, message: Message, sender: Sender, now: float) -> None:
        if message.type != mavlink.MAV_TYPE_GCS:
            return
        who = (sender.system, sender.component)
        if who in self._there:
            self._there[who].beat(now, self._clock())
        elif len(self._there) < _MOST:
            self._there[who] = _Station(now, self._clock())
            self.vehicle.report(INFO, f"Ground station {sender.system}:{sender.component}")
        else:
            return
        if self._left_alone and self._counts(who):
            self._left_alone = False
            self._failsafe.end(_LOST, "Ground station is back")

    def tick(self, now: float) -> None:
        """Lose those that have been silent too long."""
        timeout, wall = self._settings.station_timeout, self._clock()
        there = {who: one for who, one in self._there.items() if one.is_there(now, wall, timeout)}
        missed = {*filter(self._counts, self._there)}
        self._there = there
        self.vehicle.stations = len(there)
        if missed and not missed & there.keys() and self._settings.watches_stations:
            self._left_alone = True
            self._failsafe.act(_LOST)
        elif self._left_alone and self._settings.watches_stations:
            self._failsafe.act_again(_LOST, now, timeout)
