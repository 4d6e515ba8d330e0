"""The WiFi of a board: sockets of UDP and TCP on this machine, or where the network is allowed."""

from __future__ import annotations

import contextlib
import ipaddress
import socket
import struct

from seatrial.errors import InputError, SimulationError
from seatrial.links.hardware import check_host, check_listening

from ..board import Inputs
from .tcp import LISTEN, Tcp, own_port

CHANNEL = 1
_HEAD = struct.Struct("<BBHI")
_ADDRESS, _OPEN, _CLOSE, _PACKET = 0, 1, 2, 3
"""Kinds of messages: see ``esp32/network.h``."""
_LARGEST = 1460
_A_STEP = 64
"""Packets that a socket takes in at most in a step."""


class Network:
    """Sockets at ``address``, the board's own; '' for a board that is alone: nothing arrives.

    An address of loopback is a network of this machine: 127.0.0.2 and so on are boards, and every
    address beyond, broadcasts too, is 127.0.0.1. Another address needs permission, as do those
    that the board sends to from there.
    """

    def __init__(self, name: str, address: str) -> None:
        self.name, self.address = name, address
        self._sockets: dict[int, socket.socket] = {}
        self._tcp = Tcp(name, address)
        if address:
            check_listening("network: the board", address)

    def connect(self, inputs: Inputs) -> None:
        """Tell the board its address."""
        if self.address:
            inputs.put_message(CHANNEL, _HEAD.pack(_ADDRESS, 0, 0, _number(self.address)))

    def receive(self, inputs: Inputs) -> None:
        """Put packets that have come before the board."""
        for number, one in self._sockets.items():
            for _ in range(_A_STEP):
                try:
                    data, (host, port) = one.recvfrom(_LARGEST)
                except OSError:  # nothing there, or an earlier packet was refused
                    break
                _put(inputs, _PACKET, number, port, host, data)
        self._tcp.receive(lambda *message: _put(inputs, *message))

    def send(self, message: bytes) -> None:
        """Do what the board says. Raises SimulationError for a port that is taken."""
        kind, number, port, address = _HEAD.unpack_from(message)
        if not self.address:
            return
        if kind >= LISTEN:
            host = self._reached(address) if address else ""
            self._tcp.send(kind, number, port, host, message[_HEAD.size :])
        elif kind == _OPEN:
            self._open(number, port)
        elif kind == _CLOSE and number in self._sockets:
            self._sockets.pop(number).close()
        elif kind == _PACKET and number in self._sockets:
            with contextlib.suppress(OSError):  # nobody there: as on the air
                host = self._reached(address)
                target = (host, own_port(port) if host.startswith("127.") else port)
                self._sockets[number].sendto(message[_HEAD.size :], target)

    def close(self) -> None:
        """Close all sockets."""
        for one in self._sockets.values():
            one.close()
        self._sockets = {}
        self._tcp.close()

    def _open(self, number: int, port: int) -> None:
        one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        one.setblocking(False)
        try:
            one.bind((self.address, own_port(port)))
        except OSError as error:
            one.close()
            raise SimulationError(
                f"{self.name}: UDP port {own_port(port)} at {self.address} cannot be opened: "
                f"{error.strerror}"
            ) from None
        self._sockets[number] = one

    def _reached(self, address: int) -> str:
        text = str(ipaddress.IPv4Address(address.to_bytes(4, "little")))
        if ipaddress.IPv4Address(self.address).is_loopback:
            return text if text.startswith("127.") else "127.0.0.1"
        try:
            check_host("network: the board", text)
        except InputError as error:
            raise SimulationError(f"{self.name}: {error}") from None
        return text


def _put(inputs: Inputs, kind: int, number: int, port: int, host: str, data: bytes) -> None:
    head = _HEAD.pack(kind, number, port, _number(host) if host else 0)
    inputs.put_message(CHANNEL, head + data)


def _number(address: str) -> int:
    return int.from_bytes(ipaddress.IPv4Address(address).packed, "little")
