"""Modes: requested by command or message, listed, reported."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..modes import POSITION_MODES, Mode
from ..service import (
    ACCEPTED,
    DENIED,
    FAILED,
    INFO,
    UNSUPPORTED,
    WARNING,
    Command,
    Service,
    builds,
    on_command,
    on_message,
    whole,
)
from ..transport import Sender, Transport
from ..vehicle import Vehicle

Requirement = Callable[[Mode], str | None]
"""Returns why a mode cannot be entered now, None if nothing prevents it."""


class ModeService(Service):
    """DO_SET_MODE, SET_MODE, DO_SET_STANDARD_MODE, RETURN_TO_LAUNCH and NAV_LAND in; CURRENT_MODE,
    AVAILABLE_MODES and AVAILABLE_MODES_MONITOR out.

    A submarine that is to land surfaces. A mode of `POSITION_MODES` needs a valid position; other
    services add ``requirements`` of theirs. What is refused is reported, with the reason.
    """

    streams: ClassVar = {
        mavlink.MAVLINK_MSG_ID_CURRENT_MODE: 1.0,
        mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES_MONITOR: 5.0,
    }

    def __init__(self, vehicle: Vehicle, transport: Transport) -> None:
        super().__init__(vehicle, transport)
        self.requirements: list[Requirement] = [self._needs_position]

    def enter(self, mode: Mode) -> str | None:
        """Enter a mode; return why not, None if it is entered."""
        for requirement in self.requirements:
            reason = requirement(mode)
            if reason is not None:
                return reason
        if mode != self.vehicle.mode:
            self.vehicle.enter(mode)
            self.vehicle.report(INFO, f"Mode {mode.shown}")
        return None

    @on_message(mavlink.MAVLINK_MSG_ID_SET_MODE)
    def _take_mode(self, message: Message, sender: Sender, now: float) -> None:
        if message.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            mode = self.vehicle.dialect.by_custom_mode(message.custom_mode)
            self._entered(mode, message.custom_mode)
            self.vehicle.ordered("SET_MODE", message.custom_mode)

    @on_command(mavlink.MAV_CMD_DO_SET_MODE)
    def _set_mode(self, command: Command, sender: Sender, now: float) -> int:
        base, main, sub = command.parameters[:3]
        custom = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        if not (0.0 <= base < 256.0 and int(base) & custom):
            return DENIED
        return self._entered(self.vehicle.dialect.by_command(main, sub), main)

    @on_command(mavlink.MAV_CMD_DO_SET_STANDARD_MODE)
    def _set_standard_mode(self, command: Command, sender: Sender, now: float) -> int:
        if self.vehicle.dialect.is_ardupilot:
            return UNSUPPORTED  # its modes are standard ones to nobody
        standard = whole(command.parameters[0])
        mode = None if standard is None else self.vehicle.dialect.by_standard(standard)
        return self._entered(mode, command.parameters[0])

    @on_command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH)
    def _return(self, command: Command, sender: Sender, now: float) -> int:
        return self._entered_if_any("return")

    @on_command(mavlink.MAV_CMD_NAV_LAND)
    def _surface(self, command: Command, sender: Sender, now: float) -> int:
        return self._entered_if_any("surface")

    @on_command(mavlink.MAV_CMD_NAV_LOITER_UNLIM)
    def _hold(self, command: Command, sender: Sender, now: float) -> int:
        """Stay, as an ArduPilot's submarine does; others do not know the command."""
        known = self.vehicle.dialect.is_ardupilot and self.vehicle.identity.submerged
        return self._entered_if_any("hold") if known else UNSUPPORTED

    def _entered_if_any(self, name: str) -> int:
        mode = self.vehicle.dialect.mode(name)
        return UNSUPPORTED if mode is None else self._entered(mode, mode.custom_mode)

    def _entered(self, mode: Mode | None, number: float) -> int:
        if mode is None:
            self.vehicle.report(WARNING, f"There is no mode {number:g}")
            return FAILED if self.vehicle.dialect.is_ardupilot else DENIED
        reason = self.enter(mode)
        if reason is None:
            return ACCEPTED
        self.vehicle.report(WARNING, f"Mode {mode.shown} refused: {reason}")
        return FAILED

    def _needs_position(self, mode: Mode) -> str | None:
        lost = mode.name in POSITION_MODES and not self.vehicle.estimates.position_valid
        return "no position" if lost else None

    @builds(mavlink.MAVLINK_MSG_ID_CURRENT_MODE)
    def _current(self, now: float) -> list[Message]:
        mode = self.vehicle.mode
        return [
            mavlink.MAVLink_current_mode_message(mode.standard, mode.custom_mode, mode.custom_mode)
        ]

    @builds(mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES)
    def _available(self, now: float) -> list[Message]:
        modes = self.vehicle.dialect.modes
        return [
            mavlink.MAVLink_available_modes_message(
                len(modes), index, mode.standard, mode.custom_mode, 0, mode.shown.encode()
            )
            for index, mode in enumerate(modes, 1)
        ]

    @builds(mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES_MONITOR)
    def _monitor(self, now: float) -> list[Message]:
        """Say that the list of modes is still the same: a station need not request it again."""
        return [mavlink.MAVLink_available_modes_monitor_message(0)]
