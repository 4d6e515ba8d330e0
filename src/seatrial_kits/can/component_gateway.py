"""CAN gateway component: a node of a simulated bus for programs and buses outside."""

from __future__ import annotations

from collections import deque
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.endpoints.endpoint import report
from seatrial.model.component import NS, Component, Input, Output, Parameter, Reachable, terminal

from .frame import Frame
from .gateways.gateway import Gateway
from .gateways.url import check_link, open_gateway
from .node import CanNode
from .operations import BusError, Confirm, Transmit
from .safe_state import frames_of

MOST_REQUESTED = 64
"""Frames requested and not yet confirmed: fewer than a controller's queue holds."""
MOST_WAITING = 1000
"""Frames from outside in store; while there are more, nothing is read there."""
FORGOTTEN_NS = 5 * NS
"""Frames not confirmed after so long are taken for lost."""


class CanGateway(Reachable, Component):
    """Frames of a simulated bus out to programs and hardware, and theirs in.

    ``link`` says where they meet (`gateways.url`). Every step it takes in what has arrived, and
    requests it of the bus at the time of the beginning of that step; what it receives, goes out
    with the simulated time at which it was on the bus. So tools see the bus as it is in a run in
    real time; one that runs as fast as it can is over before they have answered.

    **Acknowledgement**: to the simulated bus the gateway is one more node, which acknowledges
    all that it receives, whether a client is connected or not. Outside, frames have been sent
    once the gateway has taken them: what the simulated bus makes of them later (arbitration, loss,
    bus-off), is not reported. Error frames are, where the protocol has them. On a real bus, the
    adapter acknowledges.

    **Clients** receive each other: a frame of one goes to the others of the same gateway when the
    simulated bus has confirmed it. Frames are requested in the order in which they came, 64 at
    most ahead of their confirmation; the rest waits, and from 1000 on nothing is read, so that
    a client has to wait too.

    ``clients`` is how many are connected, ``frames_in`` what came in, ``frames_out`` what went
    out, ``frames_refused`` what came and was no frame, ``forgotten`` what came in and was not
    confirmed in 5 s: the node is off the bus, or never gets its turn.

    ``safe_state`` are frames, as candump writes them, that are sent when it closes, and by whoever
    supervises the run if that ends without closing it: what stops the thrusters of a real vehicle.

    It cannot be rolled back: what was sent has been sent. Raises InputError at the start for a
    gateway that is malformed or cannot be opened, or is hardware that is not allowed.
    """

    discrete = True
    rolls_back = False
    transient = Component.transient | {"_gateway"}

    link = Parameter(
        "socketcand:127.0.0.1:29536", "1", "where programs outside connect to", check=check_link
    )

    safe_state = Parameter(
        "", "1", "frames sent at the end, IDENTIFIER#DATA, separated by spaces", check=frames_of
    )

    rx = Input("1", "operations from the bus", type=str, role="can")

    tx = Output("1", "operations to the bus", type=str, role="can")
    clients = Output("1", "clients connected", type=int)
    frames_in = Output("1", "frames from outside", type=int)
    frames_out = Output("1", "frames to the outside", type=int)
    frames_refused = Output("1", "lines and frames from outside that are none", type=int)
    forgotten = Output("1", "frames from outside that were never confirmed", type=int)

    terminals: ClassVar = {"bus": terminal("tx", "rx")}

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._gateway: Gateway | None = None

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Open the gateway."""
        self.close()
        try:
            self._gateway = open_gateway(self.link)
        except InputError as error:
            raise InputError(f"{self.name}: link: {error}") from None
        self._can: dict[str, Any] = {}
        self._waiting: deque[tuple[int, Frame]] = deque()
        self._requested: list[tuple[int, int, Frame]] = []
        self._in = self._out = self._forgotten = 0
        self._hold()

    def step(self, t: float, h: float) -> None:
        """Carry frames out and in."""
        assert self._gateway is not None
        node = CanNode(self._can)
        for when, operation in node.receive(self.rx):
            if isinstance(operation, Transmit):
                self._gateway.send(when, operation.frame)
                self._out += 1
            elif isinstance(operation, Confirm):
                self._confirmed(when, operation.identifier)
            elif isinstance(operation, BusError):
                self._gateway.send_error(when, operation.error)
        if len(self._waiting) < MOST_WAITING:
            arrived = self._gateway.poll()
            self._waiting.extend(arrived)
            self._in += len(arrived)
        self._forget()
        self._hold()
        while self._waiting and len(self._requested) < MOST_REQUESTED:
            sender, frame = self._waiting.popleft()
            self._requested.append((self.now_ns, sender, frame))
            node.send(self.now_ns, frame)
        node.flush()

    def outputs(self, t: float) -> None:
        """Publish what is sent, and the counters."""
        assert self._gateway is not None
        self.tx = CanNode(self._can).text
        self.clients, self.reached_at = self._gateway.clients, self._gateway.reached_at
        report(self, [self._gateway])
        self.frames_in, self.frames_out = self._in, self._out
        self.forgotten, self.frames_refused = self._forgotten, self._gateway.refused

    def close(self) -> None:
        """Send the frames of the safe state and close the gateway."""
        if self._gateway is not None:
            for frame in frames_of(self.safe_state):
                self._gateway.send(self.now_ns, frame)
            self._gateway.close()
        self._gateway = None

    # ------------------------------------------------------------------ inside

    def _hold(self) -> None:
        if self.safe_state and self._gateway is not None:
            self._gateway.keep(self.name, self.safe_state)

    def _confirmed(self, when: int, identifier: int) -> None:
        """Send the other clients a frame of one of them."""
        assert self._gateway is not None
        for place, (_, sender, frame) in enumerate(self._requested):
            if frame.identifier == identifier:
                del self._requested[place]
                self._gateway.send(when, frame, sender)
                return

    def _forget(self) -> None:
        late = self.now_ns - FORGOTTEN_NS
        kept = [entry for entry in self._requested if entry[0] >= late]
        self._forgotten += len(self._requested) - len(kept)
        self._requested = kept
