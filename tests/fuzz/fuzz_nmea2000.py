"""Frames on an NMEA 2000 bus: single ones, fast packets, and what a helm takes of them."""

from __future__ import annotations

import math
from typing import Any

from seatrial_kits.nmea.nmea2000.codec import Decoder
from seatrial_kits.nmea.nmea2000.component import Nmea2000
from seatrial_kits.nmea.nmea2000.quantities import READERS
from seatrial_kits.nmea.received.memory import Received

from .can_frames import frames_of, receive


def one(data: bytes) -> None:
    """Decode the frames; what is received are finite numbers. Then let a node have them."""
    unfinished: dict[str, dict[str, list[list[Any]]]] = {}
    decoder, received = Decoder(unfinished), Received({}, 10**9)
    for when, frame in enumerate(frames_of(data)):
        message = decoder.decode(frame)
        if message is not None and message.pgn in READERS:
            values = READERS[message.pgn](message.fields)
            received.take(when, str(message.source), str(message.pgn), values)
    for name in received.names():
        values, _ = received.get(name, 0)
        assert all(map(math.isfinite, values or []))
    kept = [frames for packets in unfinished.values() for frames in packets.values()]
    assert sum(map(len, kept)) <= len(data)
    Decoder(unfinished)
    receive(Nmea2000("node"), frames_of(data))
