"""CAN controller of one node: transmit queue and error counters."""

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
NOISE = Frame(0, bytes(8))
"""What a babbling node sends."""
_BEFORE_ALL = -1
"""Its priority: nothing goes before it."""
NEVER = 1 << 62
"""Later than any simulated time, ps."""


@dataclass(slots=True, order=True)
class Request:
    """A frame that waits to be sent: lower comes first."""

    priority: int
    number: int
    """Counts all requests of the bus: equal identifiers are sent in order; 0 for noise."""
    requested_ps: int = field(compare=False)
    """When it was requested."""
    frame: Frame = field(compare=False)


@dataclass(slots=True)
class Controller:
    """Queue, mailboxes and error counters of one node (ISO 11898-1, fault confinement).

    Requests wait in a queue, first come, first served, and go on to one of ``mailboxes`` as soon
    as one is free; of those the controller sends the one with the highest priority. With a single
    mailbox an urgent frame waits behind others that are not. A frame keeps its mailbox until it
    is sent.
    """

    name: str
    queue_length: int
    """Most requests in the queue; one more is dropped."""
    mailboxes: int
    listens_only: bool = False
    """It neither sends nor acknowledges nor signals errors."""
    recovers: bool = True
    """It comes back from bus-off."""

    waits: bool = True
    """A frame that loses an arbitration stays in its mailbox; else it is given up."""
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
    back_ps: int = 0
    """When it last came onto the bus: it receives what began since. `NEVER` while it is off it."""
    suspended_until_ps: int = 0
    """Error passive: no start before this, after a frame of its own."""
    queue: deque[Request] = field(default_factory=deque)
    ready: list[Request] = field(default_factory=list)
    """The mailboxes, a heap, without the one that is being sent."""
    sending: Request | None = None
    """What is on the bus."""
    asked: int = 0
    """Requests."""
    sent: int = 0
    """Frames sent, noise included."""
    received: int = 0
    lost: int = 0
    """Frames that were on the bus and did not get through to this node."""
    dropped: int = 0
    """Requests that found no place, or were given up."""

    @property
    def state(self) -> State:
        """State of fault confinement."""
        if self.off:
            return State.BUS_OFF
        return State.ERROR_PASSIVE if self.passive else State.ERROR_ACTIVE

    @property
    def passive(self) -> bool:
        """Error passive."""
        return not self.off and (self.tec >= PASSIVE_FROM or self.rec >= PASSIVE_FROM)

    @property
    def takes_part(self) -> bool:
        """Acknowledges and signals errors."""
        return self.plugged and not self.off and not self.listens_only

    @property
    def waiting(self) -> int:
        """Requests that wait, the one on the bus among them."""
        return len(self.queue) + self._occupied

    @property
    def priority(self) -> int:
        """Of what it would send next; it must have something."""
        return _BEFORE_ALL if self.babbles else self.ready[0].priority

    def request(self, request: Request) -> None:
        """Take a request in, or drop it."""
        self.asked += 1
        if self.listens_only or request.requested_ps < self.back_ps:
            self.dropped += 1
        elif self._occupied < self.mailboxes:
            heapq.heappush(self.ready, request)
        elif len(self.queue) < self.queue_length:
            self.queue.append(request)
        else:
            self.dropped += 1

    def begin(self, now_ps: int) -> Frame:
        """Start to send; return the frame."""
        if self.babbles:
            self.sending = Request(_BEFORE_ALL, 0, now_ps, NOISE)
        else:
            self.sending = heapq.heappop(self.ready)
        return self.sending.frame

    def sent_one(self) -> Request:
        """End what it sends with success; return it."""
        request = self._end()
        self.sent += 1
        self.tec = max(0, self.tec - 1)
        return request

    def give_up(self) -> None:
        """End what it sends without success, and do not repeat it."""
        if self._end().number:
            self.dropped += 1

    def lose(self) -> None:
        """Keep what it sends for later."""
        request, self.sending = self.sending, None
        if request is not None and request.number:
            heapq.heappush(self.ready, request)

    def recover(self) -> None:
        """Count a frame that came through against the errors received."""
        # Above 127 ISO 11898-1 leaves the choice from 119 to 127.
        self.rec = min(self.rec, PASSIVE_FROM) - 1

    def failed_to_send(self, more: int = 8) -> None:
        """Count an error in a frame of its own; too many take it off the bus."""
        self.lose()
        self.tec += more
        if self.tec > BUS_OFF_ABOVE:
            self.tec, self.off, self.sequences = BUS_OFF_ABOVE + 1, True, 0
            self.back_ps = NEVER
            self.forget()

    def failed_to_receive(self, more: int = 1) -> None:
        """Count an error in another node's frame."""
        self.rec = min(self.rec + more, BUS_OFF_ABOVE)

    def unplug(self) -> None:
        """Leave the bus; what waited is dropped."""
        self.plugged, self.back_ps = False, NEVER
        self.forget()

    def restart(self, now_ps: int) -> None:
        """Come back, error active."""
        self.plugged, self.off, self.back_ps = True, False, now_ps
        self.tec = self.rec = self.sequences = 0

    def forget(self) -> None:
        """Drop what waits."""
        self.dropped += self.waiting
        self.queue.clear()
        self.ready.clear()
        self.sending = None

    @property
    def _occupied(self) -> int:
        own = self.sending is not None and self.sending.number > 0
        return len(self.ready) + own

    def _end(self) -> Request:
        request, self.sending = self.sending, None
        assert request is not None
        if self.queue and self._occupied < self.mailboxes:
            heapq.heappush(self.ready, self.queue.popleft())
        return request
