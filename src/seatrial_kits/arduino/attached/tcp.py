"""TCP of a board's WiFi: its servers and connections are sockets of this machine."""

from __future__ import annotations

import errno
import socket
from collections.abc import Callable
from dataclasses import dataclass

from seatrial.errors import SimulationError

LISTEN, ACCEPT, CONNECT, DATA, TAKEN, SHUT = range(4, 10)
"""Kinds of messages: see ``esp32/network.h``."""
_WINDOW = 5744
"""Bytes at most that wait on the board, as its IP stack has them; more stay in the socket."""
_SEGMENT = 1436
_FIRST_ACCEPTED, _LAST = 128, 255
_LOWEST, _MOVED = 1024, 8000
"""Ports below need a privilege: 80 is 8080 here."""

Put = Callable[[int, int, int, str, bytes], None]
"""Gives the board a message: kind, socket, port, address, data."""


@dataclass
class _Connection:
    socket: socket.socket
    opened: bool
    unread: int = 0
    """Bytes that the board has not taken."""
    waiting: bytes = b""
    """What the board sent and the socket has not taken."""
    ending: bool = False
    """Closed by the board: ends when nothing waits."""


class Tcp:
    """Servers and connections of board ``name`` at ``address``.

    Raises SimulationError for a port that is taken.
    """

    def __init__(self, name: str, address: str) -> None:
        self.name, self.address = name, address
        self._servers: dict[int, socket.socket] = {}
        self._connections: dict[int, _Connection] = {}

    def send(self, kind: int, number: int, port: int, host: str, data: bytes) -> None:
        """Do what the board says."""
        one = self._connections.get(number)
        if kind == LISTEN:
            self._listen(number, port)
        elif kind == CONNECT:
            self._connect(number, host, port)
        elif kind == SHUT and number in self._servers:
            self._servers.pop(number).close()
        elif one and kind == DATA:
            one.waiting += data
        elif one and kind == TAKEN:
            one.unread -= port
        elif one and kind == SHUT:
            one.ending = True

    def receive(self, put: Put) -> None:
        """Put before the board who connects and what has come; hand on what it sent."""
        for number, server in self._servers.items():
            self._accept(number, server, put)
        for number, one in list(self._connections.items()):
            alive = self._settle(number, one, put) and self._flush(one)
            if alive and one.opened and not one.ending:
                alive = self._read(number, one, put)
            if not alive or (one.ending and not one.waiting):
                self._connections.pop(number).socket.close()
                if not one.ending:
                    put(SHUT, number, 0, "", b"")

    def close(self) -> None:
        """Close all; what the board has sent goes out as far as it can at once."""
        for one in self._connections.values():
            self._flush(one)
        for each in (*self._servers.values(), *(one.socket for one in self._connections.values())):
            each.close()
        self._servers, self._connections = {}, {}

    def _listen(self, number: int, port: int) -> None:
        server = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        server.setblocking(False)
        server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            server.bind((self.address, own_port(port)))
            server.listen()
        except OSError as error:
            server.close()
            raise SimulationError(
                f"{self.name}: TCP port {own_port(port)} at {self.address} cannot be opened: "
                f"{error.strerror}"
            ) from None
        self._servers[number] = server

    def _connect(self, number: int, host: str, port: int) -> None:
        one = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        one.setblocking(False)
        one.bind((self.address, 0))
        one.connect_ex((host, own_port(port) if host.startswith("127.") else port))
        self._connections[number] = _Connection(one, opened=False)

    def _accept(self, number: int, server: socket.socket, put: Put) -> None:
        try:
            made, (host, port) = server.accept()
        except OSError:
            return
        made.setblocking(False)
        free = range(_FIRST_ACCEPTED, _LAST + 1)
        new = next((each for each in free if each not in self._connections), None)
        if new is None:
            made.close()
            return
        self._connections[new] = _Connection(made, opened=True)
        put(ACCEPT, new, port, host, bytes([number]))

    @staticmethod
    def _settle(number: int, one: _Connection, put: Put) -> bool:
        """Tell the board that a connection is open; return whether it is or may become so."""
        if one.opened:
            return True
        try:
            one.socket.getpeername()
        except OSError as error:
            refused = one.socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
            return error.errno == errno.ENOTCONN and not refused
        one.opened = True
        put(CONNECT, number, one.socket.getsockname()[1], "", b"")
        return True

    @staticmethod
    def _flush(one: _Connection) -> bool:
        """Send what waits; return whether the connection is there yet."""
        try:
            while one.opened and one.waiting:
                one.waiting = one.waiting[one.socket.send(one.waiting) :]
        except BlockingIOError:
            pass
        except OSError:
            return False
        return True

    @staticmethod
    def _read(number: int, one: _Connection, put: Put) -> bool:
        """Put before the board what it has room for; return whether more may come."""
        try:
            while (room := min(_WINDOW - one.unread, _SEGMENT)) > 0:
                data = one.socket.recv(room)
                if not data:
                    return False
                one.unread += len(data)
                put(DATA, number, 0, "", data)
        except BlockingIOError:
            pass
        except OSError:
            return False
        return True


def own_port(port: int) -> int:
    """Return the port here that a board's port is."""
    return port + _MOVED if 0 < port < _LOWEST else port
