"""Transport of a vehicle's messages over all its links."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from seatrial.links.endpoints.endpoint import Channel, Endpoint
from seatrial.links.safe_state import HeldChannels

from .codec import Codec, Message
from .signing import Signing
from .tlog import TelemetryLog

MESSAGE_COST = 40
"""Bytes that a message takes of its link's budget beside its own: so a flood of short ones is
some 1,300 a second, of which one takes some 25 us."""
_KEPT_S = 1.0


@dataclass(eq=False)
class Link:
    """One peer and the codec of its frames; ``number`` is never used again."""

    number: int
    channel: Channel
    codec: Codec
    admitted: bool
    """Whether something is sent to it."""


@dataclass(frozen=True)
class Sender:
    """Sender of a message: system, component and link."""

    system: int
    component: int
    link: int
    """Number of the link; answers go back over it."""


class Transport(Protocol):
    """Interface through which services send."""

    def links(self) -> Sequence[int]:
        """Return the numbers of the links that there are now."""

    def send(self, link: int, message: Message) -> None:
        """Send to one link; nothing happens if it is gone."""

    def broadcast(self, message: Message) -> None:
        """Send to all links."""


class EndpointTransport:
    """Endpoints, and a `Link` for each of their peers; ``log`` gets every frame.

    Sent to are the peers that a URL names, and those that may command the vehicle: with
    ``signing`` they have sent a frame with a good signature, without it they have connected, or
    have sent a message. ``name`` is the component's, for messages.
    """

    def __init__(
        self,
        endpoints: Sequence[Endpoint],
        system: int,
        component: int,
        signing: Signing | None,
        log: TelemetryLog,
        name: str = "mavlink",
    ) -> None:
        self.endpoints = list(endpoints)
        self._system, self._component, self._signing = system, component, signing
        self._log = log
        self._links: dict[Channel, Link] = {}
        self._made = 0
        self.refused = 0
        """Frames and runs of bytes that were no message, or had no signature that holds."""
        self._held = HeldChannels(name)
        self._kept_for, self._kept_until = set[Channel](), 0.0

    def links(self) -> Sequence[int]:
        """Return the numbers of the links that there are now."""
        return [link.number for link in self._links.values() if link.admitted]

    def poll(self) -> list[tuple[Message, Sender]]:
        """Return the messages that have arrived, in order per link."""
        arrived = []
        for endpoint in self.endpoints:
            for channel, data in endpoint.poll():
                link = self._link(channel, endpoint)
                before = link.codec.unusable
                messages = link.codec.decode(data)
                self.refused += link.codec.unusable - before
                endpoint.budget.charge(channel, len(messages), MESSAGE_COST)
                for message in messages:
                    link.admitted |= self._signing is None or message.get_signed()
                    self._log.write(message.get_msgbuf())
                    arrived.append((message, _sender(message, link)))
        self._reconcile()
        return arrived

    def send(self, link: int, message: Message) -> None:
        """Send to one link; nothing happens if it is gone."""
        for one in self._links.values():
            if one.number == link and one.admitted:
                self._transmit(one, message)

    def broadcast(self, message: Message) -> None:
        """Send to all links."""
        for link in self._links.values():
            if link.admitted:
                self._transmit(link, message)

    def keep_last(self, message: Message) -> None:
        """Hold a message for every link, for whoever supervises this process.

        Anew as peers come, and every second: signatures have times.
        """
        now, present = time.monotonic(), {c for c, link in self._links.items() if link.admitted}
        if present == self._kept_for and now < self._kept_until:
            return
        self._kept_for, self._kept_until = present, now + _KEPT_S
        self._held.keep(
            self.endpoints,
            lambda channel: (
                self._links[channel].codec.encode_last(message) if channel in present else b""
            ),
        )

    def close(self) -> None:
        """Close everything; the newest timestamp of signatures is kept."""
        self._held.release()
        for endpoint in self.endpoints:
            endpoint.close()
        if self._signing is not None:
            self._signing.save()

    def _transmit(self, link: Link, message: Message) -> None:
        frame = link.codec.encode(message)
        self._log.write(frame)
        link.channel.send(frame)

    def _reconcile(self) -> None:
        """Add the peers that have not sent anything, remove those that are gone."""
        self._links = {
            channel: self._link(channel, endpoint)
            for endpoint in self.endpoints
            for channel in endpoint.channels()
        }

    def _link(self, channel: Channel, endpoint: Endpoint) -> Link:
        if channel not in self._links:
            codec = Codec(self._system, self._component, self._made, self._signing)
            connected = endpoint.peers == "connected" and self._signing is None
            admitted = endpoint.peers == "named" or connected
            self._links[channel] = Link(self._made, channel, codec, admitted)
            self._made += 1
        return self._links[channel]


def _sender(message: Message, link: Link) -> Sender:
    return Sender(message.get_srcSystem(), message.get_srcComponent(), link.number)
