"""Uploads: the component's results against those recorded of ArduPilot Rover.

Each difference has a row in docs/links/mavlink-conformance.md, and each row has a difference.
"""

from __future__ import annotations

import json
from fnmatch import fnmatchcase
from pathlib import Path

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.mavlink.transport import Sender
from tests.interop.ardupilot_answers import REFERENCE, STATION, Dialogue, requests, shown

from .bench import Bench

PAGE = Path(__file__).parents[3] / "docs" / "links" / "mavlink-conformance.md"
STEP_S = 0.05


class BenchVehicle:
    """The component's node on the bench, as a vehicle that requests are put to."""

    def __init__(self) -> None:
        self.bench = Bench()
        self.system = self.bench.vehicle.identity.system
        self._reader, self._beat_at = mavlink.MAVLink(None), 0.0

    def send(self, message, sender):
        """Send it through the bytes of a frame, as a link would."""
        (sent,) = self._reader.parse_buffer(message.pack(mavlink.MAVLink(None, *sender)))
        self.bench.receive(sent, Sender(*sender, 0))

    def wait(self, seconds, *, beats=STATION):
        bench = self.bench
        until = bench.now + seconds
        while bench.now < until - 1e-9:
            if beats and bench.now - self._beat_at >= 0.8:
                self._beat_at = bench.now
                bench.heartbeat(Sender(*beats, 0))
            bench.ticks += round(STEP_S * 100) - 1
            bench.tick()
        return bench.transport.take()


def rows():
    """Return the patterns of the requests whose difference the page explains."""
    lines = PAGE.read_text("utf-8").splitlines()
    return [line.split("|")[1].strip().strip("`") for line in lines if line.startswith("| `")]


def test_uploads_end_as_with_a_rover_or_the_page_says_why() -> None:
    recorded = json.loads((REFERENCE / "ardupilot_answers_rover.json").read_text("utf-8"))
    asked = [r for r in requests("rover") if "upload" in r["do"][0] and r["name"] in recorded]
    listed, used, unexplained = rows(), set(), []
    dialogue = Dialogue(BenchVehicle(), "rover")
    for request in asked:
        first = request["do"][0]
        ended = [shown(m) for m in dialogue.upload(first["upload"], first["items"])]
        wanted = recorded[request["name"]]["answers"][:1]
        if ended == wanted:
            continue
        pattern = next((p for p in listed if fnmatchcase(request["name"], p)), None)
        used.add(pattern)
        if pattern is None:
            unexplained.append(f"{request['name']}: {ended}, of the firmware: {wanted}")
    assert not unexplained, "\n".join(unexplained)
    assert not set(listed) - used
    assert len(asked) > 300
