"""Manual control: MANUAL_CONTROL and RC_CHANNELS_OVERRIDE, for as long as they come."""

from __future__ import annotations

import math
from collections.abc import Callable

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..modes import MANUAL_MODES
from ..service import NOTICE, Service, on_message
from ..settings import Settings
from ..transport import Sender, Transport
from ..vehicle import MANUAL_RELEASED, Vehicle
from .failsafe import Failsafe

_MIDDLE_US, _TRAVEL_US = 1500, 400
_IGNORE, _RELEASE = 0xFFFF, 0
_HIGH_RELEASE = 0xFFFE
"""What releases channels 9 to 18, in which 0 is ignored."""
_LOST = "manual control lost"
_UNUSED = 0x7FFF
"""An axis of MANUAL_CONTROL that is not there."""

# RC channels, counted from 1, of (surge, sway, yaw, heave); 0 is none.
_BOAT_CHANNELS = (3, 0, 1, 0)
_SUB_CHANNELS = (5, 6, 4, 3)


class ManualControlService(Service):
    """Axes of manual control, -1 to 1, from the newest of two messages.

    MANUAL_CONTROL: a boat steers with y and drives with z, -1000 to 1000 (PX4: z from 0 to
    1000, 500 in the middle); a submarine takes x ahead, y to starboard, r to turn and z, 0 to
    1000 with 500 in the middle, upwards. RC_CHANNELS_OVERRIDE, 1100 to 1900 us: channels 1 and
    3 steer and drive a boat; 5, 6, 4 and 3 are ahead, to starboard, turn and upwards of a
    submarine. A channel of 65535 is left as it is, 0 is released.

    Only the station of ``settings.pilot_system`` steers an ArduPilot: others are ignored, which is
    reported once for each.

    ``gain`` is the share of MANUAL_CONTROL's axes that acts.

    After the time-out without either the axes are 0, and in an armed vehicle in a manual mode
    the failsafe acts, unless it is set not to watch them, and again as long after somebody has
    armed it or entered such a mode without. A station that releases all channels has released them
    on purpose.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        transport: Transport,
        failsafe: Failsafe,
        settings: Settings,
        gain: Callable[[], float],
    ) -> None:
        super().__init__(vehicle, transport)
        self._failsafe, self._settings, self._gain = failsafe, settings, gain
        self._ignored: set[int] = set()
        self._held_until = math.inf
        self._lost = False

    @on_message(mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL)
    def _take_axes(self, message: Message, sender: Sender, now: float) -> None:
        if not self._steers(sender):
            return
        surge, sway, yaw, heave = (self._gain() * axis for axis in self._axes(message))
        self.vehicle.manual = surge, sway, yaw, heave
        self.vehicle.ordered(message.get_type(), self.vehicle.manual)
        self._hold(now)

    @on_message(mavlink.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE)
    def _take_channels(self, message: Message, sender: Sender, now: float) -> None:
        if not self._steers(sender):
            return
        self._override(message)
        if not any(self.vehicle.channels):
            self._release()
            self._found("Manual control was released")
            return
        self.vehicle.manual = self._from_channels()
        self.vehicle.ordered(message.get_type(), self.vehicle.manual)
        self._hold(now)

    def _steers(self, sender: Sender) -> bool:
        """Return whether a station is the pilot's, and report one that is not."""
        pilot = self._settings.pilot_system
        if not self.vehicle.dialect.one_pilot or sender.system == pilot:
            return True
        if sender.system not in self._ignored:
            self._ignored.add(sender.system)
            text = f"System {sender.system} may not steer: SYSID_MYGCS is {pilot}"
            self.vehicle.report(NOTICE, text)
        return False

    def _hold(self, now: float) -> None:
        self._held_until = now + self._settings.manual_timeout
        self._found("Manual control is back")

    def _found(self, news: str) -> None:
        if self._lost:
            self._lost = False
            self._failsafe.end(_LOST, news)

    def tick(self, now: float) -> None:
        """Release manual control that no longer comes."""
        expired = now > self._held_until
        if expired:
            self._release()
            self._lost = True
        action = self._settings.manual_failsafe
        watched = self._settings.watches_manual_control and action != "off"
        if not self._lost or not watched:
            return
        steered = self.vehicle.armed and self.vehicle.mode.name in MANUAL_MODES
        if expired and steered:
            self._failsafe.act(_LOST, action)
        else:
            patience = self._settings.manual_timeout if steered else math.inf
            self._failsafe.act_again(_LOST, now, patience, action)

    def _release(self) -> None:
        self._held_until = math.inf
        self.vehicle.manual = MANUAL_RELEASED
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


def shown_channels(vehicle: Vehicle) -> list[int]:
    """Return the RC channels, us: overridden, or those that the axes held stand for; 0 for none."""
    channels = list(vehicle.channels)
    if any(channels) or vehicle.manual is MANUAL_RELEASED:
        return channels
    surge, sway, yaw, heave = vehicle.manual
    numbers = _SUB_CHANNELS if vehicle.identity.submerged else _BOAT_CHANNELS
    for number, axis in zip(numbers, (surge, sway, yaw, -heave), strict=True):
        if number:
            channels[number - 1] = round(_MIDDLE_US + _TRAVEL_US * axis)
    return channels
