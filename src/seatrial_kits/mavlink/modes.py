"""Modes by the numbers of two autopilots: ArduPilot's Rover and Sub, and PX4."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pymavlink.dialects.v20 import all as mavlink

MANUAL_MODES = ("manual", "stabilize", "depth-hold")
"""Modes in which manual control acts."""

POSITION_MODES = ("guided", "auto", "return", "loiter")
"""Modes that cannot be entered without a position."""


@dataclass(frozen=True)
class Mode:
    """One mode: our name, the number in HEARTBEAT's custom_mode, the name a person sees."""

    name: str
    custom_mode: int
    shown: str
    standard: int = 0
    """MAV_STANDARD_MODE."""


def _px4(main: int, sub: int = 0) -> int:
    return main << 16 | sub << 24


_HOLDS = mavlink.MAV_STANDARD_MODE_POSITION_HOLD
_MISSION = mavlink.MAV_STANDARD_MODE_MISSION
_RETURNS = mavlink.MAV_STANDARD_MODE_SAFE_RECOVERY
_DEPTH = mavlink.MAV_STANDARD_MODE_ALTITUDE_HOLD

# ArduPilot's own modes are standard ones to nobody: as such stations set them by their number.
_ROVER = (
    Mode("manual", 0, "MANUAL"),
    Mode("hold", 4, "HOLD"),
    Mode("loiter", 5, "LOITER"),
    Mode("auto", 10, "AUTO"),
    Mode("return", 11, "RTL"),
    Mode("guided", 15, "GUIDED"),
)
_SUB = (
    Mode("stabilize", 0, "STABILIZE"),
    Mode("depth-hold", 2, "ALT_HOLD"),
    Mode("auto", 3, "AUTO"),
    Mode("guided", 4, "GUIDED"),
    Mode("loiter", 7, "CIRCLE"),
    Mode("surface", 9, "SURFACE"),
    Mode("hold", 16, "POSHOLD"),
    Mode("manual", 19, "MANUAL"),
)
_ROVER_VERSION, _SUB_VERSION, _PX4_VERSION = "4.6.0", "4.5.0", "1.15.0"
_PX4_SURFACE = (
    Mode("manual", _px4(1), "Manual"),
    Mode("hold", _px4(4, 3), "Hold", _HOLDS),
    Mode("auto", _px4(4, 4), "Mission", _MISSION),
    Mode("return", _px4(4, 5), "Return", _RETURNS),
    Mode("guided", _px4(6), "Offboard"),
)
_PX4_REPOSITION = Mode("guided", _px4(4, 3), "Hold", _HOLDS)
"""What a PX4 shows while it goes where DO_REPOSITION sent it: it stays, only elsewhere."""
_PX4_SUBMERGED = (
    *_PX4_SURFACE,
    Mode("depth-hold", _px4(2), "Altitude", _DEPTH),
    Mode("stabilize", _px4(7), "Stabilized"),
    Mode("surface", _px4(4, 6), "Land"),
)


@dataclass(frozen=True)
class Dialect:
    """Numbering of one autopilot, as a ground station expects it."""

    name: str
    autopilot: int
    """MAV_AUTOPILOT."""
    version: str
    """Version of the firmware whose parameters and modes it has, which stations go by."""
    modes: tuple[Mode, ...]
    main_and_sub: bool
    """Whether DO_SET_MODE has main and sub mode in its parameters 2 and 3 (PX4)."""
    bytewise_parameters: bool
    """Whether PARAM_VALUE carries the bytes of an integer, not its value as a float (PX4)."""
    home_is_item_0: bool
    """Whether item 0 of a mission is home (ArduPilot)."""
    one_pilot: bool
    """Whether only the station of one system steers (ArduPilot)."""
    reposition: Mode | None
    """Mode in which it goes where DO_REPOSITION sends it, None for guided mode."""

    @property
    def is_ardupilot(self) -> bool:
        """Whether it answers as an ArduPilot, else as a PX4."""
        return self.name == "ardupilot"

    def mode(self, name: str) -> Mode | None:
        """Return a mode by our name, None if this kind of vehicle has none such."""
        return next((mode for mode in self.modes if mode.name == name), None)

    def by_custom_mode(self, custom_mode: int) -> Mode | None:
        """Return a mode by the number in HEARTBEAT and SET_MODE, None if there is none."""
        return next((mode for mode in self.modes if mode.custom_mode == custom_mode), None)

    def by_standard(self, standard: int) -> Mode | None:
        """Return the mode of a MAV_STANDARD_MODE, None if there is none."""
        return next((mode for mode in self.modes if standard and mode.standard == standard), None)

    def by_command(self, main: float, sub: float) -> Mode | None:
        """Return the mode that parameters 2 and 3 of DO_SET_MODE request, None if there is none.

        ArduPilot reads its number from the first alone; ground stations leave the other 0 or
        not a number.
        """
        if not math.isfinite(main) or not 0.0 <= main < 2.0**32:
            return None
        if not self.main_and_sub:
            return self.by_custom_mode(round(main))
        low = round(sub) if math.isfinite(sub) and 0.0 <= sub < 256.0 else 0
        return self.by_custom_mode(_px4(round(main), low)) if main < 256.0 else None


def dialect(autopilot_type: str, *, submerged: bool) -> Dialect:
    """Return the dialect of ``ardupilotmega`` or ``px4`` for a boat or a submarine."""
    modes: dict[bool, tuple[Mode, ...]]
    if autopilot_type == "px4":
        modes = {False: _PX4_SURFACE, True: _PX4_SUBMERGED}
        number = mavlink.MAV_AUTOPILOT_PX4
        own = (number, _PX4_VERSION, modes[submerged])
        return Dialect("px4", *own, True, True, False, False, _PX4_REPOSITION)
    modes = {False: _ROVER, True: _SUB}
    version = _SUB_VERSION if submerged else _ROVER_VERSION
    number = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
    own = (number, version, modes[submerged])
    return Dialect("ardupilot", *own, False, False, True, True, None)
