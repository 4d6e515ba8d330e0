"""A bus with two nodes that a DBC describes, stepped as a rig does."""

from collections.abc import Sequence
from pathlib import Path

from seatrial.model.component import Component
from seatrial_kits.can.component import CanBus
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit
from seatrial_kits.can.signals.component import CanSignals


class Peer(Component):
    """A node that sends the frames it is given and keeps what it receives, with times in ns."""

    def __init__(self) -> None:
        super().__init__("peer")
        self.memory: dict = {}
        self.received: list[tuple[int, Frame]] = []

    def exchange(self, rx: str, now_ns: int, frames: Sequence[Frame]) -> str:
        node = CanNode(self.memory)
        for when, operation in node.receive(rx):
            if isinstance(operation, Transmit):
                self.received.append((when, operation.frame))
        for frame in frames:
            node.send(now_ns, frame)
        return node.flush()


def signals(database: Path | str, **values: object) -> CanSignals:
    """Return a node at the start of its run."""
    node = CanSignals("node")
    for name, value in {"database": str(database), **values}.items():
        node.set(name, value)
    node.initialise()
    node.begin()
    return node


class Bench:
    """``node`` and a `Peer` on a bus of 500 kbit/s; a connection takes a step, as in a rig."""

    def __init__(self, node: CanSignals, *, step_ns: int = 5_000_000) -> None:
        self.node, self.peer, self.step_ns = node, Peer(), step_ns
        self.bus = CanBus("can")
        self.bus.set("nodes", "node peer")
        self.bus.set("bit_rate", 500_000.0)
        self.bus.initialise()
        self.bus.begin()
        self.now = 0

    def run(self, seconds: float, frames: Sequence[Frame] = ()) -> None:
        """Run on; the peer requests ``frames`` at the beginning."""
        peer_tx = self.bus.get("tx.n2")
        for _ in range(round(seconds * 1e9) // self.step_ns):
            rx = self.bus.get("rx")
            tx = self.node.get("tx")
            self.node.set("rx", rx[0])
            self.bus.set("tx.n1", tx)
            self.bus.set("tx.n2", peer_tx)
            peer_tx = self.peer.exchange(rx[1], self.now, frames)
            frames = ()
            for each in (self.node, self.bus):
                each.advance(self.now / 1e9, self.step_ns / 1e9)
            self.now += self.step_ns
        self.bus.set("tx.n2", peer_tx)
