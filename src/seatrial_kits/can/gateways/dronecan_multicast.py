"""DroneCAN's own CAN bus over UDP multicast, as ArduPilot's simulator has it too.

One frame is one datagram to group 239.65.82.BUS, port 57732, little endian: magic 0x2934, 16 bits
of CRC-16-CCITT over the rest, 16 bits of flags (1: CAN FD), 32 bits of identifier (bit 31: 29 bits
of it), data. Source: `dronecan` 1.0.27, driver/mcast.py.
"""

from __future__ import annotations

import binascii
import contextlib
import socket
import struct
import sys

from seatrial.errors import InputError
from seatrial.links.endpoints.budget import MOST, Budget
from seatrial.links.safe_state import Held, hold

from ..frame import Frame
from ..safe_state import frames_of
from .gateway import FRAME_BYTES, LEAST, RATE, Gateway

GROUP, PORT = "239.65.82.{}", 57732
MAGIC = 0x2934
LOOPBACK = "127.0.0.1"

MOST_SENDERS = 128
"""Senders that are known, as many as a bus has nodes; a new one takes the place of the one silent
longest, of which nothing but its share of the next poll is lost."""

_HEAD, _BODY = struct.Struct("<HH"), struct.Struct("<HI")
_FD, _EXTENDED = 1, 1 << 31
_REMOTE, _ERROR = 1 << 30, 1 << 29
_LONGEST = 2 * 64
_MULTICAST_ALL = 49
"""Linux's IP_MULTICAST_ALL, which Python's module has no name for."""


def packed(frame: Frame) -> bytes | None:
    """Return a frame as a datagram, None for a remote frame: the protocol has none."""
    if frame.remote:
        return None
    identifier = frame.identifier | (_EXTENDED if frame.extended else 0)
    body = _BODY.pack(_FD if frame.fd else 0, identifier) + frame.data
    return _HEAD.pack(MAGIC, binascii.crc_hqx(body, 0xFFFF)) + body


def unpacked(datagram: bytes) -> Frame | None:
    """Return the frame of a datagram, None if it is none."""
    if len(datagram) < _HEAD.size + _BODY.size:
        return None
    magic, crc = _HEAD.unpack_from(datagram)
    body = datagram[_HEAD.size :]
    flags, identifier = _BODY.unpack_from(body)
    if (magic, crc) != (MAGIC, binascii.crc_hqx(body, 0xFFFF)) or identifier & (_REMOTE | _ERROR):
        return None
    try:
        return Frame(
            identifier & ~_EXTENDED,
            body[_BODY.size :],
            bool(identifier & _EXTENDED),
            fd=bool(flags & _FD),
        )
    except InputError:
        return None


class DroneCanMulticastGateway(Gateway):
    """A bus of this machine's programs, which receive each other without it.

    It joins and sends on the loopback interface alone. Programs that leave the choice to the
    system are there too if the route of the group leads there.

    Raises OSError for a bus that cannot be joined.
    """

    def __init__(self, bus: int) -> None:
        self._group = GROUP.format(bus)
        self.reached_at = f"mcast:{bus}"
        self._senders: dict[tuple[str, int], int] = {}
        """Their numbers, which are never used again; the last one is the one received last."""
        self._next = 0
        self.budget = Budget(RATE, LEAST)
        self._held: list[Held] = []
        self._receiving, self._sending = _socket(), _socket()
        try:
            self._receiving.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            # Bound to the group, a socket receives nothing else; Windows cannot.
            self._receiving.bind((LOOPBACK if sys.platform == "win32" else self._group, PORT))
            member = socket.inet_aton(self._group) + socket.inet_aton(LOOPBACK)
            self._receiving.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
            if sys.platform == "linux":
                # Else it receives from every interface on which any program has joined the group.
                self._receiving.setsockopt(socket.IPPROTO_IP, _MULTICAST_ALL, 0)
            interface = socket.inet_aton(LOOPBACK)
            self._sending.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
            self._sending.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            self._sending.bind((LOOPBACK, 0))
        except OSError:
            self.close()
            raise

    @property
    def clients(self) -> int:
        """Return how many have sent something, the latest `MOST_SENDERS` at most."""
        return len(self._senders)

    def poll(self) -> list[tuple[int, Frame]]:
        """Return frames that have arrived, with their senders; other datagrams are counted."""
        found: list[tuple[int, Frame]] = []
        own = self._sending.getsockname()
        self.budget.renew(self._senders)
        for _ in range(MOST // FRAME_BYTES):
            try:
                datagram, sender = self._receiving.recvfrom(_LONGEST)
            except OSError:
                break
            if sender == own:
                continue
            frame = unpacked(datagram)
            self.refused += frame is None
            if frame is not None and self.budget.take(sender, FRAME_BYTES):
                found.append((self._number(sender), frame))
        return found

    def send(self, time_ns: int, frame: Frame, sender: int | None = None) -> None:
        """Send a frame, unless it came from there."""
        datagram = packed(frame)
        if sender is None and datagram is not None:
            with contextlib.suppress(OSError):  # a datagram may be lost
                self._sending.sendto(datagram, (self._group, PORT))

    def keep(self, name: str, frames: str) -> None:
        """Hold a datagram for each frame that this bus has."""
        if not self._held:
            target = (self._group, PORT)
            for datagram in filter(None, map(packed, frames_of(frames))):
                held = hold(name, self.reached_at, self._sending.fileno(), datagram, target)
                self._held.append(held)

    def close(self) -> None:
        """Leave the bus."""
        for held in self._held:
            held.release()
        self._receiving.close()
        self._sending.close()

    def _number(self, sender: tuple[str, int]) -> int:
        number = self._senders.pop(sender, self._next)
        self._next += number == self._next
        if len(self._senders) >= MOST_SENDERS:
            del self._senders[next(iter(self._senders))]
        self._senders[sender] = number
        return number


def _socket() -> socket.socket:
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    opened.setblocking(False)
    return opened
