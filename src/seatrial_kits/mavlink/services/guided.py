"""Guided set-points: where to go, how fast or where to head, for as long as they come."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned

from ..codec import Message
from ..frames import GLOBAL_FRAMES, LOCAL_FRAMES, global_position, is_near
from ..missions.runner import OWN_SPEED
from ..scaling import milliseconds, turned, yaw
from ..service import (
    ACCEPTED,
    DENIED,
    FAILED,
    WARNING,
    Command,
    Receiver,
    Service,
    builds,
    on_command,
    whole,
)
from ..settings import FASTEST, Settings
from ..transport import Sender, Transport
from ..vehicle import Target, Vehicle
from .modes import ModeService

_IGNORE_XY, _IGNORE_Z = 0x3, 0x4
_IGNORE_VX_VY, _IGNORE_VZ = 0x18, 0x20
_IGNORE_YAW, _IGNORE_YAW_RATE = 0x400, 0x800
_IGNORE_THRUST, _IGNORE_ATTITUDE = 0x40, 0x80

_FROM_ORIGIN = mavlink.MAV_FRAME_LOCAL_NED
_NORTH_EAST = (_FROM_ORIGIN, mavlink.MAV_FRAME_LOCAL_OFFSET_NED)
_MOST_LEAD = 0.5
"""By how much a heading that turns may be ahead of the vehicle's, rad."""


class GuidedService(Service):
    """SET_POSITION_TARGET_LOCAL_NED, SET_POSITION_TARGET_GLOBAL_INT, SET_ATTITUDE_TARGET, and
    DO_REPOSITION.

    The three messages apply in guided mode and until the time-out each; then the vehicle stops.
    Of what a mask lets through, a position goes before a velocity, a velocity before a yaw;
    an attitude gives the heading, its thrust the share of the full speed. DO_REPOSITION stays,
    and enters guided mode if the command has it (PX4: Hold, which it shows on the way too). A boat
    keeps the height it has.

    Frames: from the origin, from the vehicle (offset), along its heading (body), or global. A
    velocity along the heading, with a yaw rate, holds the heading that the vehicle had and turns
    it at that rate; its part abeam is not obeyed. Without a yaw rate it is a velocity over ground.
    Not obeyed: accelerations, other yaw rates, and a yaw together with a position or velocity.
    """

    capabilities = (
        mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
        | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
        | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
    )

    def __init__(
        self, vehicle: Vehicle, transport: Transport, modes: ModeService, settings: Settings
    ) -> None:
        super().__init__(vehicle, transport)
        self._modes, self._settings = modes, settings
        self._before = 0.0

    @property
    def receivers(self) -> Mapping[int, Receiver]:
        """Messages that it takes in."""
        return {
            mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: partial(self._take, self._local),
            mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: partial(
                self._take, self._global
            ),
            mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: partial(self._take, self._attitude),
        }

    def _take(
        self, read: Callable[[Message], Target | None], message: Message, sender: Sender, now: float
    ) -> None:
        if self.vehicle.mode != self.vehicle.dialect.mode("guided"):
            return
        target = read(message)
        if target is not None and _is_sane(target):
            self.vehicle.target = replace(target, expires=now + self._settings.target_timeout)
            self.vehicle.ordered(message.get_type(), target)

    def tick(self, now: float) -> None:
        """Turn a heading that has a rate, and forget a set-point that has expired."""
        target = self.vehicle.target
        if target is not None and target.turn is not None:
            self.vehicle.target = self._turned(target, target.turn, now - self._before)
        self._before = now
        if target is not None and target.expires is not None and now > target.expires:
            self.vehicle.target = None
            self.vehicle.report(WARNING, "Set-points have stopped, so does the vehicle")

    def change_speed(self, speed: float) -> None:
        """Change the speed to positions until the mode ends, m/s; -2 is the vehicle's own."""
        vehicle = self.vehicle
        if speed != OWN_SPEED and not 0.0 < speed <= FASTEST:
            return
        vehicle.guided_speed = 0.0 if speed == OWN_SPEED else speed
        if vehicle.target is not None and vehicle.target.kind == "position":
            vehicle.target = replace(vehicle.target, speed=vehicle.guided_speed)

    # ------------------------------------------------------------------ messages

    def _local(self, m: Message) -> Target | None:
        if m.coordinate_frame not in LOCAL_FRAMES:
            return None
        if m.type_mask & _IGNORE_XY == 0:
            return self._going(self._local_position(m))
        return self._moving(m, m.coordinate_frame)

    def _global(self, m: Message) -> Target | None:
        if m.coordinate_frame not in GLOBAL_FRAMES:
            return None
        if m.type_mask & _IGNORE_XY:
            return self._moving(m, _FROM_ORIGIN)
        altitude = math.nan if m.type_mask & _IGNORE_Z else m.alt
        position = global_position(
            self.vehicle, m.coordinate_frame, m.lat_int * 1e-7, m.lon_int * 1e-7, altitude
        )
        return None if position is None else self._going(position)

    def _going(self, position: Ned) -> Target:
        return Target("position", position, speed=self.vehicle.guided_speed)

    def _moving(self, m: Message, frame: int) -> Target | None:
        """Return what a message requests that has no position."""
        if m.type_mask & _IGNORE_VX_VY == 0:
            down = 0.0 if m.type_mask & _IGNORE_VZ else m.vz
            if frame not in _NORTH_EAST and m.type_mask & _IGNORE_YAW_RATE == 0:
                return self._turning(m.vx, down, m.yaw_rate)
            north, east = self._north_east(frame, m.vx, m.vy)
            return Target("velocity", velocity=(north, east, self._dive(down, 0.0)))
        if m.type_mask & _IGNORE_YAW == 0:
            ahead = 0.0 if frame in _NORTH_EAST else self.vehicle.estimates.attitude[2]
            return self._steering(ahead + m.yaw, 0.0)
        return None

    def _attitude(self, m: Message) -> Target | None:
        heading = None if m.type_mask & _IGNORE_ATTITUDE else yaw(m.q)
        thrust = 0.0 if m.type_mask & _IGNORE_THRUST else min(max(m.thrust, -1.0), 1.0)
        return (
            None if heading is None else self._steering(heading, thrust * self._settings.full_speed)
        )

    def _steering(self, heading: float, speed: float) -> Target:
        return Target("heading", self.vehicle.estimates.position_n, heading=heading, speed=speed)

    def _turning(self, ahead: float, down: float, rate: float) -> Target:
        """Return a heading that turns, from where the one before was, or the vehicle is."""
        before = self.vehicle.target
        if before is None or before.turn is None:
            before = self._steering(self.vehicle.estimates.attitude[2], 0.0)
        return replace(before, speed=ahead, velocity=(0.0, 0.0, down), turn=rate)

    def _turned(self, target: Target, rate: float, seconds: float) -> Target:
        measured = self.vehicle.estimates.attitude[2]
        lead = math.remainder(target.heading + rate * seconds - measured, math.tau)
        if rate:
            lead = min(max(lead, -_MOST_LEAD), _MOST_LEAD)
        north, east, down = target.position
        down = self._dive(down + target.velocity[2] * seconds, down)
        return replace(target, heading=measured + lead, position=(north, east, down))

    def _local_position(self, m: Message) -> Ned:
        frame, here = m.coordinate_frame, self.vehicle.estimates.position_n
        north, east = self._north_east(frame, m.x, m.y)
        down = here[2] if m.type_mask & _IGNORE_Z else m.z
        if frame != _FROM_ORIGIN:
            north, east = here[0] + north, here[1] + east
            down = here[2] + (0.0 if m.type_mask & _IGNORE_Z else m.z)
        return north, east, self._dive(down, here[2])

    def _north_east(self, frame: int, x: float, y: float) -> tuple[float, float]:
        return (x, y) if frame in _NORTH_EAST else turned(self.vehicle.estimates.attitude[2], x, y)

    def _dive(self, wanted: float, else_: float) -> float:
        return wanted if self.vehicle.identity.submerged else else_

    # ------------------------------------------------------------------ commands

    @on_command(mavlink.MAV_CMD_DO_REPOSITION)
    def _reposition(self, command: Command, sender: Sender, now: float) -> int:
        speed, flags = command.parameters[0], whole(command.parameters[1]) or 0
        latitude, longitude, altitude = command.parameters[4:]
        if command.frame not in GLOBAL_FRAMES:
            return DENIED
        position = global_position(self.vehicle, command.frame, latitude, longitude, altitude)
        if position is None:
            return DENIED
        mode = self.vehicle.dialect.reposition or self.vehicle.dialect.mode("guided")
        if mode is None or self.vehicle.mode != mode:
            if not flags & mavlink.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE:
                self.vehicle.report(WARNING, "Not in guided mode")
                return DENIED
            reason = "there is none" if mode is None else self._modes.enter(mode)
            if reason is not None:
                self.vehicle.report(WARNING, f"Guided mode refused: {reason}")
                return FAILED
        target = self._going(position)
        self.vehicle.target = replace(target, speed=speed) if 0.0 < speed <= FASTEST else target
        return ACCEPTED

    @builds(mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED)
    def _position_target(self, now: float) -> list[Message]:
        target = self.vehicle.target
        if target is None or self.vehicle.mode.name != "guided":
            return []
        kinds = {"position": 0xFF8, "velocity": 0xFC7, "heading": 0xBFF}
        return [
            mavlink.MAVLink_position_target_local_ned_message(
                milliseconds(now),
                _FROM_ORIGIN,
                kinds[target.kind],
                *target.position,
                *target.velocity,
                0.0,
                0.0,
                0.0,
                math.remainder(target.heading, math.tau),
                0.0,
            )
        ]


def _is_sane(target: Target) -> bool:
    """Return whether all numbers are finite and of a size that a vehicle could mean."""
    return (
        is_near(*target.position)
        and _within((*target.velocity, target.speed), FASTEST)
        and _within((target.heading, target.turn or 0.0), 1e3)
    )


def _within(values: Sequence[float], limit: float) -> bool:
    return all(abs(value) <= limit for value in values)  # false for what is not a number
