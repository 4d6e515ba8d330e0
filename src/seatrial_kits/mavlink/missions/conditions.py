"""Items of a mission that wait for a CONDITION_DELAY while the leg after them goes on."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Sequence

from pymavlink.dialects.v20 import all as mavlink

from .plan_checks import JUMPS, NAVIGATION
from .plan_items import Item


class DelayedItems:
    """What follows a CONDITION_DELAY up to the next item that leads somewhere, or a jump.

    As in an ArduPilot: the vehicle goes on, and what still waits when the leg ends is dropped.
    """

    def __init__(self) -> None:
        self._waiting: deque[tuple[int, Item]] = deque()
        self._until = -math.inf

    def gather(self, items: Sequence[Item], sequence: int) -> int:
        """Take the items from a CONDITION_DELAY on; return the number of the one after them."""
        while sequence < len(items) and not _ends(items[sequence]):
            self._waiting.append((sequence, items[sequence]))
            sequence += 1
        return sequence

    def due(self, now: float) -> Iterator[tuple[int, Item]]:
        """Yield what need not wait any longer at a simulated time, s, with its number."""
        while self._waiting and now >= self._until:
            sequence, item = self._waiting.popleft()
            if item.command == mavlink.MAV_CMD_CONDITION_DELAY:
                self._until = now + item.number(1)
            yield sequence, item

    def drop(self) -> list[int]:
        """Forget what waits; return the numbers."""
        dropped = [sequence for sequence, _ in self._waiting]
        self._waiting.clear()
        self._until = -math.inf
        return dropped

    def __bool__(self) -> bool:
        return bool(self._waiting)


def _ends(item: Item) -> bool:
    return item.command in NAVIGATION or item.command in JUMPS
