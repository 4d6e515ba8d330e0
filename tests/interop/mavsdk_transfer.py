"""MAVSDK, all parameters and a long mission both ways: ``... URL ITEMS``, prints them as JSON."""

from __future__ import annotations

import asyncio
import json
import sys

from mavsdk.asyncio.plugins.mission_raw.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.param.param import ParamAsync
from mavsdk.exceptions import MavsdkError
from mavsdk.plugins.mission_raw.mission_raw import MissionItem

from .mavsdk_station import answered, connected

TRANSFER_S = 240.0
TRIES = 5
"""How often a person would ask: a list ends after a few messages that got lost in a row."""


async def insisted(call, what):
    """Return what MAVSDK answers in one of some tries."""
    for number in range(1, TRIES + 1):
        try:
            return await answered(call(), TRANSFER_S)
        except MavsdkError as error:
            print(f"{what}: {error.args[0].name}", file=sys.stderr)
            if number == TRIES:
                raise
    return None


async def transfer(url: str, places: list[list[int]]) -> dict:
    async with connected(url) as station:
        station.ignore_all_but()
        every = await insisted(ParamAsync(station.system).get_all_params, "parameters")
        missions = MissionRawAsync(station.system)
        items = [
            MissionItem(n, 3, 16, int(n == 0), 1, 0.0, 0.0, 0.0, 0.0, x, y, 0.0, 0)
            for n, (x, y) in enumerate(places)
        ]
        await insisted(lambda: missions.upload_mission(items), "upload")
        back = await insisted(missions.download_mission, "download")
        values = {each.name: each.value for each in [*every.int_params, *every.float_params]}
        return {"parameters": values, "places": [[each.x, each.y] for each in back]}


if __name__ == "__main__":
    print(json.dumps(asyncio.run(transfer(sys.argv[1], json.loads(sys.argv[2])))))
