"""UDP endpoints: one known address, or any sender."""

from __future__ import annotations

import socket
from collections.abc import Sequence

from .endpoint import LARGEST_DATAGRAM, MOST_READS, Channel, Endpoint

MOST_PEERS = 16
"""Senders that a listener answers; a new one takes the place of the one silent longest."""

_Address = tuple[str, int]


class _UdpPeer(Channel):
    def __init__(self, opened: socket.socket, address: _Address | None = None) -> None:
        self._socket, self._address = opened, address

    def send(self, data: bytes) -> None:
        try:
            if self._address is None:
                self._socket.send(data)
            else:
                self._socket.sendto(data, self._address)
        except OSError:
            pass  # no receiver, or the queue is full: a datagram may be lost


class UdpSender(Endpoint):
    """Sends to one address from a port of its own; connected, so it receives that one alone."""

    def __init__(self, address: _Address) -> None:
        self.url = f"udpout:{address[0]}:{address[1]}"
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.connect(address)
        except OSError:
            self._socket.close()
            raise
        self._peers = [_UdpPeer(self._socket)]

    def channels(self) -> Sequence[Channel]:
        """Return the one peer."""
        return self._peers

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return the datagrams that have arrived."""
        arrived: list[tuple[Channel, bytes]] = []
        for _ in range(MOST_READS):
            try:
                arrived.append((self._peers[0], self._socket.recv(LARGEST_DATAGRAM)))
            except BlockingIOError:
                break
            except OSError:
                continue  # the answer to an earlier datagram: the port is closed
        return arrived

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class UdpListener(Endpoint):
    """Bound to an address; answers the latest senders, up to `MOST_PEERS`."""

    def __init__(self, address: _Address) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind(address)
        except OSError:
            self._socket.close()
            raise
        host, port = self._socket.getsockname()
        self.url = f"udpin:{host}:{port}"
        self._peers: dict[_Address, _UdpPeer] = {}
        """The last one is the one received last."""

    def channels(self) -> Sequence[Channel]:
        """Return the peers that are answered."""
        return list(self._peers.values())

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return the datagrams that have arrived, and know their senders."""
        arrived: list[tuple[Channel, bytes]] = []
        for _ in range(MOST_READS):
            try:
                data, address = self._socket.recvfrom(LARGEST_DATAGRAM)
            except BlockingIOError:
                break
            except OSError:
                continue
            arrived.append((self._known(address), data))
        return arrived

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def _known(self, address: _Address) -> Channel:
        peer = self._peers.pop(address, None) or _UdpPeer(self._socket, address)
        if len(self._peers) >= MOST_PEERS:
            del self._peers[next(iter(self._peers))]
        self._peers[address] = peer
        return peer
