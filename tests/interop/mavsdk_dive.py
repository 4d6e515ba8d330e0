"""A dive of the VideoRay by the real MAVSDK; a program of its own, as `mavsdk_flight`."""

from __future__ import annotations

import asyncio
import json
import math
import os
import sys
from pathlib import Path

import pymap3d
from mavsdk.asyncio.plugins.mission.mission import MissionAsync
from mavsdk.asyncio.plugins.mission_raw.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.offboard.offboard import OffboardAsync
from mavsdk.plugins.mission.mission import MissionPlan
from mavsdk.plugins.mission_raw.mission_raw import MissionItem as RawItem
from mavsdk.plugins.offboard.offboard import VelocityBodyYawspeed
from mavsdk.plugins.telemetry.telemetry import FlightMode
from mavsdk.vehicle import Vehicle

from tests.interop import mavsdk_stages as stages
from tests.interop.mavsdk_station import MANOEUVRE_S, Station, answered, connected, refused

COURSE = ((2.0, 0.0, 1.5), (2.0, 2.0, 2.5))
"""Waypoints: m north, east and below the origin."""
DO_SET_MODE, AUTO, POSHOLD = 176, 3, 16
NAN = math.nan


class Places:
    """Latitude and longitude, by the origin that the vehicle tells; ``surface`` is its altitude."""

    def __init__(self, latitude: float, longitude: float, surface: float) -> None:
        self._origin, self.surface = (latitude, longitude), surface

    def __call__(self, north: float, east: float) -> tuple[float, float]:
        latitude, longitude, _ = pymap3d.ned2geodetic(north, east, 0.0, *self._origin, 0.0)
        return float(latitude), float(longitude)


async def dive_ardupilot(station: Station, places: Places) -> None:
    """MAVSDK knows no modes of ArduPilot's Sub: they are set by their numbers."""
    assert await refused(station.action.hold()) == "UNKNOWN"
    missions = MissionRawAsync(station.system)
    items = []
    for sequence, (north, east, down) in enumerate([(0.0, 0.0, 0.0), *COURSE]):
        latitude, longitude = (round(degrees * 1e7) for degrees in places(north, east))
        place = (latitude, longitude, -down, 0)
        items.append(RawItem(sequence, 6, 16, int(sequence == 0), 1, 0.0, 0.5, 0.0, 0.0, *place))
    await answered(missions.upload_mission(items))
    assert await station.command(DO_SET_MODE, 1, AUTO) == 0
    await _finish(station, missions)
    assert await station.command(DO_SET_MODE, 1, POSHOLD) == 0
    await station.hears("flight_mode", "it holds", value=int(FlightMode.POSCTL))


async def dive_px4(station: Station, places: Places) -> None:
    missions = MissionAsync(station.system)
    items = [stages.item(places(north, east), -down, radius=0.5) for north, east, down in COURSE]
    await answered(missions.upload_mission(MissionPlan(items)))
    await answered(missions.start_mission())
    await _finish(station, missions)
    latitude, longitude = places(2.0, 2.0)
    async with station.stage("goto"):
        altitude = places.surface - 1.0
        await answered(station.action.goto_location(latitude, longitude, altitude, NAN))
        await station.until(lambda: abs(_down(station) - 1.0) < 0.1, "one metre deep", MANOEUVRE_S)
    pilot = OffboardAsync(station.system)
    await answered(pilot.set_velocity_body(VelocityBodyYawspeed(0.2, 0.0, 0.05, 5.0)))
    await answered(pilot.start())
    await station.passes(6.0)
    async with station.stage("turn"):
        await station.passes(6.0)
    await answered(pilot.stop())


async def _finish(station: Station, missions: MissionAsync | MissionRawAsync) -> None:
    async with station.stage("mission"), asyncio.timeout(MANOEUVRE_S):
        while not await answered(missions.is_mission_finished()):
            await asyncio.sleep(0.05)


def _down(station: Station) -> float:
    return float(station.last("position_velocity_ned")["position.down_m"])


async def fly(dialect: str, url: str, log: Path) -> None:
    async with connected(url) as station:
        assert await station.system.vehicle_type() == Vehicle.SUBMARINE
        await station.hears("health_all_ok", "the vehicle is well", value=True)
        origin = await answered(station.telemetry.get_gps_global_origin())
        places = Places(origin.latitude_deg, origin.longitude_deg, origin.altitude_m)
        await station.hears("armed", "it starts disarmed", value=False)
        await stages.arm(station)
        await {"ardupilotmega": dive_ardupilot, "px4": dive_px4}[dialect](station, places)
        async with station.stage("surface"):
            await answered(station.action.land())
            await station.until(lambda: _down(station) < 0.4, "it comes up", MANOEUVRE_S)
        await stages.disarm(station)
        received = {"samples": station.samples, "marks": station.marks, "notes": station.notes}
    log.write_text(json.dumps(received), "utf-8")


if __name__ == "__main__":
    asyncio.run(fly(sys.argv[1], sys.argv[2], Path(sys.argv[3])))
    sys.stdout.flush()
    os._exit(0)  # threads of MAVSDK that still wait must not keep us
