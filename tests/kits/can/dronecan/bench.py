"""Nodes on a simulated bus; the dronecan package's own node among them, in simulated time."""

import sched
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from unittest.mock import patch

import dronecan.app.dynamic_node_id
import dronecan.app.node_monitor
import dronecan.driver.common
import dronecan.node
import dronecan.transport
from dronecan.driver.common import AbstractDriver, CANFrame

from seatrial.model.component import Component
from seatrial_kits.can.component import CanBus
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit

STEP_NS = 1_000_000
MODULES = (
    dronecan.node,
    dronecan.transport,
    dronecan.driver.common,
    dronecan.app.node_monitor,
    dronecan.app.dynamic_node_id,
)


class Driver(AbstractDriver):
    """Driver of the package for the simulated bus."""

    def __init__(self) -> None:
        super().__init__()
        self.received: list[CANFrame] = []
        self.sent: list[Frame] = []

    def receive(self, timeout=None):
        del timeout
        return self.received.pop(0) if self.received else None

    def send_frame(self, frame):
        self.sent.append(Frame(frame.id, bytes(frame.data), frame.extended))

    def close(self):
        pass


class Bench:
    """A bus at 1 Mbit/s, ``nodes`` of ours by name, and ``peer``, a node of the package."""

    def __init__(self, *nodes: Component, peer_id: int | None = 100, **bus: object) -> None:
        self.now_ns = 0
        self.nodes, self.inputs = nodes, {node.name: {} for node in nodes}
        self.bus = CanBus("can")
        names = " ".join([*(node.name for node in nodes), "peer"])
        for name, value in {"nodes": names, "bit_rate": 1e6, **bus}.items():
            self.bus.set(name, value)
        for each in (*nodes, self.bus):
            each.setup(0.0)
            each.initialise()
            each.begin()
        self.driver, self._can = Driver(), {}
        self.frames: list[tuple[int, Frame]] = []
        clock = types.SimpleNamespace(monotonic=self.now, time=self.now)
        self._patches = [patch.object(module, "time", clock) for module in MODULES]
        scheduler = types.SimpleNamespace(scheduler=lambda: sched.scheduler(self.now))
        self._patches.append(patch.object(dronecan.node, "sched", scheduler))
        for each in self._patches:
            each.start()
        self.peer = dronecan.node.Node(self.driver, node_id=peer_id, catch_handler_exceptions=False)

    def now(self) -> float:
        return self.now_ns / 1e9

    def close(self) -> None:
        for each in self._patches:
            each.stop()

    def step(self) -> None:
        """One step: all nodes, then the bus, from outputs as they were before."""
        t, h = self.now_ns / 1e9, STEP_NS / 1e9
        sent = [node.get("tx") for node in self.nodes]
        for place, node in enumerate(self.nodes):
            node.set("rx", self.bus.get(f"rx.n{place + 1}"))
        view = CanNode(self._can)
        for when, operation in view.receive(self.bus.get(f"rx.n{len(self.nodes) + 1}")):
            if isinstance(operation, Transmit):
                frame = operation.frame
                self.frames.append((when, frame))
                received = CANFrame(
                    frame.identifier, bytearray(frame.data), frame.extended, when / 1e9, when / 1e9
                )
                self.driver.received.append(received)
        self.peer.spin(0)
        for place, text in enumerate([*sent, view.text]):
            self.bus.set(f"tx.n{place + 1}", text)
        for frame in self.driver.sent:
            view.send(self.now_ns, frame)
        self.driver.sent.clear()
        view.flush()
        for each in (*self.nodes, self.bus):
            each.advance(t, h)
        self.now_ns += STEP_NS

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * 1e9 / STEP_NS)):
            self.step()

    def until(self, condition: Callable[[], object], seconds: float) -> float:
        """Run until ``condition`` holds, at most so long; return the time."""
        end = self.now_ns + round(seconds * 1e9)
        while not condition():
            assert self.now_ns < end, f"not within {seconds} s"
            self.step()
        return self.now()

    def collect(self, kind) -> list:
        """Return a list that what the peer receives of a type comes into, with its transfer."""
        found: list = []

        def keep(event) -> None:
            found.append(event)

        self.peer.add_handler(kind, keep)
        return found

    def request(self, request, node_id: int, seconds: float = 2.0):
        """Return the response to a request of the peer's, None if there is none."""
        answers: list = []
        self.peer.request(request, node_id, answers.append)
        self.until(lambda: answers, seconds)
        return answers[0].response if answers[0] is not None else None


@contextmanager
def bench(*nodes: Component, **options: object) -> Iterator[Bench]:
    made = Bench(*nodes, **options)
    try:
        yield made
    finally:
        made.close()


def made(cls: type[Component], name: str, **values: object) -> Component:
    node = cls(name)
    for port, value in values.items():
        node.set(port, value)
    return node
