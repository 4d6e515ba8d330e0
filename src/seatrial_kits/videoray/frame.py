"""Frames of VideoRay's CSR protocols: PRO4 and VRCSR.

Source: VideoRay, "CSR Communication Protocol" 2.11, https://github.com/videoray/VRCommsProtocol_doc.

    sync (2)  id  flags  address  length | check | payload | check
    ... length 0xFF | check | length (2, lowest first) | check | payload | check

Requests and responses differ in ``sync`` alone. ``check`` is in PRO4 the XOR of the bytes before
it since the last one, in 1 byte; in VRCSR their CRC-32 (zlib's), in 4, lowest first. PRO4's last
one is that of the whole frame too: up to there each part and its check cancel out.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass

from seatrial.errors import InputError

EXTENDED = 0xFF
"""Length that marks that two bytes with the length follow."""
LONGEST_PAYLOAD = 0xFFFF
HEADER = 6
"""Bytes before the header's check."""

ROV = 1
"""Node id of the ROV."""
BROADCAST = 0xFF
GROUP_BIT = 0x80
"""In an id: a group's, which never answers."""
RELAY_BIT = 0x40
"""In an id: to be passed on to what hangs on the node."""
READ_BIT = 0x80
"""In flags: a read; the other bits are the number of bytes, 0 for all up to 0xEF."""


@dataclass(frozen=True)
class Frame:
    """One request or response; ``payload`` of a response begins with the type of device."""

    is_response: bool
    id: int
    flags: int
    address: int
    payload: bytes = b""


def _xor(data: bytes) -> bytes:
    folded, size = int.from_bytes(data, "little"), len(data)
    while size > 1:  # in halves: ten times as fast as byte by byte
        half = (size + 1) // 2
        folded = (folded >> 8 * half) ^ (folded & ((1 << 8 * half) - 1))
        size = half
    return bytes((folded,))


def _crc32(data: bytes) -> bytes:
    return zlib.crc32(data).to_bytes(4, "little")


@dataclass(frozen=True)
class Dialect:
    """Differences between the protocols."""

    name: str
    request: bytes
    """Sync of a request."""
    response: bytes
    check: Callable[[bytes], bytes]
    check_length: int


PRO4 = Dialect("PRO4", b"\xfa\xaf", b"\xfd\xdf", _xor, 1)
VRCSR = Dialect("VRCSR", b"\xf5\x5f", b"\xf0\x0f", _crc32, 4)


def encode(frame: Frame, dialect: Dialect = PRO4) -> bytes:
    """Return a frame's bytes; lengths from 255 on are extended.

    Raises InputError for a byte or a length that cannot be.
    """
    for name in ("id", "flags", "address"):
        value = getattr(frame, name)
        if not 0 <= value <= 0xFF:
            raise InputError(f"{name} of a {dialect.name} frame is {value}, allowed 0 to 255")
    length = len(frame.payload)
    if length > LONGEST_PAYLOAD:
        raise InputError(f"a {dialect.name} frame has {length} bytes, allowed 0 to 65535")
    sync = dialect.response if frame.is_response else dialect.request
    header = sync + bytes((frame.id, frame.flags, frame.address, min(length, EXTENDED)))
    parts = [header]
    if length >= EXTENDED:
        parts.append(length.to_bytes(2, "little"))
    parts.append(frame.payload)
    return b"".join(part + dialect.check(part) for part in parts)
