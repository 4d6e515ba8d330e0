"""Frames that stop what a bus moves, as a person writes them; and how a supervisor sends them."""

from __future__ import annotations

import re
from typing import Any

import can

from seatrial.errors import InputError

from .frame import Frame
from .messages import message

_FRAME = re.compile(
    r"(?P<identifier>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})"
    r"(?:#(?P<data>(?:[0-9A-Fa-f]{2}){0,8})|##(?P<flags>[01])(?P<fd>(?:[0-9A-Fa-f]{2}){0,64}))"
)


def frames_of(text: str) -> list[Frame]:
    """Return the frames of ``IDENTIFIER#DATA ...``, as candump and cansend write them.

    Three digits of identifier are 11 bits, eight are 29; ``##0`` and ``##1`` before the data make
    a frame of CAN FD, the latter with its own rate. Raises InputError.
    """
    found = []
    for each in text.split():
        match = _FRAME.fullmatch(each)
        if match is None:
            raise InputError(f"safe_state: {each!r} is no frame such as '09F10D17#FF00FF7F'")
        identifier, fd = match["identifier"], match["flags"] is not None
        try:
            found.append(
                Frame(
                    int(identifier, 16),
                    bytes.fromhex(match["fd"] if fd else match["data"]),
                    len(identifier) > 3,
                    fd=fd,
                    bit_rate_switch=match["flags"] == "1",
                )
            )
        except InputError as error:
            raise InputError(f"safe_state: {each!r}: {error}") from None
    return found


def send_to_bus(bus: dict[str, Any], frames: str) -> None:
    """Open a bus of python-can's, send frames, and leave it."""
    with can.Bus(**bus, ignore_config=True) as opened:
        for frame in frames_of(frames):
            opened.send(message(frame, 0.0), timeout=1.0)
