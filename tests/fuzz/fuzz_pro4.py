"""Bytes to a VideoRay Pro 4: broken ones, and requests to its own id whose checks are right."""

from __future__ import annotations

from seatrial_kits.videoray import registers as csr
from seatrial_kits.videoray.command_decode import describe, describe_stream
from seatrial_kits.videoray.frame import PRO4, ROV, VRCSR, Frame, encode
from seatrial_kits.videoray.identity import Identity
from seatrial_kits.videoray.node import RovNode
from seatrial_kits.videoray.parser import Parser
from seatrial_kits.videoray.stream_file import Piece

_IDENTITY = Identity(
    "123456",
    ("cpu", "power", "pressure", "camera_io", "camera", "lights", "h", "v"),
    (1, 2, 3),
)


def one(data: bytes) -> None:
    """Take the bytes as they come, then as the contents of frames."""
    parser = Parser(50_000_000, (PRO4, VRCSR))
    frames = [frame for _, frame in parser.feed(data, 0, 1000)]
    frames += [frame for _, frame in parser.expire(10**9)]
    used = sum(6 + len(frame.payload) for frame in frames)
    assert parser.skipped + used <= len(data)
    assert parser.frames == len(frames)
    for line in describe_stream([Piece(0, ">", data), Piece(10**9, "<", data)]):
        assert line.isprintable()
    node = RovNode(_IDENTITY, bytearray(csr.TOP))
    for frame in [*frames, *_requests(data)]:
        assert describe(frame)
        answer = node.handle(frame)
        if answer is not None:
            sent = encode(answer)
            assert [got for _, got in Parser(10**9).feed(sent, 0)] == [answer]
    assert len(node.memory) == csr.TOP
    assert 0 < node.node_id < 0x80
    assert isinstance(node.saved(), dict)


def _requests(data: bytes) -> list[Frame]:
    """Return requests to the node itself: flags, address, length and payload are the fuzzer's."""
    found, place = [], 0
    while len(data) - place >= 3:
        flags, address, length = data[place : place + 3]
        payload = data[place + 3 : place + 3 + length]
        found.append(Frame(False, ROV, flags, address, payload))
        place += 3 + length
    return found
