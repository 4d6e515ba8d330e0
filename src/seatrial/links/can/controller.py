"""One node's CAN controller: what waits to be sent, and how much it is to be trusted."""

from __future__ import annotations

import heapq
from collections import deque
from dataclasses import dataclass, field

from .frame import Frame
from .operations import State

PASSIVE_FROM = 128
"""An error counter of so much makes a node error passive."""
BUS_OFF_ABOVE = 255
"""A transmit error counter above this takes a node off the bus."""
RECOVERY_SEQUENCES = 128
"""Sequences of 11 recessive bits that a node off the bus waits for."""


@dataclass(slots=True, order=True)
class Request:
    """A frame that waits to be sent: lower comes first."""

    priority: int
    number: int
    """Counts all requests of the bus: equal identifiers are sent in order; 0 for noise."""
    asked_ps: int = field(compare=False)
    """When it was asked for."""
    frame: Frame = field(compare=False)


@dataclass(slots=True)
class Controller:
    """Queue, mailboxes and error counters of one node (ISO 11898-1, fault confinement).

    Requests wait in a queue, first come, first served, and go on to one of ``mailboxes`` as soon
    as one is free; of those the controller sends the one with the highest priority. With a single
    mailbox an urgent frame waits behind others that are not.
    """

    name: str
    queue_length: int
    """Most requests in the queue; one more is dropped."""
    mailboxes: int
    listens_only: bool = False
    """It neither sends nor acknowledges nor signals errors."""
    recovers: bool = True
    """It comes back from bus-off."""

    plugged: bool = True
    """On the bus."""
    babbles: bool = False
    """It sends frames of the highest priority all the time."""
    tec: int = 0
    """Transmit error counter."""
    rec: int = 0
    """Receive error counter."""
    off: bool = False
    """Bus-off."""
    sequences: int = 0
    """Off the bus: sequences of 11 recessive bits seen since."""
    suspended_until_ps: int = 0
    """Error passive: no start before this, after a frame of its own."""
    queue: deque[Request] = field(default_factory=deque)
    ready: list[Request] = field(default_factory=list)
    """The mailboxes, a heap."""
    sent: int = 0
    received: int = 0
    lost: int = 0
    """Frames that were on the bus and did not get through to this node."""
    dropped: int = 0
    """Requests that found the queue full, or the node off the bus."""
    errors: int = 0
    """Frames of its own that ended in an error."""

    @property
    def state(self) -> State:
        """State of fault confinement."""
        if self.off:
            return State.BUS_OFF
        if self.tec >= PASSIVE_FROM or self.rec >= PASSIVE_FROM:
            return State.ERROR_PASSIVE
        return State.ERROR_ACTIVE

    @property
    def passive(self) -> bool:
        """Error passive."""
        return self.state is State.ERROR_PASSIVE

    @property
    def takes_part(self) -> bool:
        """Acknowledges and signals errors."""
        return self.plugged and not self.off and not self.listens_only

    @property
    def waiting(self) -> int:
        """Requests that wait."""
        return len(self.queue) + len(self.ready)

    def ask(self, request: Request) -> None:
        """Take a request in, or drop it."""
        if not self.takes_part:
            self.dropped += 1
        elif len(self.ready) < self.mailboxes:
            heapq.heappush(self.ready, request)
        elif len(self.queue) < self.queue_length:
            self.queue.append(request)
        else:
            self.dropped += 1

    def sent_one(self) -> Request:
        """Take the request that was sent out of its mailbox."""
        request = heapq.heappop(self.ready)
        if self.queue:
            heapq.heappush(self.ready, self.queue.popleft())
        self.sent += 1
        self.tec = max(0, self.tec - 1)
        return request

    def got_one(self) -> None:
        """Count a frame that came through."""
        self.received += 1
        if self.rec:
            # Above 127 ISO 11898-1 leaves the choice from 119 to 127.
            self.rec = min(self.rec, PASSIVE_FROM) - 1

    def failed_to_send(self, more: int = 8) -> None:
        """Count an error in a frame of its own; too many take it off the bus."""
        self.errors += 1
        self.tec += more
        if self.tec > BUS_OFF_ABOVE:
            self.tec, self.off, self.sequences = BUS_OFF_ABOVE + 1, True, 0
            self.forget()

    def failed_to_receive(self, more: int = 1) -> None:
        """Count an error in somebody else's frame."""
        self.rec = min(self.rec + more, BUS_OFF_ABOVE)

    def recover(self, sequences: int) -> None:
        """Count sequences of 11 recessive bits; enough of them end a bus-off."""
        if self.off and self.recovers:
            self.sequences += sequences
            if self.sequences >= RECOVERY_SEQUENCES:
                self.restart()

    def restart(self) -> None:
        """Begin anew, error active."""
        self.off, self.tec, self.rec, self.sequences = False, 0, 0, 0

    def unplug(self) -> None:
        """Leave the bus; what waited is dropped."""
        self.plugged = False
        self.forget()

    def plug(self) -> None:
        """Come back, error active."""
        self.plugged = True
        self.restart()

    def forget(self) -> None:
        """Drop what waits."""
        self.dropped += self.waiting
        self.queue.clear()
        self.ready.clear()
