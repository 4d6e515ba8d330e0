"""File transfer: files on board that stations list and read."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from typing import NamedTuple

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..service import Service, on_message
from ..transport import Sender, Transport
from ..vehicle import Vehicle

# Sequence, session, opcode, size, requested opcode, burst complete, padding, offset; then data.
_HEADER = struct.Struct("<HBBBBBxI")
_PAYLOAD_BYTES, MOST_DATA = 251, 239
_TERMINATE, _RESET, _LIST, _OPEN, _READ, _BURST = 1, 2, 3, 4, 5, 15
_ACK, _NAK = 128, 129
_FAIL, _BAD_SIZE, _INVALID_SESSION, _END_OF_FILE, _UNKNOWN_COMMAND, _NOT_FOUND = 1, 3, 4, 6, 7, 10
_SESSIONS = 8
"""Files that are open at once; the oldest is closed for another one."""
_BURST_PACKETS = 20

_Session = tuple[int, int, int]
"""System and component of a station, and the number it gives."""

Files = Mapping[str, Callable[[str], bytes]]
"""Content of each file, by its path without the first '/', of what follows a '?' in the request."""


class _Request(NamedTuple):
    sequence: int
    session: int
    opcode: int
    size: int
    offset: int
    data: bytes

    @property
    def text(self) -> str:
        return self.data.partition(b"\0")[0].decode("utf-8", "replace").lstrip("/")


class FileService(Service):
    """FILE_TRANSFER_PROTOCOL, the side of it that reads: folders are listed, files opened and read.

    A file is as it was when it was opened. A burst has 20 packets; the next one is requested, as is
    what was lost. All that would write is refused as an unknown command.
    """

    capabilities = mavlink.MAV_PROTOCOL_CAPABILITY_FTP

    def __init__(self, vehicle: Vehicle, transport: Transport, files: Files) -> None:
        super().__init__(vehicle, transport)
        self._files = files
        self._is_ardupilot = vehicle.dialect.is_ardupilot
        self._sessions: dict[_Session, bytes] = {}
        """By station and its number: MAVProxy numbers them itself, and wants its number back."""

    @on_message(mavlink.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL)
    def _take(self, message: Message, sender: Sender, now: float) -> None:
        payload = bytes(message.payload)
        sequence, session, opcode, size, _, _, offset = _HEADER.unpack_from(payload)
        data = payload[_HEADER.size :][: min(size, MOST_DATA)]
        request = _Request(sequence, session, opcode, size, offset, data)
        if opcode in (_LIST, _OPEN) and not request.text and not data:
            self._refuse(request, sender, _BAD_SIZE)
        elif opcode in (0, _TERMINATE, _RESET):
            self._close(request, sender)
            self._answer(request, sender)
        elif opcode == _LIST:
            self._list(request, sender)
        elif opcode == _OPEN:
            self._open(request, sender)
        elif opcode in (_READ, _BURST):
            self._read(request, sender)
        elif opcode < _ACK:
            self._refuse(request, sender, _FAIL if self._is_ardupilot else _UNKNOWN_COMMAND)

    def _close(self, request: _Request, sender: Sender) -> None:
        station = (sender.system, sender.component)
        if request.opcode == _RESET:
            self._sessions = {k: v for k, v in self._sessions.items() if k[:2] != station}
        elif request.opcode == _TERMINATE:
            self._sessions.pop((*station, request.session), None)

    def _list(self, request: _Request, sender: Sender) -> None:
        entries = self._entries(request.text.rstrip("/"))
        if entries is None:
            self._refuse(request, sender, _NOT_FOUND)
            return
        data = b""
        for entry in entries[request.offset :]:
            if len(data) + len(entry) > MOST_DATA:
                break
            data += entry
        if data:
            self._answer(request, sender, data)
        else:
            self._refuse(request, sender, _END_OF_FILE)

    def _entries(self, folder: str) -> list[bytes] | None:
        """Return what is in a folder, as it is sent; None if there is no such folder."""
        prefix = f"{folder}/" if folder and folder != "." else ""
        inside = [path.removeprefix(prefix) for path in self._files if path.startswith(prefix)]
        if not inside and prefix:
            return None
        folders = sorted({path.partition("/")[0] for path in inside if "/" in path})
        names = sorted(path for path in inside if "/" not in path)
        files = [f"F{name}\t{len(self._files[prefix + name](''))}\0" for name in names]
        return [text.encode() for text in (*(f"D{name}\0" for name in folders), *files)]

    def _open(self, request: _Request, sender: Sender) -> None:
        path, _, query = request.text.partition("?")
        if path not in self._files:
            self._refuse(request, sender, _NOT_FOUND)
            return
        session = (sender.system, sender.component, request.session)
        self._sessions.pop(session, None)
        if len(self._sessions) == _SESSIONS:
            del self._sessions[next(iter(self._sessions))]
        content = self._sessions[session] = self._files[path](query)
        self._answer(request, sender, struct.pack("<I", len(content)))

    def _read(self, request: _Request, sender: Sender) -> None:
        content = self._sessions.get((sender.system, sender.component, request.session))
        if content is None:
            self._refuse(request, sender, _NOT_FOUND if self._is_ardupilot else _INVALID_SESSION)
            return
        if request.size > MOST_DATA:
            self._refuse(request, sender, _BAD_SIZE)
            return
        nothing = request.opcode == _READ and not request.size and self._is_ardupilot
        if request.offset >= len(content) or nothing:
            self._refuse(request, sender, _END_OF_FILE)
            return
        most = min(request.size or MOST_DATA, MOST_DATA)
        packets = _BURST_PACKETS if request.opcode == _BURST else 1
        starts = range(request.offset, len(content), most)[:packets]
        for number, start in enumerate(starts):
            part = request._replace(sequence=request.sequence + number, offset=start)
            last = request.opcode == _BURST and start == starts[-1]
            self._answer(part, sender, content[start : start + most], last=last)

    def _answer(
        self, request: _Request, sender: Sender, data: bytes = b"", *, last: bool = False
    ) -> None:
        self._send(request, sender, _ACK, data, last=last)

    def _refuse(self, request: _Request, sender: Sender, error: int) -> None:
        self._send(request, sender, _NAK, bytes([error]))

    def _send(
        self, request: _Request, sender: Sender, opcode: int, data: bytes, *, last: bool = False
    ) -> None:
        sequence = (request.sequence + 1) % (1 << 16)
        head = (sequence, request.session, opcode, len(data), request.opcode, last, request.offset)
        payload = (_HEADER.pack(*head) + data).ljust(_PAYLOAD_BYTES, b"\0")
        self.transport.send(
            sender.link,
            mavlink.MAVLink_file_transfer_protocol_message(
                0, sender.system, sender.component, list(payload)
            ),
        )
