"""Endpoint interface: peers are found and polled.

A package adds a kind of link by an entry point, whose name is the scheme of its URLs and whose
object is called with the URL and returns an `Endpoint`::

    [project.entry-points."seatrial.transports"]
    "acoustic" = "my_package.modem:AcousticEndpoint"

``links = "acoustic:7:/dev/ttyUSB0"`` then opens ``AcousticEndpoint("acoustic:7:/dev/ttyUSB0")``.

1. **The URL** has no spaces; what follows its first colon is the kind's own. The object raises
   InputError, with the URL, what was found and what is allowed, for one that is malformed, and
   InputError or OSError for one that cannot be opened.
2. **Nothing waits**: every call returns at once (``wait`` of `udp.UdpListener` and
   `tcp.TcpServer` is for lockstep alone).
   Connecting, accepting and trying again go on inside `Endpoint.poll`, which takes in what its
   `budget.Budget` allows: what is more waits where it is, or is lost if it came as datagrams.
3. **After it is open nothing raises** for what the other end does. Peers come and go, bytes that
   do not fit are lost; queues are bounded.
4. **One channel object stands for one peer** for as long as it is there: protocols keep what they
   know of a peer by it. Each piece that `Endpoint.poll` returns is of one channel; where the
   transport has frames, one piece is one frame.
5. **It asks** `seatrial.links.hardware` before it opens anything: `check_serial_port` for a device,
   `check_host` and `check_listening` for an IP address. These raise InputError for what was not
   allowed.
6. **It closes** everything it opened in `Endpoint.close`, which is called once; a failing
   constructor leaves nothing open.
7. In an FMU the package must be installed where the FMU runs: entry points do not travel with it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Literal, Protocol

from .budget import Budget

LARGEST_DATAGRAM = 65536


class Reached(Protocol):
    """Report of a component on an endpoint, or on a gateway."""

    budget: Budget
    is_lost: bool
    reconnections: int


def report(component: Any, reached: Sequence[Reached]) -> None:
    """Set the outputs of a `Reachable` component that say how its links do."""
    component.exceeded = sum(each.budget.exceeded for each in reached)
    component.link_lost = any(each.is_lost for each in reached)
    component.reconnections = sum(each.reconnections for each in reached)


class Channel(ABC):
    """One peer behind an endpoint: bytes come from it and go to it."""

    @abstractmethod
    def send(self, data: bytes) -> None:
        """Send one frame; it is lost silently if the peer takes no more or is gone."""

    def close(self) -> None:  # noqa: B027  most have no connection
        """End the connection to the peer, where there is one."""

    def target(self) -> tuple[int, tuple[str, int] | None] | None:
        """Return the descriptor that leads to the peer, and the address of a datagram.

        Whoever supervises this process sends a safe state through it, if this process ends
        without doing so. None if there is no such descriptor: then nobody can.
        """
        return None


class Endpoint(ABC):
    """One URL. What has gone wrong on the way is no error here: protocols repeat themselves."""

    url: str
    """As it is bound: with the port's number where 0 was given."""

    budget = Budget()
    """Budget of one poll: each object sets its own, unless it has another bound."""

    is_lost = False
    """Whether what the URL names was there and is gone. Where peers come and go, none is lost."""
    reconnections = 0
    """Number of reconnections."""

    peers: Literal["named", "connected", "senders"] = "named"
    """Peers: those that the URL names, all that connect, or all that send bytes."""

    @abstractmethod
    def channels(self) -> Sequence[Channel]:
        """Return the peers that there are now."""

    @abstractmethod
    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return what has arrived, in order; connect and accept on the way."""

    @abstractmethod
    def close(self) -> None:
        """Let go of sockets and ports."""
