"""Serial bytes of a simulation out to a terminal, a port or a serial line, and in."""

from __future__ import annotations

from typing import Any, ClassVar

from ..errors import InputError
from ..model.component import Component, Input, Logging, Output, Parameter, Reachable, terminal
from .endpoints.budget import Budget
from .endpoints.endpoint import Endpoint, report
from .endpoints.url import check_urls, open_endpoints, other_end
from .safe_state import UNSET, HeldChannels, require_safe_state, safe_state_bytes
from .text import Inbox, Outbox


class SerialGateway(Logging, Reachable, Component):
    """Bytes on a String port to the programs or the device at a URL, and theirs to a String port.

    ``links`` are URLs of `endpoints.url`, separated by spaces: a pseudo-terminal or a TCP port for
    programs, a serial port for a device. Every step it sends what ``rx`` has, and puts what has
    arrived on ``tx`` with the time of the beginning of that step: outside, the wall clock applies.
    All clients get all. Bytes leave in the step that has them, at whatever baud rate the
    other end reckons with.

    ``safe_state`` is sent when it closes, and by whoever supervises the run if that ends without
    closing it: for a real vehicle the request that stops its thrusters. Where a device is behind
    a link it must be given, if only as empty.

    It cannot be rolled back. Raises InputError at the start for a link that is malformed or
    cannot be opened, or is not allowed.
    """

    discrete = True
    rolls_back = False
    transient = Component.transient | {"_endpoints", "_held"}

    links = Parameter(
        "tcpin:127.0.0.1:0", "1", "URLs of the other ends, separated by spaces", check=check_urls
    )
    safe_state = Parameter(
        UNSET, "1", "bytes sent at the end, hexadecimal; empty for none", check=safe_state_bytes
    )

    rx = Input("1", "bytes for the other end", type=str, role="bytes", optional=True)

    tx = Output("1", "bytes from the other end", type=str, role="bytes")
    sent = Output("1", "bytes sent", type=int)
    received = Output("1", "bytes received", type=int)

    # In the place of the topside: what comes from outside goes down.
    terminals: ClassVar = {"serial": terminal(down="tx", up="rx")}

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._endpoints: list[Endpoint] = []
        self._held = HeldChannels(name)

    def start(self, t: float) -> None:
        """Open the links."""
        self.close()
        try:
            require_safe_state(self.safe_state, self.links)
            self._endpoints = open_endpoints("links", self.links)
            for endpoint in self._endpoints:
                endpoint.budget = Budget.of_raw_bytes()
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        self._rx: dict[str, Any] = {}
        self._tx: dict[str, Any] = {}
        self._sent = self._received = 0
        self._hold()

    def step(self, t: float, h: float) -> None:
        """Carry bytes out and in."""
        box = Outbox(self._tx)
        for endpoint in self._endpoints:
            for _, data in endpoint.poll():
                self._received += len(data)
                box.put(self.now_ns, data)
        box.flush()
        self._hold()
        for _, data in Inbox(self._rx).take(self.rx):
            self._sent += len(data)
            self._send(data)

    def outputs(self, t: float) -> None:
        """Publish what was received, and the counters."""
        self.tx = Outbox(self._tx).text
        self.sent, self.received = self._sent, self._received
        self.reached_at = " ".join(other_end(endpoint.url) for endpoint in self._endpoints)
        report(self, self._endpoints)

    def close(self) -> None:
        """Send the safe-state bytes and close the links."""
        if last := safe_state_bytes(self.safe_state):
            self._send(last)
        self._held.release()
        for endpoint in self._endpoints:
            endpoint.close()
        self._endpoints = []

    def _hold(self) -> None:
        data = safe_state_bytes(self.safe_state)
        self._held.keep(self._endpoints, lambda _: data)

    def _send(self, data: bytes) -> None:
        for endpoint in self._endpoints:
            for channel in endpoint.channels():
                channel.send(data)
