"""Motor telemetry: what speed controllers report."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..scaling import uint16
from ..service import Service, builds
from ..transport import Transport
from ..vehicle import Vehicle

_RPM = 60.0 / math.tau
_COULOMBS = 3.6
"""Of a mA.h."""
_PERIOD = 0.5


class MotorTelemetry(Service):
    """ESC_TELEMETRY_1_TO_4: speed, current, charge drawn, and the battery's voltage.

    A message of ArduPilot's alone, from the first time on that a motor turns or draws current.
    Speeds have no sign in it, there is no temperature, and the count is that of the messages.
    """

    streams: ClassVar = {mavlink.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4: _PERIOD}

    def __init__(self, vehicle: Vehicle, transport: Transport) -> None:
        super().__init__(vehicle, transport)
        self._drawn = [0.0] * 4
        self._count, self._before, self._is_known = 0, 0.0, False

    def tick(self, now: float) -> None:
        """Add up the charge."""
        e = self.vehicle.estimates
        self._is_known |= any(e.motor_speeds) or any(e.motor_currents)
        for motor, current in enumerate(e.motor_currents):
            self._drawn[motor] += abs(current) * (now - self._before)
        self._before = now

    @builds(mavlink.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4)
    def _motors(self, now: float) -> list[Message]:
        if not self._is_known or not self.vehicle.dialect.one_pilot:
            return []
        e = self.vehicle.estimates
        self._count += 1
        return [
            mavlink.MAVLink_esc_telemetry_1_to_4_message(
                [0] * 4,
                [uint16((e.voltage or 0.0) * 100)] * 4,
                [uint16(abs(current) * 100) for current in e.motor_currents],
                [uint16(drawn / _COULOMBS) for drawn in self._drawn],
                [uint16(abs(speed) * _RPM) for speed in e.motor_speeds],
                [uint16(self._count)] * 4,
            )
        ]
