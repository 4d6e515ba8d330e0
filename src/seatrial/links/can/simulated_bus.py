"""A CAN bus in simulated time: who sends next, how long it takes, what goes wrong."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from .bits import INTERMISSION, TAIL, Length, first_difference, length
from .controller import Controller, Request
from .frame import Frame
from .operations import Error

PS = 10**12
"""Picoseconds in a second: bit times of all usual rates are whole."""
SEQUENCE_BITS = 11
"""Recessive bits that a node off the bus counts."""
SUSPENDED_BITS = 8
"""An error passive node lets others go first for so long after a frame of its own."""
ACTIVE_FLAG, LONGEST_FLAG = 6, 12
"""Error flags: of one kind of node alone, and superposed where others react to the first."""
DELIMITER = 8
"""Recessive bits after error flags."""
ACKNOWLEDGED_BEFORE_END = 9
"""Bits of a frame from the acknowledgement on."""
NOISE = Frame(0, bytes(8))
"""What a babbling node sends: nothing goes before it."""


class Sent(NamedTuple):
    """A frame that was on the bus, whole."""

    start_ps: int
    end_ps: int
    asked_ps: int
    node: int
    frame: Frame
    deaf: int
    """The one node that did not get it, or -1."""


class Broken(NamedTuple):
    """An error frame: when it was over, whose frame was broken, and who noticed first."""

    end_ps: int
    node: int
    frame: Frame
    error: Error
    first: int
    """The node that noticed, or the sender."""


class Disturbance(NamedTuple):
    """What shall go wrong with a frame: at which bit, and at which receiver, or everywhere."""

    bit: int
    receiver: int | None = None


Fate = Callable[[int, int, Frame, int], Disturbance | None]
"""Of attempt number, sender, frame and bits: what goes wrong, or None."""


def no_disturbance(_attempt: int, _node: int, _frame: Frame, _bits: int) -> Disturbance | None:
    """Let every frame through."""
    return None


@dataclass
class SimulatedBus:
    """Arbitration among controllers, frame by frame (ISO 11898-1).

    A bus that is idle is taken at once by whoever asks; when it becomes free, all that have a
    request start together and the lowest arbitration field goes through. A frame lasts as long as
    its bits, stuff bits included (`bits.length`), then come three bits of intermission. Its
    reception and its confirmation are at the end of the end of frame.

    **Errors.** A disturbed bit is seen by all nodes, who signal it from the next bit on: 6 bits of
    flag, 8 of delimiter, 3 of intermission. An error that one receiver alone sees is signalled by
    it and then by all others: 12 bits of flag. Passive nodes cannot interrupt others: a receiver
    among them just loses the frame. A frame that nobody acknowledges is an error at the bit of the
    acknowledgement. The sender of a broken frame sends it again. Counters: sender + 8, receivers
    + 1, and + 8 more for one that noticed alone and first; not for a passive sender that misses an
    acknowledgement, which thus stays as it is.

    **Two senders with one arbitration field** go on together until their bits differ: then that is
    an error of both, unless the recessive one is passive and has to give way.

    **Off the bus** a node counts sequences of 11 recessive bits: one after each frame, the rest
    while the bus is idle.

    Times are whole picoseconds; `run` calls ``sent`` and ``broken`` as things happen.
    """

    controllers: list[Controller]
    rate: int
    """bit/s."""
    data_rate: int
    """bit/s, of the data phase of CAN FD frames that switch."""
    fate: Fate = no_disturbance
    sent: Callable[[Sent], None] = lambda _: None
    broken: Callable[[Broken], None] = lambda _: None
    now_ps: int = 0
    """Everything until here has happened."""
    free_ps: int = 0
    """When the next frame may start."""
    busy_ps: int = 0
    """Time that frames, error frames and intermissions have taken."""
    attempts: int = 0
    requests: int = 0
    counted_ps: int = 0
    """Until when recessive bits were counted for nodes off the bus."""
    arriving: list[tuple[int, int, int, Request]] = field(default_factory=list)
    """Requests of the future: (when, number, node, request), a heap."""

    def __post_init__(self) -> None:
        self._bit, self._data_bit = round(PS / self.rate), round(PS / self.data_rate)

    @property
    def bit_ps(self) -> int:
        """Nominal bit time, ps."""
        return self._bit

    def ask(self, when_ps: int, node: int, frame: Frame) -> None:
        """Ask for a frame to be sent, not before ``when_ps`` nor in the past."""
        self.requests += 1
        when = max(when_ps, self.now_ps)
        request = Request(frame.priority, self.requests, when, frame)
        heapq.heappush(self.arriving, (when, self.requests, node, request))

    def run(self, until_ps: int) -> None:
        """Let everything happen that begins before ``until_ps``.

        A frame that has begun is carried out whole: its report comes at once, and says when it
        ends.
        """
        while (start := self._next_start(until_ps)) is not None:
            self._idle(start)
            self._attempt(start)
        self._arrive(until_ps)
        self._idle(until_ps)
        self.now_ps = max(self.now_ps, until_ps)

    # ------------------------------------------------------------------ when

    def _next_start(self, until_ps: int) -> int | None:
        """Return when the next frame starts, or None if none does before ``until_ps``."""
        t = max(self.free_ps, self.now_ps)
        while t < until_ps:
            self._arrive(t)
            later = []
            for each in self.controllers:
                if each.babbles:
                    self._babble(each, t)
                if each.ready and each.takes_part:
                    if each.suspended_until_ps <= t:
                        return t
                    later.append(each.suspended_until_ps)
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
            self.controllers[node].ask(request)

    def _babble(self, controller: Controller, t: int) -> None:
        if controller.takes_part and not (controller.ready and controller.ready[0].number == 0):
            heapq.heappush(controller.ready, Request(-1, 0, t, NOISE))

    def _idle(self, until_ps: int) -> None:
        """Let the bus be idle until then: nodes off the bus count recessive bits."""
        sequences = (until_ps - self.counted_ps) // (SEQUENCE_BITS * self._bit)
        if sequences > 0:
            self.counted_ps += sequences * SEQUENCE_BITS * self._bit
            self._count_sequences(sequences)

    def _count_sequences(self, sequences: int) -> None:
        for each in self.controllers:
            if each.off:
                each.recover(sequences)

    # ------------------------------------------------------------------ a frame

    def _attempt(self, start: int) -> None:
        """Carry out the frame that starts now: sent, or broken."""
        best, senders = 1 << 32, []
        for node, each in enumerate(self.controllers):
            if each.ready and each.suspended_until_ps <= start and each.takes_part:
                priority = each.ready[0].priority
                if priority < best:
                    best, senders = priority, [node]
                elif priority == best:
                    senders.append(node)
        self.attempts += 1
        if len(senders) > 1:
            bit = self._collide(senders)
            if bit is not None:
                self._break(start, senders, Disturbance(bit), Error.BIT, LONGEST_FLAG)
                return
        sender = senders[0]
        frame = self.controllers[sender].ready[0].frame
        bits = length(frame)
        wrong = self.fate(self.attempts, sender, frame, sum(bits))
        if wrong is not None:
            if wrong.receiver is None:
                self._break(start, senders, wrong, Error.BIT, ACTIVE_FLAG)
                return
            if self._can_interrupt(wrong.receiver):
                self._break(start, senders, wrong, Error.CRC, LONGEST_FLAG)
                return
        deaf = -1 if wrong is None or wrong.receiver is None else wrong.receiver
        if not any(
            each.takes_part and node not in senders and node != deaf
            for node, each in enumerate(self.controllers)
        ):
            unheard = Disturbance(sum(bits) - ACKNOWLEDGED_BEFORE_END)
            self._break(start, senders, unheard, Error.ACK, ACTIVE_FLAG)
            return
        self._succeed(start, senders, bits, deaf)

    def _collide(self, senders: list[int]) -> int | None:
        """Return the bit at which senders of one arbitration field break each other's frames.

        None if they do not: their frames are the same, or those that would notice are passive
        and have given way; they are then no longer among ``senders``.
        """
        while len(senders) > 1:
            frames = [self.controllers[node].ready[0].frame for node in senders]
            other = next((n for n, frame in enumerate(frames) if frame != frames[0]), None)
            if other is None:
                return None
            bit, first_recessive = first_difference(frames[0], frames[other])
            recessive = senders[0 if first_recessive else other]
            if not self.controllers[recessive].passive:
                return bit
            self._failed(recessive, self.free_ps)
            senders.remove(recessive)
        return None

    def _can_interrupt(self, node: int) -> bool:
        each = self.controllers[node]
        return each.takes_part and not each.passive

    def _succeed(self, start: int, senders: list[int], bits: Length, deaf: int) -> None:
        end = start + bits.nominal * self._bit + bits.data * self._data_bit
        self._occupy(start, end)
        for node, each in enumerate(self.controllers):
            if node in senders:
                request = each.sent_one()
                self._suspend(each)
                self.sent(Sent(start, end, request.asked_ps, node, request.frame, deaf))
            elif node == deaf:
                each.lost += 1
                each.failed_to_receive(0 if each.listens_only else 1)
            elif each.plugged and not each.off:
                each.got_one()

    def _break(
        self, start: int, senders: Sequence[int], wrong: Disturbance, error: Error, flag: int
    ) -> None:
        """End a frame with an error frame; its senders will try again."""
        frame = self.controllers[senders[0]].ready[0].frame
        end = start + self._until(frame, wrong.bit + 1) + (flag + DELIMITER) * self._bit
        self._occupy(start, end)
        for node, each in enumerate(self.controllers):
            if node in senders:
                alone = error is Error.ACK and each.passive
                self._failed(node, end, 0 if alone else 8)
            elif each.takes_part:
                each.failed_to_receive(9 if node == wrong.receiver else 1)
        first = senders[0] if wrong.receiver is None else wrong.receiver
        self.broken(Broken(end, senders[0], frame, error, first))

    def _failed(self, node: int, end: int, more: int = 8) -> None:
        each = self.controllers[node]
        each.failed_to_send(more)
        self._suspend(each)

    def _suspend(self, each: Controller) -> None:
        if each.passive:
            each.suspended_until_ps = self.free_ps + SUSPENDED_BITS * self._bit

    def _until(self, frame: Frame, count: int) -> int:
        """Return how long the first ``count`` bits of a frame last, ps."""
        nominal, data = length(frame)
        before = min(count, nominal - TAIL)
        fast = min(count - before, data)
        return (count - fast) * self._bit + fast * self._data_bit

    def _occupy(self, start: int, end: int) -> None:
        """Keep the bus busy until the intermission is over; nodes off the bus count it."""
        self.free_ps = end + INTERMISSION * self._bit
        self.busy_ps += self.free_ps - start
        self.counted_ps = self.free_ps
        self._count_sequences(1)
