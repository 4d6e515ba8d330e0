"""A node of a simulated bus, as its component sees it: two String ports."""

from __future__ import annotations

from typing import Any

from seatrial.errors import InputError
from seatrial.links.text import Inbox, Outbox

from .frame import Frame
from .operations import FormatError, Operation, Transmit, decode, encode


class CanNode:
    """Operations with times that one node receives on its ``rx`` and sends on its ``tx``.

    ``memory`` is a dict that belongs to the component's state, empty at the start; the node is
    only a view of it and need not be kept::

        def start(self, t):
            self._can = {}

        def step(self, t, h):
            node = CanNode(self._can)
            for time_ns, operation in node.receive(self.rx):
                if isinstance(operation, Transmit):
                    ...                                  # operation.frame was received
            node.send(self.now_ns, Frame(0x123, bytes(8)))
            node.flush()

        def outputs(self, t):
            self.tx = CanNode(self._can).text

    A frame is requested at a time in the step from t to t + h, ends included; those of one node
    in the order of their times. Its way onto the bus begins at that very time (`CanBus`).
    """

    def __init__(self, memory: dict[str, Any]) -> None:
        self._inbox = Inbox(memory.setdefault("in", {}))
        self._outbox = Outbox(memory.setdefault("out", {}))

    @property
    def text(self) -> str:
        """Text of ``tx``: as of the last `flush`."""
        return self._outbox.text

    def receive(self, rx: str) -> list[tuple[int, Operation]]:
        """Return what is new on ``rx``, once: simulated time (ns) and operation.

        Bytes that are no operations here, CAN XL say, are answered with a `FormatError`. Raises
        InputError for a text that no bus has written, SimulationError if one was missed.
        """
        found: list[tuple[int, Operation]] = []
        for when, data in self._inbox.take(rx):
            try:
                found += [(when, each) for each in decode(data)]
            except InputError:
                self.send_operation(when, FormatError(data))
        return found

    def send(self, time_ns: int, frame: Frame) -> None:
        """Request a frame of the bus at ``time_ns``."""
        self.send_operation(time_ns, Transmit(frame))

    def send_operation(self, time_ns: int, operation: Operation) -> None:
        """Send the bus another operation at ``time_ns``: `BitRate`, `Buffering`, `Status`."""
        self._outbox.put(time_ns, encode(operation))

    def flush(self) -> str:
        """Publish what was sent, once at the end of a step; return `text`."""
        return self._outbox.flush()
