"""Items of missions, fences and rally points: content of MISSION_ITEM and MISSION_ITEM_INT."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned

from ..codec import Message
from ..frames import GLOBAL_FRAMES, global_position
from ..scaling import deg_e7, int32
from ..transport import Sender
from ..vehicle import Vehicle

NOT_GIVEN = 0x7FFFFFFF
"""An integer coordinate that stands for not a number."""


@dataclass(frozen=True)
class Item:
    """One item, as it was sent and as it is sent back."""

    command: int
    """MAV_CMD."""
    frame: int
    """MAV_FRAME."""
    parameters: tuple[float, float, float, float]
    """Parameters 1 to 4."""
    x: int
    """Parameter 5: latitude in 1e-7 degrees if the frame is global, else as it is."""
    y: int
    """Parameter 6: longitude in 1e-7 degrees if the frame is global, else as it is."""
    z: float
    """Parameter 7: altitude, m."""
    autocontinue: int = 1

    @property
    def name(self) -> str:
        """The command's name without the prefix that all have, its number if it has none."""
        entry = mavlink.enums["MAV_CMD"].get(self.command)
        return entry.name.removeprefix("MAV_CMD_") if entry else f"command {self.command}"

    def number(self, index: int) -> float:
        """Return parameter ``index``, 1 to 4; 0 for what is not a number."""
        value = self.parameters[index - 1]
        return 0.0 if math.isnan(value) else value

    def coordinates(self) -> tuple[float, float]:
        """Return parameters 5 and 6, in degrees if the frame is global; NaN if not given."""
        unit = 1e7 if self.frame in GLOBAL_FRAMES else 1.0
        x, y = (math.nan if value == NOT_GIVEN else value / unit for value in (self.x, self.y))
        return x, y

    def place(self, vehicle: Vehicle) -> Ned | None:
        """Return its place in {n}; None if it is none, or farther than a vehicle goes."""
        latitude, longitude = self.coordinates()
        return global_position(vehicle, self.frame, latitude, longitude, self.z)

    def destination(self, vehicle: Vehicle) -> Ned | None:
        """Return where it leads in {n}: its place, but at latitude and longitude 0, or without
        them, where the vehicle is now.
        """
        if (self.x, self.y) not in ((0, 0), (NOT_GIVEN, NOT_GIVEN)):
            return self.place(vehicle)
        latitude, longitude, _ = vehicle.origin.geodetic(vehicle.estimates.position_n)
        return global_position(vehicle, self.frame, latitude, longitude, self.z)


def from_message(message: Message) -> Item:
    """Return the item of a MISSION_ITEM or MISSION_ITEM_INT."""
    x, y = message.x, message.y
    if message.get_type() == "MISSION_ITEM":
        x, y = (as_integer(value, message.frame) for value in (x, y))
    return Item(
        message.command,
        message.frame,
        (message.param1, message.param2, message.param3, message.param4),
        x,
        y,
        message.z,
        message.autocontinue,
    )


def as_integer(value: float, frame: int) -> int:
    """Return parameter 5 or 6, in degrees if the frame is global, as an `Item` has it."""
    if math.isnan(value):
        return NOT_GIVEN
    return deg_e7(value) if frame in GLOBAL_FRAMES else int32(value)


def to_message(
    item: Item, kind: int, sequence: int, receiver: Sender, *, integers: bool
) -> Message:
    """Return an item as MISSION_ITEM_INT, or as MISSION_ITEM if ``integers`` are not wanted."""
    build = mavlink.MAVLink_mission_item_int_message
    x: float = item.x
    y: float = item.y
    if not integers:
        build = mavlink.MAVLink_mission_item_message
        x, y = item.coordinates()
    head = (receiver.system, receiver.component, sequence, item.frame, item.command)
    return build(*head, 0, item.autocontinue, *item.parameters, x, y, item.z, kind)


def home_item(vehicle: Vehicle) -> Item:
    """Return home as the item 0 that ArduPilot's missions begin with."""
    latitude, longitude, altitude = vehicle.origin.geodetic(vehicle.home_n)
    return Item(
        mavlink.MAV_CMD_NAV_WAYPOINT,
        mavlink.MAV_FRAME_GLOBAL,
        (0.0, 0.0, 0.0, 0.0),
        deg_e7(latitude),
        deg_e7(longitude),
        altitude,
    )
