"""Joystick of a submarine: functions of the buttons in MANUAL_CONTROL, and the gain of its axes."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..parameters.definition import INT8, REAL32, Definition, whole
from ..settings import Settings
from ..transport import Sender, Transport
from ..vehicle import Vehicle
from .service import INFO, Command, Handler, Receiver, Service

BUTTONS = 16
"""Buttons with a function."""

_NONE, _SHIFT, _TOGGLE_ARMED, _ARM, _DISARM = 0, 1, 2, 3, 4
_MODES = {
    5: "manual",
    6: "stabilize",
    7: "depth-hold",
    8: "hold",
    9: "auto",
    10: "loiter",
    11: "guided",
}
_TOGGLE_GAIN, _MORE_GAIN, _LESS_GAIN = 41, 42, 43
FUNCTIONS = (
    *(_NONE, _SHIFT, _TOGGLE_ARMED, _ARM, _DISARM),
    *_MODES,
    *(_TOGGLE_GAIN, _MORE_GAIN, _LESS_GAIN),
)
"""ArduSub's numbers of the functions that there are here."""
_DEFAULTS = {1: 5, 2: 7, 3: 6, 4: _DISARM, 5: _SHIFT, 6: _ARM, 11: _MORE_GAIN, 12: _LESS_GAIN}
"""ArduSub's functions by button; its others belong to lights, cameras and trims."""


def joystick_parameters(settings: Settings) -> list[Definition]:
    """Return BTNn_FUNCTION, BTNn_SFUNCTION (with the shift button) and JS_GAIN_..., of a submarine.

    The gain starts at 1: the full range of the axes is that of the vehicle.
    """
    found = []
    for button in range(BUTTONS):
        found.append(_function(f"BTN{button}_FUNCTION", button, _DEFAULTS.get(button, _NONE)))
        found.append(_function(f"BTN{button}_SFUNCTION", button + BUTTONS, _NONE))
    for definition in found:
        assert definition.apply is not None
        definition.apply(settings, definition.default)
    return [
        *found,
        _gain("JS_GAIN_DEFAULT", "gain_start", settings, 0.1, 1.0),
        _gain("JS_GAIN_MIN", "gain_least", settings, 0.1, 0.8),
        _gain("JS_GAIN_MAX", "gain_most", settings, 0.2, 1.0),
        whole("JS_GAIN_STEPS", "gain_steps", settings, 1, 10),
    ]


def _function(name: str, place: int, default: int) -> Definition:
    def apply(settings: Settings, value: float) -> None:
        settings.buttons[place] = round(value)

    return Definition(name, INT8, default, numbers=FUNCTIONS, apply=apply)


def _gain(name: str, setting: str, settings: Settings, low: float, high: float) -> Definition:
    def apply(settings: Settings, value: float) -> None:
        setattr(settings, setting, value)

    return Definition(name, REAL32, getattr(settings, setting), low, high, apply=apply)


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
    def receivers(self) -> Mapping[int, Receiver]:
        """Messages that it takes in."""
        return {mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL: self._take}

    @property
    def gain(self) -> float:
        """Share of the axes that acts."""
        return self._settings.gain_start if self._gain is None else self._gain

    def _take(self, message: Message, sender: Sender, now: float) -> None:
        if not self._settings.buttons or sender.system != self._settings.pilot_system:
            return
        before, self._pressed = self._pressed, message.buttons
        held = [n for n in range(BUTTONS) if self._pressed >> n & 1]
        shifted = any(self._settings.buttons[n] == _SHIFT for n in held)
        for button in held:
            if not before >> button & 1:
                function = self._settings.buttons[button + BUTTONS * shifted]
                self._carry_out(function, sender, now)

    def _carry_out(self, function: int, sender: Sender, now: float) -> None:
        if function in _MODES:
            mode = self.vehicle.dialect.mode(_MODES[function])
            assert mode is not None
            self._order(mavlink.MAV_CMD_DO_SET_MODE, (1.0, float(mode.custom_mode)), sender, now)
        elif function in (_TOGGLE_ARMED, _ARM, _DISARM):
            arms = function == _ARM or (function == _TOGGLE_ARMED and not self.vehicle.armed)
            self._order(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (float(arms), 0.0), sender, now)
        elif function in (_TOGGLE_GAIN, _MORE_GAIN, _LESS_GAIN):
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
        if function == _TOGGLE_GAIN:
            return 0.5 if self.gain > 0.5 else 1.0
        step = (most - least) / (steps - 1) if steps > 1 else 0.0
        wanted = self.gain + (step if function == _MORE_GAIN else -step)
        return min(max(wanted, least), most)
