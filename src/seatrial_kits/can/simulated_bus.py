"""CAN bus in simulated time: arbitration, frame lengths, errors."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from .bits import INTERMISSION, TAIL, first_difference, length
from .controller import RECOVERY_SEQUENCES, Controller, Request
from .frame import Frame
from .operations import Error

PS = 10**12
"""Picoseconds in a second: bit times of all usual rates are whole."""
SEQUENCE_BITS = 11
"""Recessive bits that a node off the bus counts."""
SUSPENDED_BITS = 8
"""An error passive node lets others go first for so long after a frame of its own."""
ACTIVE_FLAG, LONGEST_FLAG = 6, 12
"""Error flags: of all nodes at once, and superposed where others react to the first."""
DELIMITER = 8
"""Recessive bits after error flags."""
ACKNOWLEDGED_BEFORE_END = 9
"""Bits of a frame from the acknowledgement on."""
STUFF_VIOLATION = 6
"""Equal bits in a row that are an error."""


class Sent(NamedTuple):
    """A frame that was on the bus, whole."""

    start_ps: int
    end_ps: int
    frame: Frame
    senders: list[int]
    """More than one if several sent the very same frame at once."""
    requested_ps: int
    """When the first of them requested it."""
    receivers: list[int]


class Broken(NamedTuple):
    """A frame that ended in an error frame."""

    end_ps: int
    frame: Frame
    senders: list[int]
    error: Error
    first: int
    """The node that noticed first."""


class GivenUp(NamedTuple):
    """A frame that lost an arbitration, of a node that does not wait."""

    when_ps: int
    node: int
    frame: Frame


class Disturbance(NamedTuple):
    """Error to inject into a frame: at which bit, and at which receiver, or everywhere."""

    bit: int
    receiver: int | None = None


ErrorInjector = Callable[[int, int, Frame, int], Disturbance | None]
"""Of attempt number, sender, frame and bits: what goes wrong, or None."""


@dataclass(slots=True)
class Attempt:
    """Transmission under way on the bus."""

    start_ps: int
    end_ps: int
    """Of the frame, or of the error frame that ends it."""
    frame: Frame
    senders: list[int]
    losers: list[int]
    """Nodes that lost the arbitration and do not wait."""
    gave_way: list[int]
    """Error passive nodes whose frame had the same arbitration field."""
    error: Error | None = None
    first: int = -1
    """Nodes that notice the error first."""
    missed_by: int = -1
    """A receiver that alone gets it wrong, and cannot stop it."""


@dataclass
class SimulatedBus:
    """Arbitration among controllers, frame by frame (ISO 11898-1).

    A bus that is idle is taken at once by the first request; when it becomes free, all that have a
    request start together and the lowest arbitration field goes through. A frame lasts as long as
    its bits, stuff bits included (`bits.length`), then come three bits of intermission. Its
    reception and its confirmation are at the end of the end of frame.

    **Errors.** A disturbed bit is seen by all nodes, which signal it from the next bit on: 6 bits
    of flag, 8 of delimiter, 3 of intermission. An error that one receiver alone sees is signalled
    by it and then by all others: 12 bits of flag. Passive nodes cannot interrupt others: a receiver
    among them just loses the frame. A frame that no node acknowledges is an error at the bit of the
    acknowledgement. The sender of a broken frame sends it again. Counters: sender + 8, receivers
    + 1, and + 8 more for one that noticed alone and first; not for a passive sender that misses an
    acknowledgement, which thus stays as it is. A sender that is unplugged leaves recessive bits,
    and the sixth is the others' error.

    **Two senders with one arbitration field** go on together until their bits differ: then that is
    an error of both, unless the recessive one is passive and has to give way.

    **Off the bus** a node counts sequences of 11 recessive bits: one after each frame, the rest
    while the bus is idle.

    Times are whole picoseconds; `run` reports to ``on_sent``, ``on_broken`` and ``on_given_up``
    what has ended, in order. The nodes that acknowledge a frame are settled at its start.
    """

    controllers: list[Controller]
    rate: int
    """bit/s."""
    data_rate: int
    """bit/s, of the data phase of CAN FD frames that switch."""
    error_injector: ErrorInjector = lambda *_: None
    on_sent: Callable[[Sent], None] = lambda _: None
    on_broken: Callable[[Broken], None] = lambda _: None
    on_given_up: Callable[[GivenUp], None] = lambda _: None
    now_ps: int = 0
    """Everything until here has happened."""
    free_ps: int = 0
    """When the next frame may start."""
    taken_ps: int = 0
    """Time until `free_ps` in which the bus was taken; see `busy_ps`."""
    attempts: int = 0
    requests: int = 0
    counted_ps: int = 0
    """Until when recessive bits were counted for nodes off the bus."""
    attempt: Attempt | None = None
    arriving: list[tuple[int, int, int, Request]] = field(default_factory=list)
    """Requests of the future: (when, number, node, request), a heap."""

    def __post_init__(self) -> None:
        self._bit, self._data_bit = round(PS / self.rate), round(PS / self.data_rate)

    @property
    def busy_ps(self) -> int:
        """Time that frames, error frames and intermissions have taken until now."""
        return self.taken_ps - max(0, self.free_ps - self.now_ps)

    def request(self, when_ps: int, node: int, frame: Frame) -> None:
        """Request a frame, not before ``when_ps`` nor in the past."""
        self.requests += 1
        when = max(when_ps, self.now_ps)
        request = Request(frame.priority, self.requests, when, frame)
        heapq.heappush(self.arriving, (when, self.requests, node, request))

    def run(self, until_ps: int) -> None:
        """Let everything happen that ends by ``until_ps`` or begins before it."""
        while True:
            if self.attempt is not None:
                if self.attempt.end_ps > until_ps:
                    break
                self._arrive(self.attempt.end_ps)
                self._end(self.attempt)
            start = self._next_start(until_ps)
            if start is None:
                break
            self._begin(start)
        if self.attempt is None:
            self._idle(until_ps)
        self._arrive(until_ps - 1)  # at that very time, faults of that time count already
        self.now_ps = max(self.now_ps, until_ps)

    def unplug(self, node: int) -> None:
        """Take a node off the bus now; a frame that it sends is cut."""
        self.controllers[node].unplug()
        attempt = self.attempt
        if attempt is None or node not in attempt.senders:
            return
        attempt.senders.remove(node)
        if not attempt.senders:
            cut = self.now_ps + (STUFF_VIOLATION + ACTIVE_FLAG + DELIMITER) * self._bit
            self.taken_ps -= self.free_ps - attempt.start_ps
            attempt.error, attempt.first = Error.STUFF, -1
            attempt.end_ps = min(attempt.end_ps, cut)
            self._take(attempt)

    def plug(self, node: int) -> None:
        """Let a node take part from now on, error active."""
        self.controllers[node].restart(self.now_ps)

    # ------------------------------------------------------------------ when

    def _next_start(self, until_ps: int) -> int | None:
        """Return when the next frame starts, or None if none does before ``until_ps``."""
        t = max(self.free_ps, self.now_ps)
        while t < until_ps:
            self._idle(t)
            self._arrive(t)
            later = []
            for each in self.controllers:
                if (each.ready or each.babbles) and each.takes_part:
                    if each.suspended_until_ps <= t:
                        return t
                    later.append(each.suspended_until_ps)
                elif each.babbles and each.off and each.recovers and each.plugged:
                    missing = RECOVERY_SEQUENCES - each.sequences
                    later.append(self.counted_ps + missing * SEQUENCE_BITS * self._bit)
            if self.arriving:
                later.append(self.arriving[0][0])
            if not later:
                return None
            t = min(later)
        return None

    def _arrive(self, until_ps: int) -> None:
        arriving = self.arriving
        while arriving and arriving[0][0] <= until_ps:
            _, _, node, request = heapq.heappop(arriving)
            self.controllers[node].request(request)

    def _idle(self, until_ps: int) -> None:
        """Let the bus be idle until then: nodes off the bus count recessive bits."""
        sequence = SEQUENCE_BITS * self._bit
        count = (until_ps - self.counted_ps) // sequence
        if count > 0:
            self._count_sequences(count)
            self.counted_ps += count * sequence

    def _count_sequences(self, count: int) -> None:
        """Let nodes off the bus count ``count`` sequences from `counted_ps` on."""
        for each in self.controllers:
            if each.off and each.recovers:
                missing = RECOVERY_SEQUENCES - each.sequences
                each.sequences += count
                if missing <= count and each.plugged:
                    each.restart(self.counted_ps + missing * SEQUENCE_BITS * self._bit)

    # ------------------------------------------------------------------ a frame begins

    def _begin(self, start: int) -> None:
        """Put the frame that starts now onto the bus, and settle how it ends."""
        self.attempts += 1
        senders, losers = self._arbitrate(start)
        frames = {node: self.controllers[node].begin(start) for node in senders}
        gave_way: list[int] = []
        bit = self._collide(senders, gave_way, frames) if len(senders) > 1 else None
        frame = frames[senders[0]]
        attempt = Attempt(start, 0, frame, senders, losers, gave_way)
        for node in losers:
            self.controllers[node].begin(start)
        bits = length(frame)
        if bit is not None:
            self._fail(attempt, Disturbance(bit), Error.BIT, LONGEST_FLAG)
        elif not self._disturbed(attempt, sum(bits)):
            if self._is_received(attempt):
                attempt.end_ps = start + bits.nominal * self._bit + bits.data * self._data_bit
            else:
                unheard = Disturbance(sum(bits) - ACKNOWLEDGED_BEFORE_END)
                self._fail(attempt, unheard, Error.ACK, ACTIVE_FLAG)
        self._take(attempt)

    def _arbitrate(self, start: int) -> tuple[list[int], list[int]]:
        """Return the senders, and the losers that do not wait for another time."""
        best, senders, impatient = 1 << 32, [], []
        for node, each in enumerate(self.controllers):
            if not (each.ready or each.babbles) or not each.takes_part:
                continue
            if each.suspended_until_ps <= start:
                priority = each.priority
                if priority < best:
                    best, senders = priority, [node]
                elif priority == best:
                    senders.append(node)
                if not each.waits:
                    impatient.append(node)
        return senders, [node for node in impatient if node not in senders]

    def _disturbed(self, attempt: Attempt, bits: int) -> bool:
        """Draw what goes wrong; return whether that ends the frame."""
        wrong = self.error_injector(self.attempts, attempt.senders[0], attempt.frame, bits)
        if wrong is None:
            return False
        if wrong.receiver is None:
            self._fail(attempt, wrong, Error.BIT, ACTIVE_FLAG)
            return True
        receiver = self.controllers[wrong.receiver]
        if receiver.takes_part and not receiver.passive:
            self._fail(attempt, wrong, Error.CRC, LONGEST_FLAG)
            return True
        attempt.missed_by = wrong.receiver
        return False

    def _is_received(self, attempt: Attempt) -> bool:
        """Return whether any node acknowledges the frame."""
        silent = (*attempt.senders, *attempt.gave_way, attempt.missed_by)
        for node, each in enumerate(self.controllers):
            if each.back_ps <= attempt.start_ps and not each.listens_only and node not in silent:
                return True
        return False

    def _collide(
        self, senders: list[int], gave_way: list[int], frames: dict[int, Frame]
    ) -> int | None:
        """Return the bit at which senders of one arbitration field break each other's frames.

        None if they do not: their frames are the same, or those that would notice are passive
        and give way; they are then no longer among ``senders``.
        """
        while len(senders) > 1:
            first = frames[senders[0]]
            other = next((node for node in senders if frames[node] != first), None)
            if other is None:
                return None
            bit, first_recessive = first_difference(first, frames[other])
            recessive = senders[0] if first_recessive else other
            if not self.controllers[recessive].passive:
                return bit
            senders.remove(recessive)
            gave_way.append(recessive)
        return None

    def _fail(self, attempt: Attempt, wrong: Disturbance, error: Error, flag: int) -> None:
        """Let the frame end in an error frame."""
        until = self._until(attempt.frame, wrong.bit + 1)
        attempt.end_ps = attempt.start_ps + until + (flag + DELIMITER) * self._bit
        attempt.error = error
        attempt.first = attempt.senders[0] if wrong.receiver is None else wrong.receiver

    def _until(self, frame: Frame, count: int) -> int:
        """Return how long the first ``count`` bits of a frame last, ps."""
        nominal, data = length(frame)
        fast = min(count - min(count, nominal - TAIL), data)
        return (count - fast) * self._bit + fast * self._data_bit

    def _take(self, attempt: Attempt) -> None:
        """Keep the bus taken until the intermission is over."""
        self.attempt = attempt
        self.free_ps = attempt.end_ps + INTERMISSION * self._bit
        self.taken_ps += self.free_ps - attempt.start_ps

    # ------------------------------------------------------------------ a frame ends

    def _end(self, attempt: Attempt) -> None:
        self.attempt = None
        self.counted_ps = self.free_ps - SEQUENCE_BITS * self._bit
        self._count_sequences(1)
        self.counted_ps = self.free_ps
        for node in attempt.gave_way:
            if self.controllers[node].plugged:
                self._failed(node, 8)
        if attempt.error is None:
            self._succeed(attempt)
        else:
            self._break(attempt, attempt.error)
        for node in attempt.losers:
            request = self.controllers[node].sending
            if request is not None:
                self.controllers[node].give_up()
                self.on_given_up(GivenUp(attempt.end_ps, node, request.frame))

    def _succeed(self, attempt: Attempt) -> None:
        start, senders, missed_by = attempt.start_ps, attempt.senders, attempt.missed_by
        requested, receivers = start, []
        for node in senders:
            each = self.controllers[node]
            requested = min(requested, each.sent_one().requested_ps)
            self._suspend(each)
        apart = (*senders, *attempt.gave_way)
        for node, each in enumerate(self.controllers):
            if each.back_ps > start or node in apart:
                continue
            if node == missed_by:
                each.lost += 1
                each.failed_to_receive(0 if each.listens_only else 1)
                continue
            each.received += 1
            if each.rec:
                each.recover()
            receivers.append(node)
        self.on_sent(Sent(start, attempt.end_ps, attempt.frame, senders, requested, receivers))

    def _break(self, attempt: Attempt, error: Error) -> None:
        apart = {*attempt.senders, *attempt.gave_way}
        for node, each in enumerate(self.controllers):
            if node in attempt.senders:
                self._failed(node, 0 if error is Error.ACK and each.passive else 8)
            elif each.back_ps <= attempt.start_ps and not each.listens_only and node not in apart:
                each.failed_to_receive(9 if node == attempt.first else 1)
        self.on_broken(Broken(attempt.end_ps, attempt.frame, attempt.senders, error, attempt.first))

    def _failed(self, node: int, more: int) -> None:
        each = self.controllers[node]
        each.failed_to_send(more)
        self._suspend(each)

    def _suspend(self, each: Controller) -> None:
        if each.passive:
            each.suspended_until_ps = self.free_ps + SUSPENDED_BITS * self._bit
