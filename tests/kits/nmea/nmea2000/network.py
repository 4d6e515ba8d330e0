"""Nodes on a simulated bus, stepped in process, and all that was on it."""

from __future__ import annotations

from typing import Any

from seatrial_kits.can.component import CanBus
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit
from seatrial_kits.nmea.nmea2000.codec import Decoder, Encoder, Message
from seatrial_kits.nmea.nmea2000.component import Nmea2000

STEP_NS = 10_000_000


def node(name: str = "node", **settings: Any) -> Nmea2000:
    """A node that has begun; parameters and start values of inputs by name."""
    made = Nmea2000(name)
    for port, value in settings.items():
        made.set(port, value)
    made.setup(0.0)
    made.initialise()
    made.begin()
    return made


class Network:
    """Nodes by name, and one more on the bus that only listens and sends what a test wants.

    ``frames`` has (time in ns, frame) of all that was on the bus, ``messages`` what it means.
    """

    def __init__(
        self,
        nodes: dict[str, dict[str, Any]],
        bus: dict[str, Any] | None = None,
        step_ns: int = STEP_NS,
    ) -> None:
        self.step_ns, self.now = step_ns, 0
        self.nodes = {
            name: node(name, **{"seed": k + 1.0, **settings})
            for k, (name, settings) in enumerate(nodes.items())
        }
        self.bus = CanBus("bus")
        self.bus.set("nodes", " ".join([*nodes, "test"]))
        for port, value in (bus or {}).items():
            self.bus.set(port, value)
        self.bus.setup(0.0)
        self.bus.initialise()
        self.bus.begin()
        self.frames: list[tuple[int, Frame]] = []
        self.messages: list[tuple[int, Message]] = []
        self._can: dict[str, Any] = {}
        self._tap = CanNode(self._can)
        self._decoder, self._encoder = Decoder({}), Encoder({})

    def send_message(self, message: Message) -> None:
        for frame in self._encoder.encode(message):
            self.send(frame)

    def send(self, frame: Frame) -> None:
        self._tap.send(self.now, frame)

    def run(self, seconds: float) -> None:
        t, h = self.now / 1e9, self.step_ns / 1e9
        for _ in range(round(seconds * 1e9 / self.step_ns)):
            t = self.now / 1e9
            for k, each in enumerate(self.nodes.values(), 1):
                self.bus.set(f"tx.n{k}", each.get("tx"))
                each.set("rx", self.bus.get(f"rx.n{k}"))
            tap = len(self.nodes) + 1
            self.bus.set(f"tx.n{tap}", self._tap.flush())
            self._receive(self.bus.get(f"rx.n{tap}"))
            for each in (*self.nodes.values(), self.bus):
                each.advance(t, h)
            self.now += self.step_ns

    def sent(self, pgn: int, source: int | None = None) -> list[Message]:
        """Return the messages of a PGN that were on the bus."""
        return [m for _, m in self.messages if m.pgn == pgn and source in (None, m.source)]

    def _receive(self, text: str) -> None:
        for when, operation in self._tap.receive(text):
            if isinstance(operation, Transmit):
                self.frames.append((when, operation.frame))
                whole = self._decoder.decode(operation.frame)
                if whole is not None:
                    self.messages.append((when, whole))
