"""One flight of a boat by the real MAVSDK; a program of its own, for a hang must not hang us.

``python -m tests.interop.mavsdk_flight DIALECT URL LOG`` flies and writes what the reference tool needs to
the file LOG. What MAVSDK answers is checked here, what the boat really did by the reference tool.
"""

from __future__ import annotations

import asyncio
import json
import math
import os
import sys
from pathlib import Path

from mavsdk.asyncio.plugins.mission.mission import MissionAsync
from mavsdk.asyncio.plugins.mission_raw.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.param.param import ParamAsync
from mavsdk.autopilot import Autopilot
from mavsdk.plugins.mission.mission import MissionPlan
from mavsdk.plugins.mission_raw.mission_raw import MissionItem as RawItem
from mavsdk.plugins.telemetry.telemetry import FlightMode

from tests.interop import mavsdk_stages as stages
from tests.interop.mavsdk_station import Station, answered, connected, refused
from tests.kits.mavlink.ground import north_of

COURSE = ((20.0, 0.0), (20.0, 20.0), (0.0, 20.0), (0.0, 0.0))
"""Waypoints, m north and east of the origin."""
SPEEDS = (0.75, 1.0)
"""That the mission asks for, one after the other, m/s."""
CRUISE = 0.875
OURS = 245  # the system of MAVSDK
"""Of a mission that has not asked for a speed yet, m/s."""
WAIT_S = 5.0
"""Time to stay at the second waypoint."""
NAN = math.nan


# ---------------------------------------------------------------------- ArduPilot


def raw(sequence: int, command: int, *parameters: float, place=(0.0, 0.0)) -> RawItem:
    latitude, longitude = (round(degrees * 1e7) for degrees in north_of(*place))
    four = (*parameters, *(0.0,) * 4)[:4]
    return RawItem(sequence, 6, command, int(sequence == 0), 1, *four, latitude, longitude, 0.0, 0)


def raw_mission() -> list[RawItem]:
    """Return home, and the course with changes of speed and a place to loiter at."""
    waypoint, loiter, change_speed = 16, 19, 178
    return [
        raw(0, waypoint),  # home, which is not used
        raw(1, change_speed, 1.0, SPEEDS[0], -1.0),
        raw(2, waypoint, place=COURSE[0]),
        raw(3, change_speed, 1.0, SPEEDS[1], -1.0),
        raw(4, loiter, WAIT_S, place=COURSE[1]),
        raw(5, waypoint, 0.0, 2.0, place=COURSE[2]),
        raw(6, waypoint, place=COURSE[3]),
    ]


async def ardupilot_parameters(station: Station) -> None:
    parameters = ParamAsync(station.system)
    everything = await answered(parameters.get_all_params())
    integers = {each.name: each.value for each in everything.int_params}
    reals = {each.name: each.value for each in everything.float_params}
    assert (integers["SYSID_THISMAV"], integers["FRAME_CLASS"]) == (1, 2)
    assert reals["WP_RADIUS"] == 3.0
    await answered(parameters.set_param_float("CRUISE_SPEED", CRUISE))
    assert await answered(parameters.get_param_float("CRUISE_SPEED")) == CRUISE
    await answered(parameters.set_param_int("FS_ACTION", 2))
    assert await answered(parameters.get_param_int("FS_ACTION")) == 2
    await answered(parameters.set_param_int("SYSID_MYGCS", OURS))  # who may steer
    assert await refused(parameters.set_param_int("FS_ACTION", 99)) == "VALUE_OUT_OF_RANGE"
    assert await refused(parameters.set_param_int("SYSID_THISMAV", 3)) == "READ_ONLY"
    await station.reads("SYSID_THISMAV stays 1: it belongs to the trial")
    assert await refused(parameters.get_param_float("NO_SUCH_ONE")) == "DOES_NOT_EXIST"


async def raw_mission_flown(station: Station) -> None:
    missions = MissionRawAsync(station.system)
    items = raw_mission()
    await answered(missions.upload_mission(items))
    back = await answered(missions.download_mission())
    for sent, got in zip(items[1:], back[1:], strict=True):
        assert vars(sent) == vars(got), (str(sent), str(got))
    await stages.mission(station, missions, pause_at=4)


async def ardupilot(station: Station) -> None:
    assert await station.system.autopilot_type() == Autopilot.ARDUPILOT
    await ardupilot_parameters(station)
    await stages.refused_arming(station)
    await raw_mission_flown(station)
    station.ignore_all_but(*stages.ESSENTIAL)
    await stages.goto(station, FlightMode.OFFBOARD)
    await stages.offboard(station, FlightMode.OFFBOARD)
    await stages.manual(station, mode=0, y=0.3, z=0.6)
    await stages.home_again(station)
    await stages.refusals(
        station,
        {
            "reboot": "COMMAND_DENIED",
            "shutdown": "COMMAND_DENIED",
            "land": "UNSUPPORTED",
            "takeoff": "UNSUPPORTED",
            "transition_to_fixedwing": "NO_VTOL_TRANSITION_SUPPORT",
        },
    )
    await stages.disarm(station)


# ---------------------------------------------------------------------- PX4


async def px4_parameters(station: Station) -> None:
    parameters = ParamAsync(station.system)
    everything = await answered(parameters.get_all_params())
    integers = {each.name: each.value for each in everything.int_params}
    assert (integers["MAV_SYS_ID"], integers["MAV_TYPE"]) == (1, 11)
    await answered(parameters.set_param_float("GND_SPEED_TRIM", CRUISE))
    await answered(parameters.set_param_int("COM_DL_LOSS_T", 40))
    assert await answered(parameters.get_param_int("COM_DL_LOSS_T")) == 40
    assert await refused(parameters.set_param_int("MAV_TYPE", 3)) == "READ_ONLY"
    assert await refused(parameters.set_param_int("NAV_DLL_ACT", 77)) == "VALUE_OUT_OF_RANGE"
    assert await refused(parameters.get_param_int("NO_SUCH_ONE")) == "DOES_NOT_EXIST"


async def mission_flown(station: Station) -> None:
    missions = MissionAsync(station.system)
    plan = MissionPlan(
        [
            stages.item(north_of(*COURSE[0]), speed=SPEEDS[0]),
            stages.item(north_of(*COURSE[1]), speed=SPEEDS[1], wait=WAIT_S),
            stages.item(north_of(*COURSE[2]), speed=SPEEDS[1], radius=2.0),
            stages.item(north_of(*COURSE[3]), speed=SPEEDS[1]),
        ]
    )
    await answered(missions.upload_mission(plan))
    back = (await answered(missions.download_mission())).mission_items
    assert len(back) == len(plan.mission_items), [str(each) for each in back]
    for sent, got in zip(plan.mission_items, back, strict=True):
        for key in ("latitude_deg", "longitude_deg"):
            assert abs(getattr(sent, key) - getattr(got, key)) < 1e-7
        assert (got.speed_m_s, got.relative_altitude_m) == (sent.speed_m_s, 0.0), str(got)
    await stages.mission(station, missions, pause_at=1)


async def px4(station: Station) -> None:
    assert await station.system.autopilot_type() == Autopilot.PX4
    await px4_parameters(station)
    await stages.refused_arming(station)
    await mission_flown(station)
    station.ignore_all_but(*stages.ESSENTIAL)
    await stages.goto(station, FlightMode.HOLD)
    await stages.offboard(station, FlightMode.OFFBOARD)
    await stages.manual(station, mode=1, y=0.3, z=0.8)
    await stages.home_again(station)
    await stages.refusals(
        station,
        {
            "reboot": "COMMAND_DENIED",
            "shutdown": "COMMAND_DENIED",
            "land": "UNSUPPORTED",
            "takeoff": "UNSUPPORTED",
        },
    )
    await stages.disarm(station)


# ---------------------------------------------------------------------- both


async def fly(dialect: str, url: str, log: Path) -> None:
    async with connected(url) as station:
        await stages.health(station)
        await stages.identity(station)
        await stages.rates(station)
        async with station.stage("at rest"):
            await station.passes(5.0)
        await stages.latency(station)
        await {"ardupilotmega": ardupilot, "px4": px4}[dialect](station)
        received = {"samples": station.samples, "marks": station.marks, "notes": station.notes}
    log.write_text(json.dumps(received), "utf-8")


if __name__ == "__main__":
    asyncio.run(fly(sys.argv[1], sys.argv[2], Path(sys.argv[3])))
    sys.stdout.flush()
    os._exit(0)  # threads of MAVSDK that still wait must not keep us
