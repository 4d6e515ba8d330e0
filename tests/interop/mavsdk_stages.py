"""Parts of a flight with MAVSDK that are the same for an ArduPilot and a PX4."""

from __future__ import annotations

import asyncio
import json
import math
import time
from collections.abc import Awaitable, Callable
from typing import Any

from mavsdk.asyncio.plugins.geofence.geofence import GeofenceAsync
from mavsdk.asyncio.plugins.info.info import InfoAsync
from mavsdk.asyncio.plugins.manual_control.manual_control import ManualControlAsync
from mavsdk.asyncio.plugins.offboard.offboard import OffboardAsync
from mavsdk.autopilot import Autopilot
from mavsdk.exceptions import MavsdkError
from mavsdk.plugins.geofence.geofence import Circle, FenceType, GeofenceData, Point, Polygon
from mavsdk.plugins.mavlink_direct.mavlink_direct import MavlinkMessage
from mavsdk.plugins.mission.mission import MissionItem
from mavsdk.plugins.offboard.offboard import (
    Attitude,
    PositionNedYaw,
    VelocityBodyYawspeed,
    VelocityNedYaw,
)
from mavsdk.plugins.telemetry.telemetry import FlightMode, Health

from tests.interop.mavsdk_station import ANSWER_S, MANOEUVRE_S, Station, answered, flat, refused
from tests.kits.mavlink.ground import north_of

NAN = math.nan
DO_SET_MODE, REQUEST_MESSAGE, CUSTOM_MODE = 176, 512, 1
NOT_THERE = ("actuator_control_target", "actuator_output_status")
"""Streams that MAVSDK asks for and this vehicle has not."""
RATE_HZ = 3.0
"""What `rates` asks for: the default of no stream."""
CLOCK_HZ = 10.0
"""Of the stream whose times all others get."""
ESSENTIAL = (
    *("attitude_euler", "position_velocity_ned", "flight_mode", "armed", "health", "home"),
    "status_text",
)
"""Streams that the stages after the mission need. To receive all is much work for a slow machine."""
PINGS = 50


async def identity(station: Station) -> None:
    """Say who the vehicle is: firmware and profile; and how fast the simulation runs."""
    info = InfoAsync(station.system)
    version = await answered(info.get_version())
    numbers = (version.flight_sw_major, version.flight_sw_minor, version.flight_sw_patch)
    released = {Autopilot.ARDUPILOT: (4, 6, 0), Autopilot.PX4: (1, 15, 0)}
    assert numbers == released[await station.system.autopilot_type()], numbers
    assert (await answered(info.get_identification())).legacy_uid == 0x5EA7_0001
    assert await station.system.get_system_id() == 1
    assert await station.system.component_ids() == [1]
    origin = await answered(station.telemetry.get_gps_global_origin())
    station.notes["origin"] = [origin.latitude_deg, origin.longitude_deg, origin.altitude_m]


async def health(station: Station) -> None:
    """Wait until every field of health is true: sensors, positions, home, armable."""
    await station.receives("health_all_ok", "the vehicle is well", value=True)
    await station.receives("health", "every field", **dict.fromkeys(flat(Health()), True))
    await station.receives("flight_mode", "it starts in hold", value=int(FlightMode.HOLD))
    await station.receives("armed", "it starts disarmed", value=False)


async def rates(station: Station) -> None:
    """Ask for 3 Hz of every stream: those that there are follow, others are refused."""
    names = [n.removeprefix("set_rate_") for n in dir(station.telemetry) if "set_rate_" in n]
    missing = set()
    for name in names:
        rate = CLOCK_HZ if name == "attitude_euler" else RATE_HZ
        try:
            await answered(getattr(station.telemetry, f"set_rate_{name}")(rate))
        except MavsdkError as error:
            missing.add(f"{name}: {error.args[0].name}")
    assert missing == {f"{name}: COMMAND_DENIED" for name in NOT_THERE}, missing
    await station.passes(1.0)
    async with station.stage("rates"):
        await station.passes(10.0)


async def refused_arming(station: Station) -> None:
    """Arm outside of a fence: refused, with the reason; then inside, accepted."""
    fence = GeofenceAsync(station.system)
    far = [Point(*north_of(n, e)) for n, e in ((100, 0), (120, 0), (120, 30), (100, 30))]
    around = Circle(Point(*north_of(0.0)), 60.0, FenceType.INCLUSION)
    elsewhere = GeofenceData([Polygon(far, FenceType.INCLUSION)], [])
    await answered(fence.upload_geofence(elsewhere))
    await station.until(lambda: not station.last("health")["is_armable"], "not armable outside")
    assert await refused(station.action.arm()) in ("COMMAND_DENIED", "FAILED")
    await station.reads("PreArm: outside the fence")
    await answered(fence.upload_geofence(GeofenceData([], [around])))
    got = (await answered(fence.download_geofence())).circles
    assert [(c.radius, c.fence_type) for c in got] == [(60.0, FenceType.INCLUSION)], got
    await station.until(lambda: station.last("health")["is_armable"], "armable inside")
    await arm(station)
    await answered(fence.clear_geofence())


async def arm(station: Station) -> None:
    await answered(station.action.arm())
    await station.receives("armed", "armed", value=True)


async def disarm(station: Station) -> None:
    await answered(station.action.disarm())
    await station.receives("armed", "disarmed", value=False)


def item(
    place: tuple[float, float],
    altitude: float = 0.0,
    *,
    speed: float = NAN,
    wait: float = NAN,
    radius: float = NAN,
) -> MissionItem:
    """Return an item of a Mission: latitude and longitude; m above home; m/s, s, m."""
    none, nothing = MissionItem.CameraAction.NONE, MissionItem.VehicleAction.NONE
    return MissionItem(
        *place,
        altitude,
        speed,
        math.isnan(wait),
        NAN,
        NAN,
        none,
        wait,
        NAN,
        radius,
        NAN,
        NAN,
        nothing,
    )


async def mission(station: Station, missions: Any, pause_at: int) -> None:
    """Fly a mission that is uploaded, with a pause on the way; then clear it."""
    progress: list[tuple[int, int]] = []

    async def follow() -> None:
        async for each in missions.subscribe_mission_progress():
            progress.append((each.current, each.total))

    follower = asyncio.create_task(follow())
    async with station.stage("mission"):
        await answered(missions.start_mission())
        await station.receives("flight_mode", "mission", value=int(FlightMode.MISSION))
        await station.until(
            lambda: any(current >= pause_at for current, _ in progress), "progress", MANOEUVRE_S
        )
        await station.passes(6.0)
        await answered(missions.pause_mission())
        await station.receives("flight_mode", "holds", value=int(FlightMode.HOLD))
        async with station.stage("pause"):
            await station.passes(12.0)
        assert not await answered(missions.is_mission_finished())
        await answered(missions.start_mission())
        async with asyncio.timeout(MANOEUVRE_S):
            while not await answered(missions.is_mission_finished()):
                await asyncio.sleep(0.05)
    follower.cancel()
    station.notes["progress"] = progress
    await answered(missions.clear_mission())


async def goto(station: Station, mode: FlightMode) -> None:
    """Go to a place, slower on the way, and back home."""
    async with station.stage("goto"):
        latitude, longitude = north_of(12.0, 9.0)
        await answered(station.action.goto_location(latitude, longitude, 0.0, NAN))
        await station.receives("flight_mode", "goes", value=int(mode))
        await station.passes(8.0)
        await answered(station.action.set_current_speed(0.4))
        async with station.stage("slower"):
            await station.passes(10.0)
        await answered(station.action.set_current_speed(1.2))
        await station.arrives(12.0, 9.0, within=2.0)
    await answered(station.action.hold())
    await station.receives("flight_mode", "holds", value=int(FlightMode.HOLD))
    async with station.stage("hold"):
        await station.passes(10.0)


async def home_again(station: Station) -> None:
    """Return to launch, after launch was moved ten metres from here."""
    north, east = station.here()
    north, east = north - 8.0, east + 6.0
    latitude, longitude = north_of(north, east)
    await answered(station.action.set_home(False, latitude, longitude, 0.0))
    await station.until(
        lambda: abs(station.last("home")["latitude_deg"] - latitude) < 2e-7, "home has moved"
    )
    async with station.stage("return"):
        await answered(station.action.return_to_launch())
        await station.receives("flight_mode", "returns", value=int(FlightMode.RETURN_TO_LAUNCH))
        await station.arrives(north, east, within=2.0)
    station.notes["return"] = [north, east]


async def offboard(station: Station, mode: FlightMode) -> None:
    """Steer by velocities, by an attitude, and to a position."""
    pilot = OffboardAsync(station.system)
    assert await refused(pilot.start()) == "NO_SETPOINT_SET"
    await answered(pilot.set_velocity_ned(VelocityNedYaw(0.4, 0.4, 0.0, 45.0)))
    await answered(pilot.start())
    await station.receives("flight_mode", "offboard", value=int(mode))
    assert await answered(pilot.is_active())
    await _for_a_while(station, "velocity north-east")
    await answered(pilot.set_velocity_body(VelocityBodyYawspeed(0.6, 0.0, 0.0, 0.0)))
    await _for_a_while(station, "velocity ahead")
    await answered(pilot.set_velocity_body(VelocityBodyYawspeed(0.5, 0.0, 0.0, 8.0)))
    await _for_a_while(station, "turn")
    await answered(pilot.set_attitude(Attitude(0.0, 0.0, -90.0, 0.5)))
    await _for_a_while(station, "attitude")
    north, east = station.here()
    north, east = north - 8.0, east + 6.0
    await answered(pilot.set_position_ned(PositionNedYaw(north, east, 0.0, 0.0)))
    async with station.stage("position"):
        await station.arrives(north, east, within=2.0)
    station.notes["position"] = [north, east]
    await answered(pilot.stop())
    assert not await answered(pilot.is_active())
    await station.receives("flight_mode", "holds", value=int(FlightMode.HOLD))


async def _for_a_while(station: Station, name: str) -> None:
    await station.passes(9.0)
    async with station.stage(name):
        await station.passes(5.0)


async def manual(station: Station, mode: int, y: float, z: float) -> None:
    """Take the helm: ahead and to starboard; then let go, which is a failsafe."""
    manual = ManualControlAsync(station.system)
    assert await station.command(DO_SET_MODE, CUSTOM_MODE, mode) == 0
    await station.receives("flight_mode", "manual", value=int(FlightMode.MANUAL))
    helm = asyncio.create_task(_hold(manual, y, z))
    async with station.stage("manual"):
        await station.passes(8.0)
    helm.cancel()
    await station.reads("Failsafe: manual control lost, hold")
    await station.receives("flight_mode", "holds", value=int(FlightMode.HOLD))


async def _hold(manual: ManualControlAsync, y: float, z: float) -> None:
    while True:
        await manual.set_manual_control_input(0.0, y, z, 0.0)
        await asyncio.sleep(0.05)


async def refusals(station: Station, refused_how: dict[str, str]) -> None:
    """Ask for what no boat does: the answer is no, and the vehicle stays as it is."""
    for name, how in refused_how.items():
        got = await refused(getattr(station.action, name)())
        assert got == how, f"{name}: {got}"
    await station.reads("No reboot: this vehicle is simulated; start the trial again")
    latitude, longitude = north_of(500.0)
    await refused(station.action.set_gps_global_origin(latitude, longitude, 0.0))
    origin = await answered(station.telemetry.get_gps_global_origin())
    assert station.notes["origin"] == [origin.latitude_deg, origin.longitude_deg, origin.altitude_m]


async def latency(station: Station) -> None:
    """Note wall times from a command to its answer, and of PING there and back, s."""

    async def ask(_: int) -> None:
        assert await station.command(REQUEST_MESSAGE, 148) == 0

    station.notes["command latency"] = [await _timed(ask, n) for n in range(PINGS)]
    answers: asyncio.Queue[int] = asyncio.Queue()

    async def listen() -> None:
        async for message in station.direct.subscribe_message("PING"):
            fields = json.loads(message.fields_json)
            if fields["target_system"] != 0:
                answers.put_nowait(int(fields["seq"]))

    async def ping(number: int) -> None:
        fields = {"time_usec": 0, "seq": number, "target_system": 0, "target_component": 0}
        message = MavlinkMessage("PING", 0, 0, 0, 0, json.dumps(fields))
        await station.direct.send_message(message)
        while await answered(answers.get()) != number:
            pass

    listener = asyncio.create_task(listen())
    await asyncio.sleep(0)
    station.notes["ping latency"] = [await _timed(ping, 1_000_000 + n) for n in range(PINGS)]
    listener.cancel()


async def _timed(call: Callable[[int], Awaitable[Any]], number: int) -> float:
    began = time.perf_counter()
    async with asyncio.timeout(ANSWER_S):
        await call(number)
    return time.perf_counter() - began
