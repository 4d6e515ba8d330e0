"""TCP: a server with any number of clients, and a client that connects again."""

from __future__ import annotations

import contextlib
import errno
import select
import socket
import time
from collections.abc import Sequence
from typing import Any

from .budget import Budget
from .endpoint import Channel, Endpoint

MOST_CLIENTS = 16
LONGEST_QUEUE = 1 << 18
"""Bytes kept for a peer that does not read; frames beyond are lost."""
RETRY_S = 1.0
"""Wall time between two attempts to connect."""

_LIVENESS = {"TCP_KEEPIDLE": 2, "TCP_KEEPINTVL": 1, "TCP_KEEPCNT": 3, "TCP_USER_TIMEOUT": 10_000}
"""tcp(7): a connection whose peer acknowledges nothing is broken off after 10 s."""

_Address = tuple[str, int]


class _Stream(Channel):
    """One connection: whole frames are queued, or none of it."""

    def __init__(self, connected: socket.socket) -> None:
        connected.setblocking(False)
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket = connected
        self._queue = bytearray()
        self.is_open = True

    def send(self, data: bytes) -> None:
        if len(self._queue) + len(data) <= LONGEST_QUEUE:
            self._queue += data
            self._flush()

    def receive(self, most: int) -> bytes:
        """Return what has arrived; the stream is closed if its other end is."""
        self._flush()
        if not most:
            return b""
        try:
            data = self._socket.recv(most)
        except BlockingIOError:
            return b""
        except OSError:
            self.close()
            return b""
        if not data:
            self.close()
        return data

    def target(self) -> tuple[int, None]:
        return self._socket.fileno(), None

    def close(self) -> None:
        self.is_open = False
        self._socket.close()

    def _flush(self) -> None:
        if not self.is_open:
            return
        try:
            while self._queue:
                del self._queue[: self._socket.send(self._queue)]
        except BlockingIOError:
            pass
        except OSError:
            self.close()


def _read(streams: Sequence[_Stream], budget: Budget) -> list[tuple[Channel, bytes]]:
    """Return what has arrived; what is beyond the budget waits, in the end at the sender's."""
    arrived: list[tuple[Channel, bytes]] = []
    budget.renew(streams)
    for stream in streams:
        most = budget.left(stream)
        data = stream.receive(most) if stream.is_open else b""
        if data:
            budget.take(stream, len(data))
            arrived.append((stream, data))
        if most and len(data) == most:
            budget.exceed()
    return arrived


def _watch(opened: socket.socket) -> None:
    """Let the system notice that the other host is gone, where nothing comes or is sent."""
    opened.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in _LIVENESS.items():
        if hasattr(socket, option):  # Linux's
            opened.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


class TcpServer(Endpoint):
    """Accepts clients, up to `MOST_CLIENTS` at once."""

    peers = "connected"

    def __init__(self, address: _Address) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._socket.setblocking(False)
        try:
            self._socket.bind(address)
            self._socket.listen()
        except OSError:
            self._socket.close()
            raise
        host, port = self._socket.getsockname()
        self.url = f"tcpin:{host}:{port}"
        self._streams: list[_Stream] = []
        self.budget = Budget()

    def channels(self) -> Sequence[Channel]:
        """Return the clients that are connected."""
        return [stream for stream in self._streams if stream.is_open]

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Accept clients, and return what has arrived."""
        self._streams = [stream for stream in self._streams if stream.is_open]
        with contextlib.suppress(OSError):  # none, or one that has gone again
            while len(self._streams) < MOST_CLIENTS:
                self._streams.append(_Stream(self._socket.accept()[0]))
        return _read(self._streams, self.budget)

    def wait(self, timeout: float) -> bool:
        """Wait at most ``timeout`` (s, wall time); return whether bytes or a client are there."""
        waiting: list[Any] = [self._socket]
        waiting += [stream.target()[0] for stream in self._streams if stream.is_open]
        return bool(select.select(waiting, (), (), timeout)[0])

    def close(self) -> None:
        """Close the server and all connections."""
        for stream in self._streams:
            stream.close()
        self._socket.close()


class TcpClient(Endpoint):
    """Connects, and again every `RETRY_S` of wall time while there is no server."""

    def __init__(self, address: _Address) -> None:
        self.url = f"tcpout:{address[0]}:{address[1]}"
        self._address = address
        self._connecting: socket.socket | None = None
        self._stream: _Stream | None = None
        self._tried = -RETRY_S
        self.budget = Budget()

    def channels(self) -> Sequence[Channel]:
        """Return the server, if it is connected."""
        return [self._stream] if self._stream is not None and self._stream.is_open else []

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Connect if there is no connection, and return what has arrived."""
        if self._stream is None or not self._stream.is_open:
            self._connect()
        arrived = _read([self._stream] if self._stream is not None else [], self.budget)
        self.is_lost = self._stream is not None and not self._stream.is_open
        return arrived

    def close(self) -> None:
        """Close the connection."""
        self._give_up()
        if self._stream is not None:
            self._stream.close()

    def _connect(self) -> None:
        now = time.monotonic()
        if self._connecting is None:
            if now - self._tried < RETRY_S:
                return
            self._tried = now
            self._connecting = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
            self._connecting.setblocking(False)
            _watch(self._connecting)
        result = self._connecting.connect_ex(self._address)
        if result in (0, errno.EISCONN):
            self.reconnections += self._stream is not None
            self._stream, self._connecting = _Stream(self._connecting), None
        elif result not in (errno.EINPROGRESS, errno.EALREADY, errno.EWOULDBLOCK):
            self._give_up()

    def _give_up(self) -> None:
        if self._connecting is not None:
            self._connecting.close()
            self._connecting = None
