"""Missions: started, paused, reported; and single waypoints for guided mode."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned

from ..codec import Message
from ..missions.plan import Plan
from ..missions.plan_checks import STORED, check_place
from ..missions.plan_items import Item, from_message
from ..missions.runner import Leg, MissionRunner
from ..modes import Mode
from ..service import (
    ACCEPTED,
    DENIED,
    FAILED,
    WARNING,
    Command,
    Handler,
    Service,
    builds,
    on_command,
    on_message,
    whole,
)
from ..settings import Settings
from ..transport import Sender, Transport
from ..vehicle import Target, Vehicle
from .modes import ModeService

_NO_MISSION = 0xFFFF
_GUIDED_ITEM = 2
"""MISSION_ITEM's ``current`` for a place to go to at once."""


class MissionService(Service):
    """MISSION_CURRENT and MISSION_ITEM_REACHED out; MISSION_START, DO_PAUSE_CONTINUE,
    DO_SET_MISSION_CURRENT, MISSION_SET_CURRENT and DO_CHANGE_SPEED in.

    MISSION_CURRENT comes every second and at every change. The mode auto is refused without a
    mission. MISSION_START goes on, or begins again after the end; DO_PAUSE_CONTINUE applies in
    auto only, DO_CHANGE_SPEED in guided mode too.

    A MISSION_ITEM whose ``current`` is 2 is not part of a mission, but a place to go to in guided
    mode: some clients know no other way.

    Items such as DO_SET_HOME are carried out by the ``handlers`` of these commands.
    ``reached`` comes from guidance, `leg` what it is to follow.
    """

    streams: ClassVar = {mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0}

    def __init__(
        self,
        vehicle: Vehicle,
        transport: Transport,
        plan: Plan,
        settings: Settings,
        modes: ModeService,
        handlers: Mapping[int, Handler],
        refuge: Callable[[], Ned],
        change_guided_speed: Callable[[float], None],
    ) -> None:
        super().__init__(vehicle, transport)
        self._plan, self._modes, self._handlers = plan, modes, handlers
        self._change_guided_speed = change_guided_speed
        self._runner = MissionRunner(vehicle, plan, settings, self._carry_out, refuge)
        modes.requirements.append(self._needs_mission)
        self.reached = 0
        """Number of the leg that is done, by guidance; 0 for none."""
        self._sent: dict[str, Any] = {}
        self._requested = False

    @property
    def leg(self) -> Leg:
        """Leg that guidance is to follow."""
        return self._runner.leg

    @on_message(mavlink.MAVLINK_MSG_ID_MISSION_SET_CURRENT)
    def _take_current(self, message: Message, sender: Sender, now: float) -> None:
        if not self._runner.set_current(message.seq):
            self.vehicle.report(WARNING, f"There is no mission item {message.seq}")
        self._requested = True

    @on_message(mavlink.MAVLINK_MSG_ID_MISSION_ITEM, mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT)
    def _take_guided(self, message: Message, sender: Sender, now: float) -> None:
        """Go to a place in guided mode; items of a list are the transfer's."""
        if message.current != _GUIDED_ITEM:
            return
        result = self._guide(from_message(message))
        target = (sender.system, sender.component)
        answer = mavlink.MAVLink_mission_ack_message(*target, result, self._plan.kind)
        self.transport.send(sender.link, answer)

    def tick(self, now: float) -> None:
        """Go on with the mission, and report what has changed."""
        self._runner.tick(now, self.reached)
        for sequence in filter(self._is_reported, self._runner.passed):
            self.transport.broadcast(mavlink.MAVLink_mission_item_reached_message(sequence))
        self._runner.passed.clear()
        current = self._current(now)[0]
        if self._requested or current.to_dict() != self._sent:
            self._requested, self._sent = False, current.to_dict()
            self.transport.broadcast(current)

    # ------------------------------------------------------------------ commands

    @on_command(mavlink.MAV_CMD_MISSION_START)
    def _start(self, command: Command, sender: Sender, now: float) -> int:
        first, last = (0.0 if math.isnan(p) else p for p in command.parameters[:2])
        sequence, count = whole(first), len(self._plan.items)
        if sequence is None or sequence not in range(max(count, 1)) or last not in (0, count - 1):
            return DENIED
        mode = self.vehicle.dialect.mode("auto")
        reason = "there is no such mode" if mode is None else self._modes.enter(mode)
        if reason is not None:
            self.vehicle.report(WARNING, f"Mission not started: {reason}")
            return FAILED
        self._runner.paused = False
        if sequence:
            self._runner.set_current(sequence)
        elif self._runner.state == mavlink.MISSION_STATE_COMPLETE:
            self._runner.restart()
        return ACCEPTED

    @on_command(mavlink.MAV_CMD_DO_PAUSE_CONTINUE)
    def _pause_or_continue(self, command: Command, sender: Sender, now: float) -> int:
        goes_on = command.parameters[0]
        if goes_on not in (0.0, 1.0) or self.vehicle.mode.name != "auto":
            return DENIED
        self._runner.paused = not goes_on
        return ACCEPTED

    @on_command(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT)
    def _set_current(self, command: Command, sender: Sender, now: float) -> int:
        sequence, resets = (whole(p) for p in command.parameters[:2])
        is_kept = sequence == -1 and not self.vehicle.dialect.is_ardupilot
        if sequence is None or not (is_kept or self._runner.set_current(sequence)):
            return DENIED
        if resets == 1:
            self._runner.forget_jumps()
        self._requested = True
        return ACCEPTED

    @on_command(mavlink.MAV_CMD_DO_CHANGE_SPEED)
    def _change_speed(self, command: Command, sender: Sender, now: float) -> int:
        if self.vehicle.mode.name not in ("auto", "guided"):
            self.vehicle.report(WARNING, "Speeds change in a mission and in guided mode only")
            return FAILED
        in_auto = self.vehicle.mode.name == "auto"
        change = self._runner.change_speed if in_auto else self._change_guided_speed
        change(command.parameters[1])
        return ACCEPTED

    def _needs_mission(self, mode: Mode) -> str | None:
        return "no mission" if mode.name == "auto" and self._runner.is_empty else None

    # ------------------------------------------------------------------ inside

    def _guide(self, item: Item) -> int:
        """Go to an item's place; return MAV_MISSION_RESULT."""
        if self.vehicle.mode.name != "guided":
            self.vehicle.report(WARNING, "Not in guided mode")
            is_ardupilot = self.vehicle.dialect.is_ardupilot
            return int(mavlink.MAV_MISSION_ERROR if is_ardupilot else mavlink.MAV_MISSION_DENIED)
        place = item.place(self.vehicle)
        refusal = check_place(item, place)
        if place is None or refusal is not None:
            return refusal.result if refusal else int(mavlink.MAV_MISSION_INVALID)
        self.vehicle.target = Target("position", place)
        return int(mavlink.MAV_MISSION_ACCEPTED)

    def _carry_out(self, item: Item, now: float) -> None:
        """Carry an item of the mission out as a command of a station would be."""
        if item.command in STORED:
            self.vehicle.report(WARNING, f"Mission: {item.name} skipped: nothing is there for it")
            return
        command = Command(item.command, (*item.parameters, *item.coordinates(), item.z), item.frame)
        ourselves = Sender(self.vehicle.identity.system, self.vehicle.identity.component, -1)
        if self._handlers[item.command](command, ourselves, now) != ACCEPTED:
            self.vehicle.report(WARNING, f"Mission: {item.name} failed")

    def _is_reported(self, sequence: int) -> bool:
        """Return whether an item that is done is reported: not what was skipped or switched."""
        items = self._plan.items
        done = items[sequence].command if sequence < len(items) else None
        return done not in (*STORED, mavlink.MAV_CMD_DO_FENCE_ENABLE)

    @builds(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT)
    def _current(self, now: float) -> list[Message]:
        runner = self._runner
        in_auto = self.vehicle.mode.name == "auto"
        if runner.is_empty:
            state, sequence, total = mavlink.MISSION_STATE_NO_MISSION, 0, _NO_MISSION
        else:
            state, sequence = runner.state, runner.current
            begun = in_auto or runner.is_chosen or state != mavlink.MISSION_STATE_NOT_STARTED
            if self.vehicle.dialect.is_ardupilot and not begun:
                sequence = 0
            total = len(self._plan.items) - runner.first  # without home
        return [
            mavlink.MAVLink_mission_current_message(sequence, total, state, 1 if in_auto else 2)
        ]
