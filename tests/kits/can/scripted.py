"""A `CanBus` between nodes that request given frames at given times, stepped by hand."""

from collections.abc import Mapping, Sequence
from typing import Any

from seatrial_kits.can.component import NODES, CanBus
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Confirm, Operation, Transmit

MS = 10**6
"""Nanoseconds in a millisecond."""
Requested = Sequence[tuple[int, int, Frame]]
"""Time (ns), node and frame of each request, in order."""


class Scripted:
    """Steps the bus as Jacobi does: what is requested in a step is on ``tx`` at its end."""

    def __init__(
        self, bus: Any, requested: Requested, events: Mapping[int, dict] | None = None
    ) -> None:
        self.bus, self.requested, self.events = (
            bus,
            sorted(requested, key=lambda a: a[0]),
            events or {},
        )
        self.now, self.next = 0, 0
        self.memories: list[dict] = [{} for _ in range(NODES)]
        self.operations: list[list[tuple[int, Operation]]] = [[] for _ in range(NODES)]
        self.received_at: list[list[int]] = [[] for _ in range(NODES)]

    def run(self, until_ns: int, step_ns: int) -> None:
        while self.now < until_ns:
            for name, value in self.events.get(self.now, {}).items():
                self.bus.set(name, value)
            nodes = [CanNode(memory) for memory in self.memories]
            for number, text in enumerate(self.bus.get("rx")):
                new = nodes[number].receive(text)
                self.operations[number] += new
                self.received_at[number] += [self.now] * len(new)
            while (
                self.next < len(self.requested)
                and self.requested[self.next][0] <= self.now + step_ns
            ):
                when, number, frame = self.requested[self.next]
                nodes[number].send(when, frame)
                self.next += 1
            self.bus.advance(self.now / 1e9, step_ns / 1e9)
            self.bus.set("tx", [node.flush() for node in nodes])
            self.now += step_ns

    def received(self, number: int) -> list[tuple[int, Frame]]:
        return [
            (t, each.frame) for t, each in self.operations[number] if isinstance(each, Transmit)
        ]

    def confirmed(self, number: int) -> list[tuple[int, int]]:
        return [(t, e.identifier) for t, e in self.operations[number] if isinstance(e, Confirm)]


def bus(**values: Any) -> CanBus:
    """Return a bus that runs."""
    made = CanBus("can")
    for name, value in {"nodes": "a b c", **values}.items():
        made.set(name, value)
    made.initialise()
    made.begin()
    return made
