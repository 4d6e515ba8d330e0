"""Fence: the zones where the vehicle must stay, and the action at a breach."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..missions.fence_zones import Zone, is_allowed, zones_of
from ..missions.plan import Plan
from ..missions.plan_items import Item
from ..scaling import milliseconds
from ..service import ACCEPTED, DENIED, NOTICE, Command, Service, builds, on_command
from ..settings import Settings
from ..transport import Sender, Transport
from ..vehicle import Vehicle
from .failsafe import Failsafe, check_action

INSIDE_S = 1.0
"""Time inside after which a breach is over: a position that scatters breaches a fence once."""

BREACH = "outside the fence"
TOO_DEEP = "too deep"
_TYPES = {BREACH: mavlink.FENCE_BREACH_BOUNDARY, TOO_DEEP: mavlink.FENCE_BREACH_MINALT}


class FenceService(Service):
    """FENCE_STATUS and DO_FENCE_ENABLE; carries out ``settings.fence_action`` at a breach.

    The fence is breached where `is_allowed` is false, and deeper than ``settings.fence_depth``
    below the surface (0: no limit), while the position is valid. Without zones and limit there
    is no fence, and no FENCE_STATUS. The vehicle acts once per breach: a station that then
    takes over may bring it back. It does not arm outside.

    Raises InputError for an action that the vehicle cannot carry out.

    Not here: margins, speeds near the fence, and fences that must be left again.
    """

    streams: ClassVar = {mavlink.MAVLINK_MSG_ID_FENCE_STATUS: 1.0}

    def __init__(
        self,
        vehicle: Vehicle,
        transport: Transport,
        plan: Plan,
        settings: Settings,
        failsafe: Failsafe,
    ) -> None:
        super().__init__(vehicle, transport)
        check_action(vehicle.dialect, settings.fence_action)
        self._plan, self._settings, self._failsafe = plan, settings, failsafe
        self._enabled = True
        self._items: tuple[Item, ...] = ()
        self._zones: list[Zone] = []
        self._breach: str | None = None
        self._count, self._at = 0, 0.0
        self._inside_since = math.inf

    def check(self) -> str | None:
        """Return the reason against arming, None if there is none."""
        return self._found()

    def tick(self, now: float) -> None:
        """Act when the fence is breached, and know when that is over."""
        if self._plan.items is not self._items:
            self._items, self._zones = self._plan.items, zones_of(self._plan.items, self.vehicle)
        found = self._found()
        if found is not None:
            self._inside_since = math.inf
            if found != self._breach:
                self._end()
                self._begin(found, now)
        elif self._breach is not None and self._is_observable():
            self._inside_since = min(self._inside_since, now)
            if now - self._inside_since >= INSIDE_S:
                self._end()
                self.transport.broadcast(self._status(now)[0])

    def _begin(self, breach: str, now: float) -> None:
        self._breach, self._at, self._count = breach, now, self._count + 1
        self.vehicle.fence_breached = True
        # Whether it arms is a matter of where it is now: see `check`.
        self._failsafe.act(breach, self._settings.fence_action, prevents=False)
        self.transport.broadcast(self._status(now)[0])

    def _end(self) -> None:
        if self._breach is not None:
            self._failsafe.end(self._breach, f"No longer {self._breach}")
        self._breach, self.vehicle.fence_breached = None, False

    def _found(self) -> str | None:
        """Return what is breached now, None if nothing is."""
        estimates, deepest = self.vehicle.estimates, self._settings.fence_depth
        if not self._enabled:
            return None
        if 0.0 < deepest < estimates.position_n[2] and self.vehicle.identity.submerged:
            return TOO_DEEP
        outside = estimates.position_valid and not is_allowed(self._zones, estimates.position_n)
        return BREACH if outside else None

    def _is_observable(self) -> bool:
        """Return whether the breach could be seen if it lasted."""
        return self._breach != BREACH or self.vehicle.estimates.position_valid

    @on_command(mavlink.MAV_CMD_DO_FENCE_ENABLE)
    def _enable(self, command: Command, sender: Sender, now: float) -> int:
        wanted = command.parameters[0]
        if wanted not in (0.0, 1.0):
            return DENIED
        self._enabled = wanted == 1.0
        self.vehicle.report(NOTICE, f"Fence {'on' if self._enabled else 'off'}")
        return ACCEPTED

    @builds(mavlink.MAVLINK_MSG_ID_FENCE_STATUS)
    def _status(self, now: float) -> list[Message]:
        breach = self._breach
        if not (self._zones or self._settings.fence_depth or self._count):
            return []
        kind = mavlink.FENCE_BREACH_NONE if breach is None else _TYPES[breach]
        count = min(self._count, 0xFFFF)
        return [
            mavlink.MAVLink_fence_status_message(
                int(breach is not None),
                count,
                kind,
                milliseconds(self._at),
                mavlink.FENCE_MITIGATE_NONE,
            )
        ]
