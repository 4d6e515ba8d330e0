"""The CAN controller of a board at a simulated bus: its messages as operations of the bus."""

from __future__ import annotations

import struct
from typing import Any

from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import BitRate, Confirm, Transmit

from ..board import Inputs

CHANNEL = 0
_MESSAGE = struct.Struct("<BBBI8s")
_FRAME, _SENT, _RATE = 0, 1, 2
"""Kinds of messages: see ``esp32/twai.cpp``."""
_EXTENDED, _REMOTE = 1, 2


class CanPort:
    """The bus's text ports in front of a board's messages; ``memory`` is the node's."""

    def __init__(self, memory: dict[str, Any]) -> None:
        self._node = CanNode(memory)

    def receive(self, rx: str, inputs: Inputs) -> None:
        """Put what is new on ``rx`` before the board: frames, and that its own were sent."""
        for _, operation in self._node.receive(rx):
            if isinstance(operation, Transmit):
                frame = operation.frame
                if frame.fd:
                    continue  # an error on a classic controller's bus: it keeps to its own frames
                flags = _EXTENDED * frame.extended | _REMOTE * frame.remote
                length = frame.requested if frame.remote else len(frame.data)
                message = (_FRAME, flags, length, frame.identifier, frame.data)
                inputs.put_message(CHANNEL, _MESSAGE.pack(*message))
            elif isinstance(operation, Confirm):
                inputs.put_message(CHANNEL, _MESSAGE.pack(_SENT, 0, 0, operation.identifier, b""))

    def send(self, time_ns: int, message: bytes) -> None:
        """Give the bus what the board has sent."""
        kind, flags, length, number, data = _MESSAGE.unpack(message)
        if kind == _RATE:
            self._node.send_operation(time_ns, BitRate(number))
            return
        remote, extended = bool(flags & _REMOTE), bool(flags & _EXTENDED)
        content = b"" if remote else data[:length]
        requested = length if remote else 0
        limit = 0x1FFFFFFF if extended else 0x7FF
        frame = Frame(number & limit, content, extended, remote, requested=requested)
        self._node.send(time_ns, frame)

    def flush(self) -> str:
        """Return the text of ``tx``."""
        return self._node.flush()
