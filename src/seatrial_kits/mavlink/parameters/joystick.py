"""Parameters of a submarine's joystick: functions of its buttons, and the gain of its axes."""

from __future__ import annotations

from ..settings import Settings
from .definition import INT8, REAL32, Definition, whole

BUTTONS = 16
"""Buttons with a function."""

NONE, SHIFT, TOGGLE_ARMED, ARM, DISARM = 0, 1, 2, 3, 4
MODES = {
    5: "manual",
    6: "stabilize",
    7: "depth-hold",
    8: "hold",
    9: "auto",
    10: "loiter",
    11: "guided",
}
TOGGLE_GAIN, MORE_GAIN, LESS_GAIN = 41, 42, 43
FUNCTIONS = (
    *(NONE, SHIFT, TOGGLE_ARMED, ARM, DISARM),
    *MODES,
    *(TOGGLE_GAIN, MORE_GAIN, LESS_GAIN),
)
"""ArduSub's numbers of the functions that there are here."""
_DEFAULTS = {1: 5, 2: 7, 3: 6, 4: DISARM, 5: SHIFT, 6: ARM, 11: MORE_GAIN, 12: LESS_GAIN}
"""ArduSub's functions by button; its others belong to lights, cameras and trims."""


def joystick_parameters(settings: Settings) -> list[Definition]:
    """Return BTNn_FUNCTION, BTNn_SFUNCTION (with the shift button) and JS_GAIN_..., of a submarine.

    The gain starts at 1: the full range of the axes is that of the vehicle.
    """
    found = []
    for button in range(BUTTONS):
        found.append(_function(f"BTN{button}_FUNCTION", button, _DEFAULTS.get(button, NONE)))
        found.append(_function(f"BTN{button}_SFUNCTION", button + BUTTONS, NONE))
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
