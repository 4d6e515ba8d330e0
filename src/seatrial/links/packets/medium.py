"""Half-duplex senders and receivers in one medium: queues, arrivals, collisions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Packet = list[Any]
"""[time from which it may be sent, ns; number among those of its sender; bytes, hexadecimal]."""
Arrival = list[Any]
"""[begin, ns; end, ns; bytes, hexadecimal; whether it is lost]."""
Path = Callable[[int, int, int], tuple[int, bool] | None]
"""(sender, receiver, packet's number) -> (time of travel, ns; whether lost), None: too far."""


class Medium:
    """A view of ``memory``, which is a dict of plain data that belongs to a component's state.

    A node sends one packet at a time, the oldest first, and not while one arrives. It receives
    nothing while it sends, and of packets that overlap where they arrive none.
    """

    def __init__(self, memory: dict[str, Any], nodes: int) -> None:
        self._nodes = range(nodes)
        self._queues: list[list[Packet]] = memory.setdefault("queues", [[] for _ in self._nodes])
        self._arrivals: list[list[Arrival]] = memory.setdefault(
            "arrivals", [[] for _ in self._nodes]
        )
        self._sending: list[list[int]] = memory.setdefault(
            "sending", [[-1, -1] for _ in self._nodes]
        )
        self._numbers: list[int] = memory.setdefault("numbers", [0 for _ in self._nodes])

    def waiting(self, node: int) -> int:
        """Return the number of packets that wait at a node."""
        return len(self._queues[node])

    def put(self, node: int, ready_ns: int, data: bytes) -> None:
        """Let a packet wait at its sender from ``ready_ns`` on."""
        self._queues[node].append([ready_ns, self._numbers[node], data.hex()])
        self._numbers[node] += 1

    def send_until(self, end_ns: int, duration_ns: Callable[[int], int], path: Path) -> list[int]:
        """Let all packets leave that can before ``end_ns``; return their senders.

        ``duration_ns`` is the time that a packet of so many bytes takes.
        """
        senders: list[int] = []
        while True:
            starts = [(self._start(node), node) for node in self._nodes if self._queues[node]]
            begin, node = min(starts, default=(end_ns, -1))
            if begin >= end_ns:
                return senders
            _, number, data = self._queues[node].pop(0)
            end = begin + duration_ns(len(data) // 2)
            self._sending[node] = [begin, end]
            for arrival in self._arrivals[node]:
                arrival[3] = arrival[3] or _overlap(arrival, begin, end)
            for other in self._nodes:
                found = path(node, other, number) if other != node else None
                if found is not None:
                    self._arrive(other, begin + found[0], end + found[0], data, found[1])
            senders.append(node)

    def take_until(self, end_ns: int, node: int) -> list[tuple[int, bytes | None]]:
        """Return what has arrived at a node by ``end_ns``: time, ns, and bytes, None if lost."""
        due = sorted(arrival for arrival in self._arrivals[node] if arrival[1] <= end_ns)
        self._arrivals[node][:] = [a for a in self._arrivals[node] if a[1] > end_ns]
        return [(end, None if lost else bytes.fromhex(data)) for _, end, data, lost in due]

    def _start(self, node: int) -> int:
        """Return when a node can send its next packet, ns."""
        start = max(self._queues[node][0][0], self._sending[node][1])
        while busy := [a[1] for a in self._arrivals[node] if a[0] <= start < a[1]]:
            start = max(busy)
        return int(start)

    def _arrive(self, node: int, begin: int, end: int, data: str, lost: bool) -> None:
        here = self._arrivals[node]
        new = [begin, end, data, lost or _overlap([begin, end], *self._sending[node])]
        for other in here:
            if _overlap(other, begin, end):
                other[3] = new[3] = True
        here.append(new)


def _overlap(one: list[Any], begin: int, end: int) -> bool:
    return bool(one[0] < end and begin < one[1])
