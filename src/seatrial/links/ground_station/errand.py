"""A mission, from the first heartbeat to AUTO, as a person does it at a ground station."""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence

from pymavlink.dialects.v20 import all as mavlink

from ...errors import SimulationError
from ...waypoints import Place
from ..geodesy import Origin
from ..mavlink.codec import Message
from .conversation import Conversation, Wait

CONNECTED_S, READY_S, UPLOADED_S = 60.0, 180.0, 60.0
"""Simulated time for a heartbeat, for the estimator to converge, for the upload."""
AUTO = {
    mavlink.MAV_TYPE_GROUND_ROVER: 10,
    mavlink.MAV_TYPE_SURFACE_BOAT: 10,
    mavlink.MAV_TYPE_SUBMARINE: 3,
}
"""Mode of a mission by the vehicle's type."""
DEPTH_HOLD = 2
"""Mode in which a submarine arms: it starts where it is."""
_POSITION = mavlink.EKF_POS_HORIZ_ABS
_NEEDED = {"SYS_STATUS": 1.0, "EKF_STATUS_REPORT": 1.0, "HOME_POSITION": 0.5}
"""What is asked for, Hz of simulated time."""


Errand = Generator[str, None, int]
"""Yields what it waits for, and returns the mode of the mission that was started."""


def mission(c: Conversation, places: Sequence[Place], radius: float) -> Errand:
    """Wait for the vehicle, upload waypoints in {n} from its home, arm, and start the mission.

    ``radius`` in m goes with each waypoint; 0 is the vehicle's own. Raises SimulationError for
    what it does not do in time, and for one that is no ArduPilot boat, rover or submarine.
    """
    yield from c.until(lambda: "HEARTBEAT" in c.newest, "heartbeat", CONNECTED_S)
    auto = _mode(c.newest["HEARTBEAT"])
    yield from c.until(
        lambda: _is_ready(c), "estimate that lets it arm", READY_S, lambda: _ask_for_state(c)
    )
    yield from _upload(c, _items(c, places, radius))
    set_mode = mavlink.MAV_CMD_DO_SET_MODE
    if auto == AUTO[mavlink.MAV_TYPE_SUBMARINE]:
        yield from c.command(set_mode, "mode DEPTH HOLD", 1.0, DEPTH_HOLD)
    yield from c.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, "arming", 1.0)
    yield from c.command(set_mode, "mode AUTO", 1.0, auto)
    return auto


def _mode(heartbeat: Message) -> int:
    ardupilot = heartbeat.autopilot == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
    if not ardupilot or heartbeat.type not in AUTO:
        raise SimulationError(
            f"the vehicle is of MAV_TYPE {heartbeat.type} with MAV_AUTOPILOT "
            f"{heartbeat.autopilot}; missions are for rovers, boats and submarines "
            f"{sorted(AUTO)} of ArduPilot ({mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA})"
        )
    return AUTO[heartbeat.type]


def _ask_for_state(c: Conversation) -> None:
    everything = mavlink.MAV_DATA_STREAM_ALL  # stopped: a run goes many times as fast as real time
    c.send(mavlink.MAVLink_request_data_stream_message(c.system, 1, everything, 0, 0))
    for name, rate in _NEEDED.items():
        c.request(name, rate)


def _is_ready(c: Conversation) -> bool:
    if not c.newest.keys() >= _NEEDED.keys():
        return False
    health = c.newest["SYS_STATUS"].onboard_control_sensors_health
    flags = c.newest["EKF_STATUS_REPORT"].flags
    return bool(health & mavlink.MAV_SYS_STATUS_PREARM_CHECK and flags & _POSITION)


def _items(c: Conversation, places: Sequence[Place], radius: float) -> list[Message]:
    """Return the mission, with home as item 0."""
    home = c.newest["HOME_POSITION"]
    origin = Origin(math.radians(home.latitude / 1e7), math.radians(home.longitude / 1e7))
    frame, kind = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, mavlink.MAV_CMD_NAV_WAYPOINT
    items = []
    for number, place in enumerate([(0.0, 0.0, 0.0), *places]):
        latitude, longitude, height = origin.geodetic(place)
        at = (round(latitude * 1e7), round(longitude * 1e7), height)
        parameters = (0, radius, 0, 0)
        items.append(
            mavlink.MAVLink_mission_item_int_message(
                c.system, 1, number, frame, kind, 0, 1, *parameters, *at, 0
            )
        )
    return items


def _upload(c: Conversation, items: Sequence[Message]) -> Wait:
    """Send what is requested, item by item; the last thing sent is repeated where nothing comes."""
    requests = ("MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK")
    last: Message = mavlink.MAVLink_mission_count_message(c.system, 1, len(items), 0)
    while True:
        for name in requests:
            c.newest.pop(name, None)
        yield from c.until(
            lambda: any(name in c.newest for name in requests),
            "answer to the upload of a mission",
            UPLOADED_S,
            lambda message=last: c.send(message),  # type: ignore[misc]
        )
        name = next(name for name in requests if name in c.newest)
        answer = c.newest[name]
        if name == "MISSION_ACK":
            break
        last = items[min(answer.seq, len(items) - 1)]
    if answer.type != mavlink.MAV_MISSION_ACCEPTED:
        result = mavlink.enums["MAV_MISSION_RESULT"][answer.type].name
        raise SimulationError(f"the vehicle refused the mission: {result}")
