"""Joystick of a submarine: functions of the buttons in MANUAL_CONTROL, and the gain of its axes."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..parameters.joystick import (
    ARM,
    BUTTONS,
    DISARM,
    LESS_GAIN,
    MODES,
    MORE_GAIN,
    SHIFT,
    TOGGLE_ARMED,
    TOGGLE_GAIN,
)
from ..service import INFO, Command, Handler, Service, on_message
from ..settings import Settings
from ..transport import Sender, Transport
from ..vehicle import Vehicle


class JoystickService(Service):
    """Carries out, at each press, what a button's parameter says: arming, a mode, or the gain.

    Arming and modes are the commands of these ``handlers``, with their checks and reports. The
    ``gain`` multiplies the axes of MANUAL_CONTROL. A boat, and a PX4, have no functions of buttons.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        transport: Transport,
        settings: Settings,
        handlers: Mapping[int, Handler],
    ) -> None:
        super().__init__(vehicle, transport)
        self._settings, self._handlers = settings, handlers
        self._pressed = 0
        self._gain: float | None = None

    @property
    def gain(self) -> float:
        """Share of the axes that acts."""
        return self._settings.gain_start if self._gain is None else self._gain

    @on_message(mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL)
    def _take(self, message: Message, sender: Sender, now: float) -> None:
        if not self._settings.buttons or sender.system != self._settings.pilot_system:
            return
        before, self._pressed = self._pressed, message.buttons
        held = [n for n in range(BUTTONS) if self._pressed >> n & 1]
        shifted = any(self._settings.buttons[n] == SHIFT for n in held)
        for button in held:
            if not before >> button & 1:
                function = self._settings.buttons[button + BUTTONS * shifted]
                self._carry_out(function, sender, now)

    def _carry_out(self, function: int, sender: Sender, now: float) -> None:
        if function in MODES:
            mode = self.vehicle.dialect.mode(MODES[function])
            assert mode is not None
            self._order(mavlink.MAV_CMD_DO_SET_MODE, (1.0, float(mode.custom_mode)), sender, now)
        elif function in (TOGGLE_ARMED, ARM, DISARM):
            arms = function == ARM or (function == TOGGLE_ARMED and not self.vehicle.armed)
            self._order(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (float(arms), 0.0), sender, now)
        elif function in (TOGGLE_GAIN, MORE_GAIN, LESS_GAIN):
            self._gain = self._changed(function)
            self.vehicle.report(INFO, f"#Gain is {100 * self._gain:2.0f}%")

    def _order(
        self, command: int, parameters: tuple[float, float], sender: Sender, now: float
    ) -> None:
        given = (*parameters, 0.0, 0.0, 0.0, 0.0, 0.0)
        self._handlers[command](Command(command, given, mavlink.MAV_FRAME_GLOBAL), sender, now)

    def _changed(self, function: int) -> float:
        """Return the gain after a press of a button."""
        least, steps = self._settings.gain_least, self._settings.gain_steps
        most = max(self._settings.gain_most, least)
        if function == TOGGLE_GAIN:
            return 0.5 if self.gain > 0.5 else 1.0
        step = (most - least) / (steps - 1) if steps > 1 else 0.0
        wanted = self.gain + (step if function == MORE_GAIN else -step)
        return min(max(wanted, least), most)
