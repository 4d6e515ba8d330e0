"""Dynamic node ID allocation: the node's side of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dronecan.transport import Transfer

from .codec import protocol

REQUEST_MS, FOLLOW_UP_MS = (600, 1000), (0, 400)
"""Ranges of the random times before a request, and before what follows an answer."""
LONGEST_PART = 6
"""Bytes of the unique ID in one request."""

Allocation: Any = protocol.dynamic_node_id.Allocation

_MS = 1_000_000


class Allocatee:
    """Requests a node ID, by its unique ID of 16 bytes in three parts: rules A to E of the message.

    Source: DroneCAN specification, uavcan.protocol.dynamic_node_id.Allocation.

    A view of ``memory``, a dict that belongs to the component's state. ``draw`` (k) returns the
    k-th random number, 0 to 1.
    """

    def __init__(
        self, memory: dict[str, Any], unique_id: bytes, draw: Callable[[int], float]
    ) -> None:
        self._memory, self._unique_id, self._draw = memory, unique_id, draw

    def begin(self, now_ns: int) -> None:
        """Start the request timer."""
        self._memory.update(draws=0, due=0, offset=0)
        self._wait(now_ns, 0, REQUEST_MS)

    @property
    def due_ns(self) -> int:
        """Time of its next message, if it receives nothing before."""
        due: int = self._memory["due"]
        return due

    def receive(self, now_ns: int, transfer: Transfer) -> int:
        """Take in an Allocation message; return the node ID that it grants, or 0."""
        message = transfer.payload
        known = bytes(message.unique_id)
        self._wait(now_ns, 0, REQUEST_MS)
        if transfer.source_node_id == 0 or not self._unique_id.startswith(known):
            return 0
        if len(known) < len(self._unique_id):
            if known:
                self._wait(now_ns, len(known), FOLLOW_UP_MS)
            return 0
        return int(message.node_id)

    def request(self) -> tuple[Any, int]:
        """Return the message that is due, and its discriminator; wait for an answer."""
        offset = self._memory["offset"]
        message = Allocation(first_part_of_unique_id=offset == 0)
        message.unique_id = list(self._unique_id[offset : offset + LONGEST_PART])
        self._wait(self.due_ns, 0, REQUEST_MS)
        return message, int(self._random() * (1 << 14))

    def _wait(self, now_ns: int, offset: int, range_ms: tuple[int, int]) -> None:
        """Send the part of the unique ID at ``offset`` after a random time."""
        low, high = range_ms
        delay = round((low + (high - low) * self._random()) * _MS)
        self._memory.update(due=now_ns + delay, offset=offset)

    def _random(self) -> float:
        self._memory["draws"] += 1
        return self._draw(self._memory["draws"])
