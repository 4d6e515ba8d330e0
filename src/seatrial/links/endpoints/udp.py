"""UDP endpoints: one known address, or any sender."""

from __future__ import annotations

import contextlib
import select
import socket
import sys
from collections.abc import Iterator, Sequence

from .budget import Budget
from .endpoint import LARGEST_DATAGRAM, Channel, Endpoint

MOST_PEERS = 16
"""Senders that a listener answers; a new one takes the place of the one silent longest."""
MOST_NEW = 8
"""Senders that one poll gets to know; more wait for the next."""
MOST_READS = 128
"""Datagrams read from one socket in one poll: empty ones take nothing of a budget."""

_Address = tuple[str, int]


class _UdpPeer(Channel):
    """One address, through a socket of its own or one that several share."""

    def __init__(self, opened: socket.socket, address: _Address, owned: bool = True) -> None:
        self.socket, self._address, self._owned = opened, address, owned

    def send(self, data: bytes) -> None:
        with contextlib.suppress(OSError):  # no receiver, or a full queue: a datagram may be lost
            if self._owned:
                self.socket.send(data)
            else:
                self.socket.sendto(data, self._address)

    def target(self) -> tuple[int, _Address | None]:
        return self.socket.fileno(), None if self._owned else self._address

    def close(self) -> None:
        if self._owned:
            self.socket.close()


def _of_peer(peer: _UdpPeer, budget: Budget) -> list[tuple[Channel, bytes]]:
    """Read from a peer's own socket what it may bring; the rest waits in the system's queue."""
    found: list[tuple[Channel, bytes]] = []
    waiting = _datagrams(peer.socket)
    while budget.left(peer):
        data, _ = next(waiting, (None, None))
        if data is None:
            return found
        budget.take(peer, len(data))
        found.append((peer, data))
    with contextlib.suppress(OSError):
        peer.socket.recv(1, socket.MSG_PEEK)
        budget.exceed()
    return found


def _datagrams(opened: socket.socket) -> Iterator[tuple[bytes, _Address]]:
    """Read what has arrived at a socket, up to `MOST_READS`."""
    for _ in range(MOST_READS):
        try:
            yield opened.recvfrom(LARGEST_DATAGRAM)
        except BlockingIOError:
            return
        except OSError:
            continue  # the answer to an earlier datagram: the port is closed


def _socket() -> socket.socket:
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    opened.setblocking(False)
    return opened


class UdpSender(Endpoint):
    """Sends to one address from a port of its own; connected, so it receives that one alone."""

    def __init__(self, address: _Address) -> None:
        self.url = f"udpout:{address[0]}:{address[1]}"
        self.budget = Budget()
        opened = _socket()
        try:
            opened.connect(address)
        except OSError:
            opened.close()
            raise
        self._peers = [_UdpPeer(opened, address)]

    def channels(self) -> Sequence[Channel]:
        """Return the one peer."""
        return self._peers

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return the datagrams that have arrived."""
        self.budget.renew(self._peers)
        return _of_peer(self._peers[0], self.budget)

    def close(self) -> None:
        """Close the socket."""
        self._peers[0].close()


class UdpListener(Endpoint):
    """Bound to an address; answers the latest senders, up to `MOST_PEERS`.

    Each has a socket of its own at the same port (on Linux): the system keeps a queue for each,
    so that one that floods fills its own alone.
    """

    peers = "senders"

    def __init__(self, address: _Address) -> None:
        self._socket = _socket()
        self.budget = Budget()
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
        self.budget.renew(self._peers.values())
        for address, peer in list(self._peers.items()):
            if peer.socket is not self._socket:
                found = _of_peer(peer, self.budget)
                arrived += found
                if found:
                    self._known(address)
        new = 0
        for data, address in _datagrams(self._socket):
            new += address not in self._peers
            peer = self._known(address)
            if self.budget.take(peer, len(data)):
                arrived.append((peer, data))
            if new == MOST_NEW:
                self.budget.exceed()
                break
        return arrived

    def wait(self, timeout: float) -> bool:
        """Wait for a datagram, at most ``timeout`` (s, wall time); return whether one is there."""
        sockets = {self._socket, *(peer.socket for peer in self._peers.values())}
        return bool(select.select(sockets, (), (), timeout)[0])

    def close(self) -> None:
        """Close the sockets."""
        for peer in self._peers.values():
            peer.close()
        self._socket.close()

    def _known(self, address: _Address) -> _UdpPeer:
        peer = self._peers.pop(address, None) or self._made(address)
        if len(self._peers) >= MOST_PEERS:
            self._peers.pop(next(iter(self._peers))).close()
        self._peers[address] = peer
        return peer

    def _made(self, address: _Address) -> _UdpPeer:
        if sys.platform != "linux":
            return _UdpPeer(self._socket, address, owned=False)
        opened = _socket()
        try:
            # Both must agree to share the port, for as long as it takes: nobody else may.
            self._share_port(opened, 1)
            opened.bind(self._socket.getsockname())
            opened.connect(address)
            return _UdpPeer(opened, address)
        except OSError:
            opened.close()
            return _UdpPeer(self._socket, address, owned=False)
        finally:
            with contextlib.suppress(OSError):
                self._share_port(opened, 0)

    def _share_port(self, opened: socket.socket, shared: int) -> None:
        for each in (self._socket, opened):
            each.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, shared)
