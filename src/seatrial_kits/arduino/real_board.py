"""A real board at serial ports, on the wall clock: its UARTs and nothing else."""

from __future__ import annotations

import struct

from seatrial.errors import InputError
from seatrial.links.endpoints.endpoint import Endpoint
from seatrial.links.safe_state import HeldChannels, require_safe_state, safe_state_bytes

from .board import UART, Event, Inputs
from .mcus import CLOCK
from .wiring import Wire, open_links, read_links

_INPUT = struct.Struct("<BBHd")


class RealBoard:
    """Serial ports in the place of a simulated board's UARTs; ``links`` are ``UART=URL``.

    ``safe_state`` (hexadecimal) are the safe-state bytes. They are sent to each at the end,
    however the run ends, by whoever supervises it if this process cannot; to one whose input has
    become stale, that is silent for ``timeout`` seconds after it was not; and to the others when
    one that has sent has been silent for as long: its link is lost, and until it sends again
    nothing is sent to the others.

    Raises InputError for links that cannot be or are not allowed, for a safe state that nobody
    gave, and for wires: pins of a real board are out of reach.
    """

    def __init__(
        self, name: str, links: str, safe_state: str, timeout: float, wires: list[Wire]
    ) -> None:
        self.name, self._timeout = name, round(timeout * CLOCK)
        self._fed: dict[int, int] = {}
        self._received: dict[int, int] = {}
        self._lost: set[int] = set()
        if wires:
            raise InputError(
                f"wires: a real board has only its UARTs here, not {wires[0].kind}: leave it out, "
                "or connect the real device"
            )
        require_safe_state(safe_state, " ".join(read_links(links).values()))
        self._safe_state = safe_state_bytes(safe_state)
        self._ports = open_links(links)
        if not self._ports:
            raise InputError("links: the back end 'board' needs UART=URL of a serial port")
        self._held = HeldChannels(name)
        self._hold()

    @property
    def endpoints(self) -> list[Endpoint]:
        """Its serial ports."""
        return list(self._ports.values())

    @property
    def connected(self) -> bool:
        """Whether something has been received, and all UARTs that have sent still do."""
        there = not any(port.is_lost for port in self._ports.values())
        return there and bool(self._received) and not self._lost

    def run(self, target: int, inputs: Inputs) -> list[Event]:
        """Send what waits and return what has come, with the time of the end of the step."""
        for kind, index, value, _ in _INPUT.iter_unpack(inputs.data):
            if kind == ord("U") and index in self._ports and not self._lost - {index}:
                self._send(index, bytes([value]))
                self._fed[index] = target
        events: list[Event] = []
        for uart, port in self._ports.items():
            for _, data in port.poll():
                self._received[uart] = target
                self._lost.discard(uart)
                events += [(UART, uart, byte, target) for byte in data]
        self._watch(target)
        self._hold()
        return events

    def _hold(self) -> None:
        self._held.keep(self.endpoints, lambda _: self._safe_state)

    def _watch(self, now: int) -> None:
        """Send the safe-state bytes where an input is stale or a link is lost."""
        for uart, when in list(self._fed.items()):
            if now - when > self._timeout:
                del self._fed[uart]
                self._send(uart, self._safe_state)
        for uart, when in self._received.items():
            if uart not in self._lost and now - when > self._timeout:
                self._lost.add(uart)
                for other in self._ports.keys() - {uart}:
                    self._send(other, self._safe_state)

    def _send(self, uart: int, data: bytes) -> None:
        for channel in self._ports[uart].channels():
            channel.send(data)

    def close(self) -> None:
        """Send the safe-state bytes and close the ports. Harmless when repeated."""
        for uart in self._ports:
            self._send(uart, self._safe_state)
        self._held.release()
        for port in self._ports.values():
            port.close()
        self._ports = {}
