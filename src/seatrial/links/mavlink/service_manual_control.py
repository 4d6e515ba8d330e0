"""Sticks: MANUAL_CONTROL and RC_CHANNELS_OVERRIDE, for as long as somebody holds them."""

from __future__ import annotations

import math

from .codec import Message
from .failsafe import Failsafe
from .modes import MANUAL_MODES
from .service import Service
from .settings import Settings
from .transport import Sender, Transport
from .vehicle import MANUAL_RELEASED, Vehicle

_MIDDLE_US, _TRAVEL_US = 1500, 400
_IGNORE, _RELEASE = 0xFFFF, 0
_HIGH_RELEASE = 0xFFFE
"""What releases channels 9 to 18, in which 0 says nothing."""
_LOST = "sticks lost"
_UNUSED = 0x7FFF
"""An axis of MANUAL_CONTROL that is not there."""

# RC channels, counted from 1, of (surge, sway, yaw, heave); 0 is none.
_BOAT_CHANNELS = (3, 0, 1, 0)
_SUB_CHANNELS = (5, 6, 4, 3)


class ManualControlService(Service):
    """Axes of a person's sticks, -1 to 1, from the newest of two messages.

    MANUAL_CONTROL: a boat steers with y and drives with z, -1000 to 1000 (PX4: z from 0 to
    1000, 500 in the middle); a submarine takes x ahead, y to starboard, r to turn and z, 0 to
    1000 with 500 in the middle, upwards. RC_CHANNELS_OVERRIDE, 1100 to 1900 us: channels 1 and
    3 steer and drive a boat; 5, 6, 4 and 3 are ahead, to starboard, turn and upwards of a
    submarine. A channel of 65535 is left as it is, 0 is released.

    After the time-out without either the axes are 0, and in an armed vehicle in a manual mode
    the failsafe acts, unless it is told not to watch them. Whoever releases all channels has
    let go on purpose.
    """

    def __init__(
        self, vehicle: Vehicle, transport: Transport, failsafe: Failsafe, settings: Settings
    ) -> None:
        super().__init__(vehicle, transport)
        self._failsafe, self._settings = failsafe, settings
        self._held_until = math.inf
        self._let_go = False

    def handle(self, message: Message, sender: Sender, now: float) -> None:
        """Take the sticks."""
        match message.get_type():
            case "MANUAL_CONTROL":
                self.vehicle.sticks = self._axes(message)
            case "RC_CHANNELS_OVERRIDE":
                self._override(message)
                if not any(self.vehicle.channels):
                    self._release()
                    return
                self.vehicle.sticks = self._from_channels()
            case _:
                return
        self._held_until = now + self._settings.manual_timeout
        if self._let_go:
            self._let_go = False
            self._failsafe.end(_LOST, "Sticks are back")

    def tick(self, now: float) -> None:
        """Let go of sticks that nobody holds."""
        if now <= self._held_until:
            return
        self._release()
        steered = self.vehicle.armed and self.vehicle.mode.name in MANUAL_MODES
        if steered and self._settings.watches_manual_control:
            self._let_go = True
            self._failsafe.act(_LOST)

    def _release(self) -> None:
        self._held_until = math.inf
        self.vehicle.sticks = MANUAL_RELEASED
        self.vehicle.channels = [0] * len(self.vehicle.channels)

    def _axes(self, m: Message) -> tuple[float, float, float, float]:
        x, y, z, r = (None if axis == _UNUSED else axis / 1e3 for axis in (m.x, m.y, m.z, m.r))
        from_zero = self.vehicle.identity.submerged or self.vehicle.dialect.main_and_sub
        if z is not None and from_zero:
            z = 2.0 * z - 1.0
        if self.vehicle.identity.submerged:
            return _manual_axis(x), _manual_axis(y), _manual_axis(r), -_manual_axis(z)
        return _manual_axis(z), 0.0, _manual_axis(y), 0.0

    def _override(self, message: Message) -> None:
        for number in range(1, len(self.vehicle.channels) + 1):
            width = getattr(message, f"chan{number}_raw")
            if number > 8 and width in (0, _HIGH_RELEASE):
                width = _IGNORE if width == 0 else _RELEASE
            if width != _IGNORE:
                self.vehicle.channels[number - 1] = width

    def _from_channels(self) -> tuple[float, float, float, float]:
        submerged = self.vehicle.identity.submerged
        numbers = _SUB_CHANNELS if submerged else _BOAT_CHANNELS
        surge, sway, yaw, heave = (self._channel(number) for number in numbers)
        return surge, sway, yaw, -heave

    def _channel(self, number: int) -> float:
        width = self.vehicle.channels[number - 1] if number else 0
        return _manual_axis((width - _MIDDLE_US) / _TRAVEL_US) if width else 0.0


def _manual_axis(value: float | None) -> float:
    return 0.0 if value is None else min(max(value, -1.0), 1.0)
