"""A ground station made of the real MAVSDK, that writes down all that it hears."""

from __future__ import annotations

import asyncio
import json
import math
import time
from collections import defaultdict
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from enum import IntEnum
from functools import partial
from typing import Any, TypeVar

from mavsdk.asyncio import Mavsdk
from mavsdk.asyncio.plugins.action.action import ActionAsync
from mavsdk.asyncio.plugins.mavlink_direct.mavlink_direct import MavlinkDirectAsync
from mavsdk.asyncio.plugins.telemetry.telemetry import TelemetryAsync
from mavsdk.component_type import ComponentType
from mavsdk.exceptions import MavsdkError
from mavsdk.mavsdk import Configuration
from mavsdk.plugins.mavlink_direct.mavlink_direct import MavlinkMessage
from mavsdk.plugins.telemetry.telemetry import Telemetry

ANSWER_S = 30.0
"""Wall time for what is answered at once; MAVSDK itself gives up after seconds."""
MANOEUVRE_S = 120.0
"""Wall time for what a vessel needs a minute of simulated time for."""

T = TypeVar("T")


def flat(value: Any, prefix: str = "") -> dict[str, Any]:
    """Return the fields of a MAVSDK object as numbers and texts, nested ones with points."""
    if isinstance(value, list):
        return {}
    if not hasattr(value, "__dict__") or isinstance(value, IntEnum):
        name = prefix.rstrip(".") or "value"
        return {name: int(value) if isinstance(value, IntEnum) else value}
    return {
        name: x
        for field, inner in vars(value).items()
        for name, x in flat(inner, f"{prefix}{field}.").items()
    }


class Station:
    """MAVSDK connected to one vehicle, and every telemetry stream that it has.

    ``samples`` has, by stream, each value with the simulated time of the newest attitude before
    it: MAVSDK hands messages on in the order in which they come, and most have no time of theirs.
    """

    def __init__(self, system: Any, number: int) -> None:
        self.system, self.number = system, number
        self.telemetry, self.action = TelemetryAsync(system), ActionAsync(system)
        self.direct = MavlinkDirectAsync(system)
        self.samples: dict[str, list[tuple[float, dict[str, Any]]]] = defaultdict(list)
        self.marks: dict[str, list[float]] = {}
        """Simulated time at which a stage began and ended, s."""
        self.notes: dict[str, Any] = {}
        """What else the reference tool must know."""
        self.clock = 0.0
        self._handles: dict[str, Any] = {}
        # The callbacks, not the generators: these have a queue each, which loses the order.
        self._received = Telemetry(system._system)

    # ------------------------------------------------------------------ listening

    def listen(self) -> None:
        """Subscribe to all streams."""
        for method in dir(self._received):
            stream = method.removeprefix("subscribe_")
            if stream != method:
                callback = partial(self._keep, stream)
                self._handles[stream] = getattr(self._received, method)(callback)

    def ignore_all_but(self, *streams: str) -> None:
        """End the other subscriptions."""
        for stream in set(self._handles) - set(streams):
            getattr(self._received, f"unsubscribe_{stream}")(self._handles.pop(stream))

    def _keep(self, stream: str, value: Any, _: Any) -> None:
        if stream == "attitude_euler":
            self.clock = value.timestamp_us * 1e-6
        self.samples[stream].append((self.clock, flat(value)))

    def last(self, stream: str) -> dict[str, Any]:
        """Return the newest value of a stream."""
        return self.samples[stream][-1][1]

    @property
    def texts(self) -> list[str]:
        """All status texts so far."""
        return [value["text"] for _, value in self.samples["status_text"]]

    # ------------------------------------------------------------------ waiting

    async def until(
        self, condition: Callable[[], bool], what: str, deadline: float = ANSWER_S
    ) -> None:
        """Wait until a condition holds; fail after the deadline, s of wall time."""
        end = time.monotonic() + deadline
        while not condition():
            assert time.monotonic() < end, f"{what}: not within {deadline:g} s"
            await asyncio.sleep(0.02)

    async def hears(self, stream: str, what: str, **wanted: Any) -> None:
        """Wait until the newest value of a stream has these fields."""

        def said() -> bool:
            received = self.samples[stream]
            return bool(received) and wanted.items() <= received[-1][1].items()

        await self.until(said, f"{what}: {stream} {wanted}")

    async def reads(self, text: str) -> None:
        """Wait for a status text that contains ``text``."""
        await self.until(lambda: any(text in each for each in self.texts), f"{text!r} is said")

    async def passes(self, seconds: float) -> None:
        """Let simulated time pass."""
        end = self.clock + seconds
        await self.until(lambda: self.clock >= end, f"{seconds:g} s pass", MANOEUVRE_S)

    async def arrives(self, north: float, east: float, within: float = 3.0) -> None:
        """Wait until the vehicle is at a place, m from the origin."""
        await self.until(
            lambda: self.distance(north, east) <= within, f"at {north}, {east}", MANOEUVRE_S
        )

    def distance(self, north: float, east: float) -> float:
        """Return how far the vehicle is from a place, m."""
        here = self.here()
        return math.hypot(here[0] - north, here[1] - east)

    def here(self) -> tuple[float, float]:
        """Return where the vehicle says it is, m north and east of the origin."""
        values = self.last("position_velocity_ned")
        return values["position.north_m"], values["position.east_m"]

    # ------------------------------------------------------------------ commands

    async def command(self, number: int, *parameters: float) -> int:
        """Send a COMMAND_LONG that MAVSDK has no function for; return MAV_RESULT."""
        fields = {"target_system": self.number, "target_component": 1, "command": number}
        fields |= {f"param{n}": p for n, p in enumerate(parameters, 1)}
        message = MavlinkMessage("COMMAND_LONG", 0, 0, self.number, 1, json.dumps(fields))
        ack = await answered(self.direct.send_command(message))
        return int(json.loads(ack.fields_json)["result"])

    @asynccontextmanager
    async def stage(self, name: str) -> AsyncIterator[None]:
        """Note when a part of the flight begins and ends."""
        began, wall = self.clock, time.monotonic()
        print(f"{name} at {began:.1f} s", flush=True)
        yield
        self.marks[name] = [began, self.clock]
        took = time.monotonic() - wall
        print(f"{name} done at {self.clock:.1f} s, took {took:.1f} s of wall time", flush=True)


async def answered(call: Awaitable[T], deadline: float = ANSWER_S) -> T:
    """Return what MAVSDK answers, before the deadline, s of wall time."""
    async with asyncio.timeout(deadline):
        return await call


async def refused(call: Awaitable[Any]) -> str:
    """Return the name of the result with which MAVSDK fails, which it must."""
    try:
        got = await answered(call)
    except MavsdkError as error:
        return str(error.args[0].name)
    raise AssertionError(f"accepted: {got}")


@asynccontextmanager
async def connected(url: str) -> AsyncIterator[Station]:
    """Connect to the first vehicle at ``url``, and listen to all that it says."""
    kind = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(kind) as mavsdk:
        await mavsdk.add_any_connection(url)
        system = await mavsdk.first_autopilot(timeout_s=60.0)
        assert system is not None, "no vehicle within 60 s"
        station = Station(system, await system.get_system_id())
        station.listen()
        yield station
        station.ignore_all_but()
