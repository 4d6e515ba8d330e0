"""Answers of the component against those recorded of ArduPilot's firmware.

Each difference has a row in docs/kits/mavlink/mavlink-conformance.md, and each row has a difference.
"""

from __future__ import annotations

import json
import math
from fnmatch import fnmatchcase
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.transport import Sender
from tests.interop.ardupilot_answers import REFERENCE, STATION, Dialogue, requests

from .bench import Bench

PAGE = Path(__file__).parents[3] / "docs/kits/mavlink/mavlink-conformance.md"
STEP_S, SPEED = 0.1, 3.0


class BenchVehicle:
    """The component's node on the bench; the vehicle goes where its mission leads it."""

    def __init__(self, firmware, log):
        self.bench = Bench(submerged=firmware == "sub", log=lambda: log)
        self.system = self.bench.vehicle.identity.system
        self.bench.transport.there = [0]
        for number in {n for one in self.bench.node.services for n in one.streams}:
            self.bench.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number, -1)
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
            self._go()
        return bench.transport.take()

    def _go(self):
        missions, here = self.bench.node.missions, self.bench.vehicle.estimates.position_n
        way = [end - at for end, at in zip(missions.leg.end, here, strict=True)]
        if missions.leg.number:
            share = min(1.0, SPEED * STEP_S / (math.hypot(*way) or 1.0))
            at = tuple(x + share * step for x, step in zip(here, way, strict=True))
            self.bench.measure(position_n=at)
            if math.dist(at, missions.leg.end) <= missions.leg.radius:
                missions.reached = missions.leg.number


def aspects(answer):
    """Return what is compared: items read back, other answers, the state."""
    came = sorted(set(answer["answers"]))  # which comes first is of no matter, nor twice
    items = [text for text in came if text.startswith("MISSION_ITEM_INT")]
    others = [text for text in came if text not in items]
    return {"answers": others, "items": items, "state": answer["state"]}


def rows(firmware):
    """Return the rows of the page that are about a firmware: pattern of requests, aspect."""
    lines = PAGE.read_text("utf-8").splitlines()
    cells = [
        [c.strip().strip("`") for c in line.split("|")[1:4]] for line in lines if line[:3] == "| `"
    ]
    return [(pattern, aspect) for pattern, of, aspect in cells if of in ("both", firmware)]


@pytest.mark.slow
@pytest.mark.parametrize("firmware", ["rover", "sub"])
def test_answers_are_the_firmwares_or_the_page_says_why(firmware, tmp_path):
    recorded = json.loads((REFERENCE / f"ardupilot_answers_{firmware}.json").read_text("utf-8"))
    log = tmp_path / "run.tlog"
    log.write_bytes(bytes(1000))
    dialogue = Dialogue(BenchVehicle(firmware, log), firmware)
    dialogue.quiet()
    listed, used, unexplained = rows(firmware), set(), []
    for request in requests(firmware):
        name = request["name"]
        found, wanted = aspects(dialogue.ask(request)), aspects(recorded[name])
        for aspect in found:
            if found[aspect] == wanted[aspect]:
                continue
            row = next((r for r in listed if fnmatchcase(name, r[0]) and r[1] == aspect), None)
            used.add(row)
            if row is None:
                text = f"{name} ({aspect}): {found[aspect]}, the firmware: {wanted[aspect]}"
                unexplained.append(text)
    assert not unexplained, "\n".join([f"{len(unexplained)} differences", *unexplained])
    assert not set(listed) - used
