"""Protocol of a Pro 4's topside: what it sends in each cycle, what it has understood.

Source: VideoRay, "PRO4 application layer": Cockpit looks for a vehicle with an empty request that
wants an acknowledgement, reads its configuration, then its whole memory, and then writes the
command block again and again, requesting reply 5.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any

from seatrial.errors import InputError

from . import registers as csr
from .frame import READ_BIT, ROV, Frame
from .identity import PRO4_ROV, read_config
from .node import MANIPULATOR
from .replies import ACKNOWLEDGE, NAVIGATION, read, read_memory

DETECT, CONFIGURE, READ, DRIVE = range(4)
PHASES = ("detect", "configure", "read", "drive")

_BLOCK = struct.Struct("<hhhBbbBBHH")
_ROV = bytes((PRO4_ROV,))


def _within(value: float, low: int, high: int) -> int:
    return min(max(round(value), low), high)


@dataclass
class Commands:
    """The pilot's commands, as the command block has them."""

    thrust: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Port, starboard, vertical as on the line, -1 to 1."""
    lights: float = 0.0
    """0 to 1."""
    camera_tilt: float = 0.0
    """Degrees."""
    camera_focus: float = 0.0
    """-1 to 1."""
    camera_control: int = 0
    camera_buttons: int = 0
    auto_depth: float | None = None
    """Pressure to hold, mbar."""
    auto_heading: float | None = None
    """Heading to hold, degrees."""

    def block(self) -> bytes:
        """Return the command block, 15 bytes; what is beyond its limits is set to them."""
        thrust = [_within(100.0 * x, -100, 100) for x in self.thrust]
        return _BLOCK.pack(
            *thrust,
            _within(100.0 * self.lights, 0, 100),
            _within(self.camera_tilt, -90, 90),
            _within(100.0 * self.camera_focus, -100, 100),
            self.camera_control & 0xFF,
            self.camera_buttons & 0xFF,
            csr.OFF if self.auto_depth is None else _within(self.auto_depth, 0, csr.OFF - 1),
            csr.OFF if self.auto_heading is None else round(self.auto_heading) % 360,
        )


NEUTRAL = Frame(False, ROV, 0, 0, Commands().block())
"""The request that stops the thrusters and wants no answer."""


@dataclass
class Station:
    """Topside, cycle by cycle: `request` is what to send, `receive` what came back.

    Without an answer for ``timeout_ns`` the vehicle is lost, and looked for again: until it has
    answered, nothing commands it. ``readings`` are the newest, by register in its unit.
    """

    timeout_ns: int
    node_id: int = ROV
    phase: int = DETECT
    readings: dict[str, float] = field(default_factory=dict)
    serial_number: str = ""
    boards: dict[str, str] = field(default_factory=dict)
    cycles: int = 0
    missed: int = 0
    """Cycles whose answer had not come when the next began."""
    round_trip_ns: int = 0
    """From the first byte of the last request that was answered to the end of its answer."""
    _requested_ns: int = -1
    _answered_ns: int = -1
    _waiting: bool = False

    @property
    def connected(self) -> bool:
        """Whether a vehicle answers, and is driven."""
        return self.phase == DRIVE

    def request(self, now_ns: int, commands: Commands) -> Frame:
        """Return the request of the cycle that begins now."""
        self.cycles += 1
        if self._waiting:
            self.missed += 1
            if self.phase != DETECT and now_ns - self._answered_ns >= self.timeout_ns:
                self.phase = DETECT
        self._requested_ns, self._waiting = now_ns, True
        if self.phase == DETECT:
            return Frame(False, self.node_id, ACKNOWLEDGE, 0)
        if self.phase == CONFIGURE:
            return Frame(False, self.node_id, READ_BIT, csr.CONFIG)
        if self.phase == READ:
            return Frame(False, self.node_id, READ_BIT, 0)
        return Frame(False, self.node_id, NAVIGATION, 0, commands.block())

    def receive(self, now_ns: int, frame: Frame) -> bool:
        """Take in an answer; return whether it is the one that was waited for."""
        if not frame.is_response or frame.id != self.node_id or frame.payload[:1] != _ROV:
            return False
        if not self._understand(frame.flags, frame.address, frame.payload[1:]):
            return False
        if self._waiting:
            self.round_trip_ns = now_ns - self._requested_ns
        self._waiting, self._answered_ns = False, now_ns
        return True

    def saved(self) -> dict[str, Any]:
        """Return its state as plain data."""
        return dict(vars(self))

    def restore(self, saved: dict[str, Any]) -> None:
        """Restore what `saved` returned."""
        vars(self).update(saved)

    def _understand(self, flags: int, address: int, data: bytes) -> bool:
        if flags != READ_BIT:
            reading = read(flags, data)
            if reading is None or (self.phase == DETECT) != (flags == ACKNOWLEDGE):
                return False
            self.readings = {**self.readings, **reading.values}
            if self.phase == DETECT:
                self.phase = CONFIGURE
            return True
        if address == csr.CONFIG and self.phase == CONFIGURE:
            try:
                self.serial_number, self.boards = read_config(data)
            except InputError:
                return False
            self.phase = READ
            return True
        if address == 0 and len(data) == csr.TOP and self.phase == READ:
            self.readings = read_memory(0, data).values
            self.phase = DRIVE
            return True
        return False


def manipulator_request(direction: int) -> Frame:
    """Return the request to the manipulator: 1 opens, -1 closes, 0 stops; it is not answered."""
    command = {1: 3, -1: 2, 0: 0}[direction]
    payload = b"\x35\x49" + bytes(4) + bytes((command, 0))
    return Frame(False, MANIPULATOR, 0, csr.CUSTOM_COMMAND, payload)
