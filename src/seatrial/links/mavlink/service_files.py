"""Files on board, of which there are none: who asks is told so at once."""

from __future__ import annotations

import struct

from pymavlink.dialects.v20 import all as mavlink

from .codec import Message
from .service import Service
from .transport import Sender

# Sequence, session, opcode, size, requested opcode, burst complete, padding, offset; then data.
_HEADER = struct.Struct("<HBBBBBxI")
_PAYLOAD_BYTES = 251
_NAK, _FIRST_ANSWER = 129, 128
_UNKNOWN_COMMAND = 7


class FileService(Service):
    """Answers each request of FILE_TRANSFER_PROTOCOL by NAK, unknown command.

    Ground stations that first look for a file of parameters then ask for the list, and need not
    wait until they give up.
    """

    def handle(self, message: Message, sender: Sender, now: float) -> None:
        """Refuse a request."""
        if message.get_type() != "FILE_TRANSFER_PROTOCOL":
            return
        number, session, opcode, *_ = _HEADER.unpack_from(bytes(message.payload))
        if opcode >= _FIRST_ANSWER:
            return
        header = _HEADER.pack((number + 1) % (1 << 16), session, _NAK, 1, opcode, 0, 0)
        payload = bytes([*header, _UNKNOWN_COMMAND]).ljust(_PAYLOAD_BYTES, b"\0")
        self.transport.send(
            sender.link,
            mavlink.MAVLink_file_transfer_protocol_message(
                0, sender.system, sender.component, list(payload)
            ),
        )
