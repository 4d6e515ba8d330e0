"""VRCSR's M5 thrusters: their memory, the propulsion command, their standard response.

Source: VideoRay, CSR.h, custom_command.h, specific_response.h and thruster.py of
https://github.com/videoray/Thruster. Floats are IEEE 754, 4 bytes, lowest first.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.errors import InputError

from .frame import BROADCAST, GROUP_BIT, READ_BIT, Frame

M5_THRUSTER = 0x81
"""Type of device."""
GROUP = 1
"""Group of thrusters: multicast id 0x81."""
CUSTOM_COMMAND = 0xF0
PROPULSION = 0xAA
ACKNOWLEDGE, STANDARD = 1, 2
"""Device specific responses: none but the type of device; rpm, V, A, degrees C, fault."""

_STANDARD = struct.Struct("<ffffB")
_SIZE = 0x100
_TOP = 0xF0
_POWER_TARGET, _RPM, _BUS_V, _BUS_I, _FAULT, _TEMP, _POWER = 0x04, 8, 0x0C, 0x10, 0x14, 0x18, 0x1C
_MOTOR_ID, _FAULT_INTERLOCK = 0x4C, 0x54
_NODE_ID, _GROUP_ID = 0xFC, 0xFD
_WRITABLE = ((0x00, 0x08), (_MOTOR_ID, 0x4E), (0x54, 0x58), (0x60, 0xA9), (0xEE, 0xF0))


@dataclass(frozen=True)
class Health:
    """Telemetry of a thruster: rpm, V, A, degrees C and fault bits."""

    rpm: float
    voltage: float
    current: float
    temperature: float
    fault: int


def propulsion_request(
    powers: Sequence[float], reply_node: int, group: int = GROUP, flags: int = STANDARD
) -> Frame:
    """Return the command to a group: powers, -1 to 1, by motor id; one node is to answer."""
    data = struct.pack(f"<{len(powers)}f", *(min(max(p, -1.0), 1.0) for p in powers))
    payload = bytes((PROPULSION, reply_node)) + data
    return Frame(False, GROUP_BIT | group, flags, CUSTOM_COMMAND, payload)


def read_health(response: Frame) -> Health | None:
    """Return the content of a standard response; None if it is none."""
    payload = response.payload
    if not response.is_response or response.flags != STANDARD:
        return None
    if len(payload) != 1 + _STANDARD.size or payload[0] != M5_THRUSTER:
        return None
    return Health(*_STANDARD.unpack(payload[1:]))


class ThrusterNode:
    """One M5 thruster as a node: `handle` takes a request and returns its answer, if it has one.

    A propulsion command, which is a group's or all's, sets the power of the motor id's place in
    its list, and is answered by the node that it names alone, as its flags say. Requests to its
    own id write and read its memory as with the Pro 4 (`RovNode`); the node id and group id
    are at 0xFC and 0xFD. ``requested``: a power was set since this was last read.
    """

    def __init__(self, node_id: int, motor_id: int) -> None:
        if not 1 <= node_id < GROUP_BIT:
            raise InputError(f"node id {node_id} is not from 1 to 127")
        self.memory = bytearray(_SIZE)
        self.memory[_NODE_ID], self.memory[_GROUP_ID] = node_id, GROUP
        struct.pack_into("<H", self.memory, _MOTOR_ID, motor_id)
        self.requested = False

    @property
    def node_id(self) -> int:
        """Its node id."""
        return self.memory[_NODE_ID]

    @property
    def power(self) -> float:
        """The power commanded, -1 to 1; 0 for what is no number."""
        power = float(struct.unpack_from("<f", self.memory, _POWER_TARGET)[0])
        return min(max(power, -1.0), 1.0) if power == power else 0.0

    def report(self, health: Health, power: float) -> None:
        """Enter what it measures."""
        memory = self.memory
        struct.pack_into("<fff", memory, _RPM, health.rpm, health.voltage, health.current)
        struct.pack_into("<If", memory, _FAULT, health.fault, health.temperature)
        struct.pack_into("<f", memory, _POWER, power)

    def handle(self, request: Frame) -> Frame | None:
        """Carry out a request and return the answer; None if there is none."""
        addressed = (self.node_id, GROUP_BIT | self.memory[_GROUP_ID], BROADCAST)
        if request.is_response or request.id not in addressed:
            return None
        if request.address == CUSTOM_COMMAND:
            return self._propel(request)
        self._write(request.address, request.payload)
        return None if request.id & GROUP_BIT else self._answer(request)

    def _propel(self, request: Frame) -> Frame | None:
        data = request.payload
        if len(data) < 2 or data[0] != PROPULSION or (len(data) - 2) % 4:
            return None
        motor = struct.unpack_from("<H", self.memory, _MOTOR_ID)[0]
        place = 2 + 4 * motor
        if place + 4 <= len(data):
            self.memory[_POWER_TARGET : _POWER_TARGET + 4] = data[place : place + 4]
            self.requested = True
        return self._answer(request) if data[1] == self.node_id else None

    def _write(self, address: int, data: bytes) -> None:
        if address in (_NODE_ID, _GROUP_ID):
            highest = GROUP_BIT if address == _NODE_ID else BROADCAST - GROUP_BIT
            if data and 1 <= data[0] < highest:
                self.memory[address] = data[0]
            return
        for place, byte in enumerate(data[: max(_TOP - address, 0)], address):
            if any(low <= place < high for low, high in _WRITABLE):
                self.memory[place] = byte
                self.requested |= _POWER_TARGET <= place < _RPM

    def _answer(self, request: Frame) -> Frame | None:
        device, flags = bytes((M5_THRUSTER,)), request.flags
        if flags & READ_BIT:
            count = flags & ~READ_BIT or max(_TOP - request.address, 0)
            data = bytes(self.memory[request.address : request.address + count])
            return Frame(True, self.node_id, READ_BIT, request.address, device + data)
        if flags == ACKNOWLEDGE:
            return Frame(True, self.node_id, flags, 0, device)
        if flags == STANDARD:
            memory = self.memory
            rpm, volt, ampere = struct.unpack_from("<fff", memory, _RPM)
            temperature = struct.unpack_from("<f", memory, _TEMP)[0]
            fault = memory[_FAULT]
            own = _STANDARD.pack(rpm, volt, ampere, temperature, fault)
            return Frame(True, self.node_id, flags, 0, device + own)
        return None
