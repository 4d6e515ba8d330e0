"""A mission, from the first heartbeat to AUTO, as a person does it at a ground station."""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import SimulationError
from seatrial.links.geodesy import Origin
from seatrial.model.waypoints import Place

from ..codec import Message
from .conversation import Conversation, Wait
from .dialects import Dialect, dialect_of

CONNECTED_S, READY_S, UPLOADED_S = 60.0, 180.0, 60.0
"""Simulated time for a heartbeat, for the estimator to converge, for the upload."""
_SET_MODE = mavlink.MAV_CMD_DO_SET_MODE
_POSITION = mavlink.EKF_POS_HORIZ_ABS
"""Of ArduPilot's flags; ESTIMATOR_POS_HORIZ_ABS of PX4's is the same."""
_NEEDED = {"SYS_STATUS": 1.0, "HOME_POSITION": 0.5, "GLOBAL_POSITION_INT": 2.0}
"""What is asked for beside the estimator's flags, Hz of simulated time."""
_FLAGS_HZ = 1.0
_ITEMS = {
    "waypoint": mavlink.MAV_CMD_NAV_WAYPOINT,
    "loiter": mavlink.MAV_CMD_NAV_LOITER_UNLIM,
    "land": mavlink.MAV_CMD_NAV_LAND,
}
LAST = tuple(_ITEMS)
"""Of the last waypoint: passed, held until something else is ordered, or landed on."""
FURTHEST_M = 50e3
"""Between the origin of {n} and the vehicle's home: further off, one of the two is wrong."""


Errand = Generator[str, None, Dialect]
"""Yields what it waits for, and returns how the mission was started."""


def mission(
    c: Conversation, places: Sequence[Place], radius: float, origin: Origin, last: str
) -> Errand:
    """Wait for the vehicle, upload waypoints in {n}, arm, and start the mission.

    ``origin`` is that of {n}; ``radius`` in m goes with each waypoint, 0 is the vehicle's own;
    ``last`` of `LAST` is how the last one ends.
    Raises SimulationError for what it does not do in time, for one that takes no missions
    (`dialect_of`), and for one whose home is far from ``origin``.
    """
    yield from c.until(lambda: "HEARTBEAT" in c.newest, "heartbeat", CONNECTED_S)
    dialect = dialect_of(c.newest["HEARTBEAT"])
    yield from c.until(
        lambda: _is_ready(c, dialect),
        "estimate that lets it arm",
        READY_S,
        lambda: _ask_for_state(c, dialect),
    )
    require_near(c.newest["HOME_POSITION"], origin)
    yield from _upload(c, _items(c, places, radius, dialect, origin, last))
    if dialect.arms_in is not None:
        yield from c.command(_SET_MODE, "mode to arm in", 1.0, dialect.arms_in)
    starts = [
        (mavlink.MAV_CMD_COMPONENT_ARM_DISARM, "arming", 1.0),
        (_SET_MODE, "mode of the mission", 1.0, *dialect.mode),
    ]
    for number, what, *parameters in reversed(starts) if dialect.mode_first else starts:
        yield from c.command(number, what, *parameters)
    return dialect


def home_of(message: Message, origin: Origin) -> Place:
    """Return a HOME_POSITION in {n}, on the surface: altitudes of missions count from it."""
    north, east, _ = origin.position(message.latitude / 1e7, message.longitude / 1e7, 0.0)
    return north, east, 0.0


def require_near(home: Message, origin: Origin) -> None:
    """Raise SimulationError for a HOME_POSITION that is far from the origin of {n}."""
    if math.hypot(*home_of(home, origin)) > FURTHEST_M:
        of_home = (
            f"latitude {home.latitude / 1e7:.6f} deg, longitude {home.longitude / 1e7:.6f} deg"
        )
        latitude, longitude = math.degrees(origin.latitude), math.degrees(origin.longitude)
        raise SimulationError(
            f"the vehicle's home, {of_home}, is more than {FURTHEST_M / 1e3:g} km from latitude "
            f"{latitude:.6f} deg, longitude {longitude:.6f} deg, from which the waypoints are "
            "counted (parameters latitude and longitude)"
        )


def _ask_for_state(c: Conversation, dialect: Dialect) -> None:
    everything = mavlink.MAV_DATA_STREAM_ALL  # stopped: a run goes many times as fast as real time
    c.send(mavlink.MAVLink_request_data_stream_message(c.system, 1, everything, 0, 0))
    for name, rate in {**_NEEDED, dialect.estimate: _FLAGS_HZ}.items():
        c.request(name, rate)


def _is_ready(c: Conversation, dialect: Dialect) -> bool:
    if not c.newest.keys() >= {*_NEEDED, dialect.estimate}:
        return False
    health = c.newest["SYS_STATUS"].onboard_control_sensors_health
    flags = c.newest[dialect.estimate].flags
    return bool(health & mavlink.MAV_SYS_STATUS_PREARM_CHECK and flags & _POSITION)


def _items(
    c: Conversation,
    places: Sequence[Place],
    radius: float,
    dialect: Dialect,
    origin: Origin,
    last: str,
) -> list[Message]:
    """Return the mission, with home as item 0 and a take-off where the firmware has it so."""
    frame, passed = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, mavlink.MAV_CMD_NAV_WAYPOINT
    kinds = [(passed, place) for place in places[:-1]] + [(_ITEMS[last], places[-1])]
    if dialect.takes_off:
        kinds.insert(0, (mavlink.MAV_CMD_NAV_TAKEOFF, (0.0, 0.0, places[0][2])))
    if dialect.counts_home:
        kinds.insert(0, (passed, (0.0, 0.0, 0.0)))
    items = []
    for number, (kind, place) in enumerate(kinds):
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
