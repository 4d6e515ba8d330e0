"""A real board at serial ports, on the wall clock: its UARTs and nothing else."""

from __future__ import annotations

import struct

from ...errors import InputError
from ..endpoints.endpoint import Endpoint
from ..endpoints.url import open_endpoint
from .board import UART, Event, Inputs
from .wiring import UARTS, Wire

_INPUT = struct.Struct("<BBHd")


class RealBoard:
    """Serial ports in the place of a simulated board's UARTs; ``links`` are ``UART=URL``.

    ``farewell`` (hexadecimal) is sent to each at the end, however the run ends. Raises
    InputError for links that cannot be, for real ports that nobody allowed, and for wires:
    pins of a real board are out of reach.
    """

    def __init__(self, name: str, links: str, farewell: str, wires: list[Wire]) -> None:
        self.name = name
        if wires:
            raise InputError(
                f"wires: a real board has only its UARTs here, not {wires[0].kind}: leave it out, "
                "or connect the real device"
            )
        try:
            self._farewell = bytes.fromhex(farewell)
        except ValueError:
            raise InputError(f"farewell: {farewell!r} is not hexadecimal") from None
        self._ports: dict[int, Endpoint] = {}
        try:
            for link in links.split():
                uart, _, url = link.partition("=")
                if not (uart.isdecimal() and int(uart) < UARTS and url):
                    raise InputError(
                        f"links: {link!r} is not UART=URL, as 0=serial:/dev/ttyACM0:115200"
                    )
                self._ports[int(uart)] = open_endpoint(url)
        except InputError:
            self.close()
            raise
        if not self._ports:
            raise InputError("links: the back end 'board' needs UART=URL of a serial port")

    def run(self, target: int, inputs: Inputs) -> list[Event]:
        """Send what waits and return what has come, with the time of the end of the step."""
        for kind, index, value, _ in _INPUT.iter_unpack(inputs.data):
            if kind == ord("U") and index in self._ports:
                for channel in self._ports[index].channels():
                    channel.send(bytes([value]))
        events: list[Event] = []
        for uart, port in self._ports.items():
            for _, data in port.poll():
                events += [(UART, uart, byte, target) for byte in data]
        return events

    def close(self) -> None:
        """Say farewell and close the ports. Harmless when repeated."""
        for port in self._ports.values():
            if self._farewell:
                for channel in port.channels():
                    channel.send(self._farewell)
            port.close()
        self._ports = {}
