"""Checks of missions and rally points, and limits of all items."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from pymavlink.dialects.v20 import all as mavlink

from ..frames import GLOBAL_FRAMES
from ..vehicle import Vehicle
from .plan_items import NOT_GIVEN, Item

_AT_A_PLACE = (
    mavlink.MAV_CMD_NAV_WAYPOINT,
    mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM,
    mavlink.MAV_CMD_NAV_LOITER_TURNS,
    mavlink.MAV_CMD_NAV_LOITER_TIME,
)
NAVIGATION = (*_AT_A_PLACE, mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH, mavlink.MAV_CMD_NAV_DELAY)
"""Commands that lead somewhere, or stay."""
_ACTIONS = (
    mavlink.MAV_CMD_CONDITION_DELAY,
    mavlink.MAV_CMD_DO_SET_MODE,
    mavlink.MAV_CMD_DO_JUMP,
    mavlink.MAV_CMD_DO_CHANGE_SPEED,
    mavlink.MAV_CMD_DO_SET_HOME,
    mavlink.MAV_CMD_DO_FENCE_ENABLE,
)
_HIGHEST = 83_000.0
"""Heights and depths of ArduPilot's missions are below, m."""
STORED = frozenset(
    getattr(mavlink, f"MAV_CMD_{name}")
    for name in (
        "NAV_LAND", "NAV_TAKEOFF", "NAV_CONTINUE_AND_CHANGE_ALT", "NAV_LOITER_TO_ALT",
        "NAV_SPLINE_WAYPOINT", "NAV_ALTITUDE_WAIT", "NAV_VTOL_TAKEOFF", "NAV_VTOL_LAND",
        "NAV_GUIDED_ENABLE", "NAV_PAYLOAD_PLACE", "NAV_SCRIPT_TIME", "NAV_ATTITUDE_TIME",
        "CONDITION_DISTANCE", "CONDITION_YAW", "DO_SET_RELAY", "DO_REPEAT_RELAY",
        "DO_SET_SERVO", "DO_REPEAT_SERVO", "DO_RETURN_PATH_START", "DO_LAND_START",
        "DO_GO_AROUND", "DO_PAUSE_CONTINUE", "DO_SET_REVERSE", "DO_SET_ROI_LOCATION",
        "DO_SET_ROI_NONE", "DO_SET_ROI", "DO_DIGICAM_CONFIGURE", "DO_DIGICAM_CONTROL",
        "DO_MOUNT_CONTROL", "DO_SET_CAM_TRIGG_DIST", "DO_PARACHUTE", "DO_INVERTED_FLIGHT",
        "DO_GRIPPER", "DO_AUTOTUNE_ENABLE", "DO_SET_RESUME_REPEAT_DIST", "DO_SPRAYER",
        "DO_SEND_SCRIPT_MESSAGE", "DO_AUX_FUNCTION", "DO_GUIDED_LIMITS", "DO_ENGINE_CONTROL",
        "SET_CAMERA_ZOOM", "SET_CAMERA_FOCUS", "SET_CAMERA_SOURCE", "JUMP_TAG", "DO_JUMP_TAG",
        "DO_GIMBAL_MANAGER_PITCHYAW", "IMAGE_START_CAPTURE", "IMAGE_STOP_CAPTURE",
        "VIDEO_START_CAPTURE", "VIDEO_STOP_CAPTURE", "DO_VTOL_TRANSITION", "DO_WINCH",
    )
)  # fmt: skip
"""Commands that an ArduPilot stores, of cameras, grippers, servos, relays, heights: a mission skips
them here, with a text, as nothing of that kind is on board (NAV_SPLINE_WAYPOINT: a waypoint)."""
JUMPS = (mavlink.MAV_CMD_DO_JUMP, mavlink.MAV_CMD_DO_JUMP_TAG)
_DELAYS = (mavlink.MAV_CMD_NAV_DELAY, mavlink.MAV_CMD_CONDITION_DELAY)


class Refusal(NamedTuple):
    """Refusal of a list, with its reason."""

    result: int
    """MAV_MISSION_RESULT."""
    text: str


Check = Callable[[Sequence[Item], Vehicle], Refusal | None]
"""Returns what is wrong with a list of items, None if nothing is."""


def first_item(vehicle: Vehicle) -> int:
    """Return the number of a mission's first item: 1 where item 0 is home."""
    return int(vehicle.dialect.home_is_item_0)


def check_mission(items: Sequence[Item], vehicle: Vehicle) -> Refusal | None:
    """Refuse places that are none, jumps out of the list, and commands that are not carried out."""
    first = first_item(vehicle)
    for sequence, item in enumerate(items[first:], first):
        refusal = _check_command(item, vehicle, range(first, len(items)))
        if refusal is not None:
            return of_item(sequence, item, refusal)
    return None


def check_rally(items: Sequence[Item], vehicle: Vehicle) -> Refusal | None:
    """Refuse what is not a rally point, and places that are none."""
    for sequence, item in enumerate(items):
        if item.command != mavlink.MAV_CMD_NAV_RALLY_POINT:
            refusal = Refusal(mavlink.MAV_MISSION_UNSUPPORTED, "is not a rally point")
            return of_item(sequence, item, refusal)
        refused = check_place(item, item.place(vehicle))
        if refused is not None:
            return of_item(sequence, item, refused)
    return None


def check_place(item: Item, place: object) -> Refusal | None:
    """Refuse an item in a frame without latitude and longitude, or whose ``place`` is None."""
    if item.frame not in GLOBAL_FRAMES:
        entry = mavlink.enums["MAV_FRAME"].get(item.frame)
        frame = entry.name if entry else f"frame {item.frame}"
        return Refusal(mavlink.MAV_MISSION_UNSUPPORTED_FRAME, f"{frame} is not supported")
    if place is None:
        latitude, longitude = item.coordinates()
        north = abs(latitude) <= 90.0 and not abs(longitude) <= 180.0
        which = mavlink.MAV_MISSION_INVALID_PARAM5_X
        which = mavlink.MAV_MISSION_INVALID_PARAM6_Y if north else which
        return Refusal(which, "is no place, or too far away")
    return _check_numbers(item)


def bad_parameter(index: int, found: float, needed: str) -> Refusal:
    """Return the refusal of parameter ``index``, 1 to 7."""
    result = mavlink.MAV_MISSION_INVALID_PARAM1 + index - 1
    return Refusal(result, f"parameter {index} is {found:g}, {needed} is needed")


def of_item(sequence: int, item: Item, refusal: Refusal) -> Refusal:
    """Return a refusal whose text names the item."""
    return Refusal(refusal.result, f"item {sequence}, {item.name}: {refusal.text}")


def _check_command(item: Item, vehicle: Vehicle, sequences: range) -> Refusal | None:
    stored = STORED if vehicle.dialect.home_is_item_0 else ()
    if item.command not in (*NAVIGATION, *_ACTIONS, *stored):
        return Refusal(mavlink.MAV_MISSION_UNSUPPORTED, "is not supported")
    if vehicle.dialect.home_is_item_0 and (refusal := _check_given(item)) is not None:
        return refusal
    if item.command in _AT_A_PLACE:
        is_given = NOT_GIVEN not in (item.x, item.y) or not vehicle.dialect.home_is_item_0
        return check_place(item, item.destination(vehicle) if is_given else None)
    if item.command == mavlink.MAV_CMD_DO_JUMP and item.parameters[0] not in sequences:
        needed = f"an item, {sequences[0]} to {sequences[-1]},"
        refusal = bad_parameter(1, item.parameters[0], needed)
        if vehicle.dialect.home_is_item_0:  # an ArduPilot checks jumps when the list is whole
            return Refusal(mavlink.MAV_MISSION_ERROR, refusal.text)
        return refusal
    if item.command in _DELAYS and not item.parameters[0] >= 0.0:
        return bad_parameter(1, item.parameters[0], "a number of seconds, not a time of day,")
    if item.command == mavlink.MAV_CMD_DO_FENCE_ENABLE and item.parameters[0] not in (0.0, 1.0):
        return bad_parameter(1, item.parameters[0], "0 (off) or 1 (on)")
    if item.command == mavlink.MAV_CMD_DO_SET_MODE:
        return _check_mode(item, vehicle)
    return _check_numbers(item)


def _check_given(item: Item) -> Refusal | None:
    """Refuse what an ArduPilot does: no number but for a heading, and heights beyond 83 km."""
    for index, value in enumerate(item.parameters[:3], 1):
        if math.isnan(value):
            return bad_parameter(index, value, "a number")
    if not abs(item.z) < _HIGHEST:
        return bad_parameter(7, item.z, f"a height or depth below {_HIGHEST:g} m")
    return None


def _check_mode(item: Item, vehicle: Vehicle) -> Refusal | None:
    base, main, sub, _ = item.parameters
    custom = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    if not (0.0 <= base < 256.0 and int(base) & custom):
        return bad_parameter(1, base, f"{custom} (the number of a mode)")
    if vehicle.dialect.by_command(main, sub) is None:
        return bad_parameter(2, main, "the number of a mode that this vehicle has")
    return None


def _check_numbers(item: Item) -> Refusal | None:
    """Refuse infinities; what is not a number requests nothing."""
    for index, value in (*enumerate(item.parameters, 1), (7, item.z)):
        if math.isinf(value):
            return bad_parameter(index, value, "a finite number")
    return None
