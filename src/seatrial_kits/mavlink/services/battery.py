"""Battery: BATTERY_STATUS, and the failsafe when it is low."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..scaling import UNKNOWN_U16, clamped, int16, int32, uint16
from ..service import Service, builds
from ..settings import Settings
from ..transport import Transport
from ..vehicle import Vehicle
from .failsafe import Failsafe, check_action

LOW_S = 10.0
"""Time for which a battery must be low: the voltage also falls under a short load."""

_LOW = "battery low"


class BatteryService(Service):
    """BATTERY_STATUS; carries out ``settings.battery_action`` once the battery is low.

    It is low when its voltage was below ``settings.battery_low_voltage``, or its charge below
    ``settings.battery_low_charge``, for 10 s; 0 switches either off.

    Raises InputError for an action that the vehicle cannot carry out.
    """

    streams: ClassVar = {mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 1.0}

    def __init__(
        self, vehicle: Vehicle, transport: Transport, settings: Settings, failsafe: Failsafe
    ) -> None:
        super().__init__(vehicle, transport)
        check_action(vehicle.dialect, settings.battery_action)
        self._settings, self._failsafe = settings, failsafe
        self._low_since = math.inf
        self._acted = False

    def tick(self, now: float) -> None:
        """Act when the battery has been low for long enough, once."""
        if not self._is_low():
            self._low_since = math.inf
            return
        self._low_since = min(self._low_since, now)
        if not self._acted and now - self._low_since >= LOW_S:
            self._acted = True
            self._failsafe.act(_LOW, self._settings.battery_action)

    def _is_low(self) -> bool:
        e, settings = self.vehicle.estimates, self._settings
        if e.voltage is None:
            return False
        drained = e.charge is not None and e.charge < settings.battery_low_charge
        return e.voltage < settings.battery_low_voltage or drained

    @builds(mavlink.MAVLINK_MSG_ID_BATTERY_STATUS)
    def _status(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if e.voltage is None:
            return []
        capacity = self._settings.battery_capacity
        drawn = -1.0 if e.charge is None or not capacity else (1.0 - e.charge) * capacity / 3.6
        low = mavlink.MAV_BATTERY_CHARGE_STATE_LOW if self._is_low() else None
        return [
            mavlink.MAVLink_battery_status_message(
                0,
                mavlink.MAV_BATTERY_FUNCTION_ALL,
                mavlink.MAV_BATTERY_TYPE_UNKNOWN,
                0x7FFF,
                [uint16(e.voltage * 1e3), *[UNKNOWN_U16] * 9],
                -1 if e.current is None else int16(e.current * 100),
                int32(drawn),  # mA.h
                -1,
                -1 if e.charge is None else clamped(e.charge * 100, 0, 100),
                0,
                mavlink.MAV_BATTERY_CHARGE_STATE_OK if low is None else low,
            )
        ]
