"""A bus with a gateway, running in real time in a thread while a test is its client."""

import threading
import time
from collections.abc import Callable

from seatrial_kits.can.component import CanBus
from seatrial_kits.can.component_gateway import CanGateway
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit

WAIT_S = 60.0
STEP_NS = 2_000_000


class Served:
    """Nodes: ``peer``, scripted; ``gateway``, a gateway. 1 Mbit/s.

    ``peer`` sends what `send` was given, at its times, and keeps what it receives in ``received``.
    """

    def __init__(self, gateway: str, **values: object) -> None:
        self.gateway = CanGateway("gateway")
        self.gateway.set("link", gateway)
        self.bus = CanBus("can")
        # With more mailboxes frames of one node overtake each other.
        given = {
            "nodes": "peer gateway",
            "bit_rate": 1e6,
            "queue_length": 1000.0,
            "mailboxes": 1.0,
            **values,
        }
        for name, value in given.items():
            self.bus.set(name, value)
        for each in (self.gateway, self.bus):
            each.initialise()
            each.begin()
        self.received: list[tuple[int, Frame]] = []
        self.at = self.gateway.get("reached_at")
        self.now = 0
        self._to_send: list[Frame] = []
        self._can: dict = {}
        self._stop = threading.Event()
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "Served":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join(WAIT_S)
        self.gateway.close()
        assert self._error is None, self._error

    def send(self, *frames: Frame) -> None:
        """Let ``peer`` send frames, two per step: 1000 a second."""
        self._to_send.extend(frames)

    def wait(self, condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + WAIT_S
        while not condition():
            assert self._error is None, self._error
            assert time.monotonic() < deadline, "it did not come about"
            time.sleep(0.005)

    def _run(self) -> None:
        try:
            begun = time.monotonic()
            while not self._stop.is_set():
                self._step()
                ahead = begun + self.now / 1e9 - time.monotonic()
                if ahead > 0:
                    time.sleep(ahead)
        except BaseException as error:
            self._error = error

    def _step(self) -> None:
        peer = CanNode(self._can)
        rx, gateway_tx = self.bus.get("rx"), self.gateway.get("tx")
        for when, operation in peer.receive(rx[0]):
            if isinstance(operation, Transmit):
                self.received.append((when, operation.frame))
        for frame in self._to_send[:2]:
            peer.send(self.now, frame)
        del self._to_send[:2]
        self.gateway.set("rx", rx[1])
        self.bus.set("tx.n1", peer.flush())
        self.bus.set("tx.n2", gateway_tx)
        for each in (self.bus, self.gateway):
            each.advance(self.now / 1e9, STEP_NS / 1e9)
        self.now += STEP_NS
