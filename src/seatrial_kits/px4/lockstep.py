"""Lockstep with one firmware that connects by TCP: sensors go, actuators come, and so on."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.endpoints.budget import Budget
from seatrial.links.endpoints.endpoint import Channel
from seatrial.links.endpoints.tcp import TcpServer
from seatrial.links.interruption import Interruption
from seatrial_kits.mavlink.codec import Codec, Message

SLICE_S = 0.05
"""Wall time of one wait: signals that request an end are noticed within it."""
_AT_ONCE_S = 0.005
"""Wall time of the first wait: a firmware under way answers in it."""
_SYSTEM = 1
_ARMED = mavlink.MAV_MODE_FLAG_SAFETY_ARMED


class Lockstep:
    """The firmware that is connected to ``endpoint``, the first that came of those that are.

    Its clock is the time of the newest HIL_SENSOR. It answers one by HIL_ACTUATOR_CONTROLS of
    that time, if a controller of its ran: they do so at a rate of their own, and most only while
    they are armed. So nothing is waited for before the first answer (`is_locked`); from then on the
    newest one is never older than it should be, until none comes in time, and again from the next
    one on.
    """

    def __init__(self, endpoint: TcpServer, clock: Callable[[], float] = time.monotonic) -> None:
        self.endpoint, self._clock = endpoint, clock
        endpoint.budget = Budget.of_raw_bytes()  # 250 messages a second and more, simulated time
        self.connections = self.missed = self.refused = 0
        self._held = ExitStack()
        # All the time: a request between two waits must not be missed by the second.
        self._interruption = self._held.enter_context(Interruption())
        self._peer: Channel | None = None
        self.is_locked = self.is_armed = False
        self.controls: tuple[float, ...] = ()
        self._forget()

    def wait_for_firmware(self, waiting: Callable[[], None]) -> bool:
        """Return whether one is connected; False if the process is requested to end.

        ``waiting`` is called while none is there, some times a second, and may raise.
        """
        self._take_in()
        return self._wait(lambda: self._peer is not None, waiting, None)

    def exchange(
        self,
        us: int,
        messages: Sequence[Message],
        every_us: int,
        limit: float,
        waiting: Callable[[], None],
    ) -> None:
        """Send messages of the time ``us``; in lockstep, wait for actuators for ``limit``, s.

        They come every ``every_us``: it is waited until the newest are younger. ``waiting`` is
        called while they are not there. A firmware that disconnects answers no more.
        """
        self._take_in()
        if self._peer is None:
            return
        self._peer.send(b"".join(self._codec.encode(each) for each in messages))
        if not self.is_locked:
            return
        due = us - every_us + 1  # the time of the first is 1 us late: see `microseconds`
        self._wait(lambda: self._answered_us > due or self._peer is None, waiting, limit)
        if self._answered_us <= due and not self._interrupted:
            self.is_locked = False
            self.missed += self._peer is not None

    def idle(self, until: float) -> None:
        """Take in what comes up to an instant of the clock, s."""
        while (left := until - self._clock()) > 0.0:
            if self._interruption.requested:
                return
            self.endpoint.wait(min(left, SLICE_S))
            self._take_in()

    def close(self) -> None:
        """Close the port."""
        self._held.close()
        self.endpoint.close()

    @property
    def is_connected(self) -> bool:
        """Whether a firmware is there."""
        return self._peer is not None

    # ------------------------------------------------------------------ inside

    def _forget(self) -> None:
        self._codec = Codec(_SYSTEM, mavlink.MAV_COMP_ID_AUTOPILOT1)
        self._answered_us = -1
        self._interrupted = False
        self.is_locked = self.is_armed = False
        self.controls = ()

    def _wait(
        self, holds: Callable[[], bool], waiting: Callable[[], None], limit: float | None
    ) -> bool:
        """Wait until something holds, for ``limit`` at most; return whether it does."""
        self._interrupted = False
        if not holds() and self.endpoint.wait(_AT_ONCE_S):
            self._take_in()
        if holds():
            return True
        until = None if limit is None else self._clock() + limit
        with Interruption():
            while not holds():
                if self._interruption.take():
                    self._interrupted = True
                    return False
                if until is not None and self._clock() >= until:
                    return False
                waiting()
                self.endpoint.wait(SLICE_S)
                self._take_in()
        return True

    def _take_in(self) -> None:
        arrived = self.endpoint.poll()
        channels = self.endpoint.channels()
        if self._peer is not None and self._peer not in channels:
            self._peer = None
            self._forget()
        if self._peer is None and channels:
            self._peer = channels[0]
            self.connections += 1
        for channel, data in arrived:
            if channel is self._peer:
                before = self._codec.unusable
                for message in self._codec.decode(data):
                    self._note(message)
                self.refused += self._codec.unusable - before

    def _note(self, message: Message) -> None:
        if message.get_type() == "HIL_ACTUATOR_CONTROLS":
            self._answered_us = message.time_usec
            self.controls = tuple(message.controls)
            self.is_armed = bool(message.mode & _ARMED)
            self.is_locked = True
