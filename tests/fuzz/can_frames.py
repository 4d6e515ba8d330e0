"""Frames on a CAN bus as the bytes of a fuzzer say."""

from __future__ import annotations

from typing import Any

from seatrial.links.text import Outbox
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.operations import Transmit, encode


def frames_of(data: bytes) -> list[Frame]:
    """Return extended frames of up to 8 bytes: four bytes of identifier, one of length, data."""
    found, place = [], 0
    while len(data) - place >= 5:
        identifier = int.from_bytes(data[place : place + 4], "big") & 0x1FFFFFFF
        length = data[place + 4] % 9
        found.append(Frame(identifier, data[place + 5 : place + 5 + length], extended=True))
        place += 5 + length
    return found


def receive(node: Any, frames: list[Frame], steps: int = 3) -> None:
    """Start a node on a bus that has the frames for it in its second step, and go on."""
    node.setup(0.0)
    node.initialise()
    node.begin()
    bus: dict[str, Any] = {}
    for step in range(steps):
        outbox = Outbox(bus)
        for frame in frames if step == 1 else []:
            outbox.put(step * 10_000_000, encode(Transmit(frame)))
        node.set("rx", outbox.flush())
        node.advance(step * 0.01, 0.01)
        assert isinstance(node.get("tx"), str)
