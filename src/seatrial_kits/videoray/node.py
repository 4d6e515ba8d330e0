"""The Pro 4 ROV as a node: its memory, what requests do to it, what it answers.

Sources: VideoRay, "CSR Communication Protocol" 2.11 (the definitions of PRO4), "PRO4 application
layer", and the order of things in its C sample: writes happen before the reply, custom commands
are never answered, what is for others is passed on if its id has the relay bit.
"""

from __future__ import annotations

from typing import Any

from . import registers as csr
from .frame import BROADCAST, GROUP_BIT, READ_BIT, RELAY_BIT, ROV, Frame
from .identity import CONFIG_LENGTH, PRO4_ROV, SERIAL_LENGTH, Identity
from .replies import payload

MANIPULATOR = 0x42
"""Node id of the manipulator on the accessory port: type of device 2, with the relay bit."""
MANIPULATOR_COMMANDS = {0: 0, 2: -1, 3: 1}
"""Command byte: 1 opens, -1 closes, 0 stops."""

_REBOOT = b"\xde\xad"
_MANIPULATOR_HEAD = b"\x35\x49"


class RovNode:
    """One node of the bus. `handle` takes a request and returns the answer, if there is one.

    **Ids**: it takes requests to its own id, its group's (0x80 + group) and to all (0xFF), and
    answers the first alone. Id 0 is no node's. Others with the relay bit (0x40) go to
    ``relayed``, whole; so do custom commands for the manipulator, which it knows itself.

    **Writes** are carried out before the answer. Below 0xF0 each byte goes where it belongs if
    that may be written, and is ignored otherwise; what goes beyond 0xEF is cut off. From 0xF0 on
    only the register that is addressed is written: custom command, node id (1 to 0x7F), group id
    (1 to 0x7E), both after each other, the serial number (16 bytes that match, then the new node
    id), the utility register (DE AD reboots). A new id holds from its answer on.

    **Reads** of n bytes, or of 0 for all up to 0xEF; from 0xF0 on 0 is the whole register:
    configuration (292 bytes), its size, version, ids, serial number. Reads end at 0xFF.

    **Stored**: the ids at once; of the memory what the map marks, at once or (``commits``) when
    the register `commit` is written. `reboot` goes back to what is stored.

    Unknown device specific replies are not answered.
    """

    def __init__(self, identity: Identity, memory: bytearray, *, commits: bool = False) -> None:
        self.identity = identity
        self._commits = commits
        self.memory = memory
        self._stored = bytes(memory)
        self.node_id = ROV
        self.group_id = 1
        self.wants_reboot = False
        self.was_commanded = False
        """Whether the command block was written since this was last read."""
        self.requests = 0
        """Requests to its own id, its group or all, since the start."""
        self.manipulator = 0
        self.relayed: list[Frame] = []
        self._utility = bytearray(2)

    def handle(self, request: Frame) -> Frame | None:
        """Carry out a request and return the answer; None if there is none."""
        if request.is_response:
            return None
        if request.id in (MANIPULATOR, BROADCAST):
            self._manipulate(request)
        if request.id not in (self.node_id, GROUP_BIT | self.group_id, BROADCAST):
            if request.id & RELAY_BIT:
                self.relayed.append(request)
            return None
        self.requests += 1
        if request.address == csr.CUSTOM_COMMAND:
            return None  # the ROV has none of its own
        if request.payload:
            self._write(request.address, request.payload)
        if request.id & GROUP_BIT or not request.flags:
            return None
        return self._answer(request)

    def reboot(self) -> None:
        """Forget all that is not stored."""
        for name in ("max_depth", "run_time"):
            self._keep(csr.BY_NAME[name])
        self.memory[:] = self._stored
        self._utility[:] = bytes(2)
        self.wants_reboot = self.was_commanded = False
        self.manipulator = 0

    def count_errors(self, errors: int) -> None:
        """Set how many errors of communication there were since the start; 65535 is the most."""
        register = csr.BY_NAME["communication_errors"]
        csr.put(self.memory, register.name, min(errors, register.highest))

    def measure(self, name: str, value: float) -> None:
        """Set what the vehicle measures, in the register's unit, within what it can hold."""
        csr.put(self.memory, name, csr.BY_NAME[name].clipped(value))

    def value(self, name: str) -> float:
        """Return a register's value in its unit."""
        return csr.value(self.memory, name)

    def saved(self) -> dict[str, Any]:
        """Return its state as plain data."""
        return {
            "memory": self.memory.hex(),
            "stored": self._stored.hex(),
            "utility": self._utility.hex(),
            "numbers": [self.node_id, self.group_id, self.manipulator, self.requests],
            "flags": [self.wants_reboot, self.was_commanded],
        }

    def restore(self, saved: dict[str, Any]) -> None:
        """Restore what `saved` returned."""
        self.memory[:] = bytes.fromhex(saved["memory"])
        self._stored = bytes.fromhex(saved["stored"])
        self._utility[:] = bytes.fromhex(saved["utility"])
        self.node_id, self.group_id, self.manipulator, self.requests = saved["numbers"]
        self.wants_reboot, self.was_commanded = saved["flags"]
        self.relayed.clear()

    # ------------------------------------------------------------------ writes

    def _write(self, address: int, data: bytes) -> None:
        if address < csr.TOP:
            self._write_memory(address, data)
        elif address == csr.NODE_ID:
            self._set_node_id(data[0])
            if len(data) > 1:
                self._set_group_id(data[1])
        elif address == csr.GROUP_ID:
            self._set_group_id(data[0])
        elif address == csr.SERIAL_NUMBER:
            if len(data) > SERIAL_LENGTH and data[:SERIAL_LENGTH] == self.identity.unique_id:
                self._set_node_id(data[SERIAL_LENGTH])
        elif address >= csr.UTILITY:
            place = address - csr.UTILITY
            own = data[: 2 - place]
            self._utility[place : place + len(own)] = own
            self.wants_reboot = self._utility == _REBOOT

    def _write_memory(self, address: int, data: bytes) -> None:
        for place, byte in enumerate(data[: csr.TOP - address], address):
            if csr.WRITABLE[place]:
                self.memory[place] = byte
        end = address + len(data)
        self.was_commanded |= address < csr.COMMAND_END
        commit = address < csr.COMMIT + 2 and end > csr.COMMIT
        if commit or not self._commits:
            stored = bytearray(self._stored)
            for place in csr.STORED:
                stored[place] = self.memory[place]
            self._stored = bytes(stored)
        if commit:
            csr.put(self.memory, "commit", 0)

    def _set_node_id(self, new: int) -> None:
        if 1 <= new < GROUP_BIT:
            self.node_id = new

    def _set_group_id(self, new: int) -> None:
        if 1 <= new < BROADCAST - GROUP_BIT:
            self.group_id = new

    def _manipulate(self, request: Frame) -> None:
        data = request.payload
        if (
            request.address == csr.CUSTOM_COMMAND
            and len(data) == 8
            and data.startswith(_MANIPULATOR_HEAD)
        ):
            self.manipulator = MANIPULATOR_COMMANDS.get(data[6], self.manipulator)

    def _keep(self, register: csr.Register) -> None:
        place = slice(register.address, register.address + register.size)
        stored = bytearray(self._stored)
        stored[place] = self.memory[place]
        self._stored = bytes(stored)

    # ------------------------------------------------------------------ reads

    def _answer(self, request: Frame) -> Frame | None:
        device = bytes((PRO4_ROV,))
        if not request.flags & READ_BIT:
            own = payload(request.flags, self.memory)
            if own is None:
                return None
            return Frame(True, self.node_id, request.flags, 0, device + own)
        data = self._read(request.address, request.flags & ~READ_BIT)
        return Frame(True, self.node_id, READ_BIT, request.address, device + data)

    def _read(self, address: int, count: int) -> bytes:
        special = self._special()
        whole = special.get(address, bytes(self.memory[address:]))
        if not count:
            return whole
        if address >= csr.TOP and len(whole) >= count:
            return whole[:count]
        # Over the edge of the memory, each special register is as long as its place.
        flat = bytearray(self.memory) + bytes(0x100 - csr.TOP)
        for place, data in special.items():
            end = min([other for other in special if other > place], default=0x100)
            flat[place:end] = data[: end - place].ljust(end - place, b"\0")
        return bytes(flat[address : address + count])

    def _special(self) -> dict[int, bytes]:
        return {
            csr.CUSTOM_COMMAND: b"",
            csr.CONFIG_SIZE: CONFIG_LENGTH.to_bytes(2, "little"),
            csr.CONFIG: self.identity.config,
            csr.FIRMWARE_VERSION: bytes(self.identity.firmware),
            csr.NODE_ID: bytes((self.node_id,)),
            csr.GROUP_ID: bytes((self.group_id,)),
            csr.SERIAL_NUMBER: self.identity.unique_id,
            csr.UTILITY: bytes(self._utility),
        }
