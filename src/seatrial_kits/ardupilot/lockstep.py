"""Lockstep with one firmware at a UDP port: a frame comes, an answer goes, and so on."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack

from seatrial.links.endpoints.budget import Budget
from seatrial.links.endpoints.endpoint import Channel
from seatrial.links.endpoints.udp import UdpListener
from seatrial.links.interruption import Interruption

from .packet import Frame, read_frame

SILENT_S = 2.0
"""Wall time after which a firmware that sends nothing is replaced by another one that does."""
REPEATED_S = 0.5
"""Wall time within which a firmware repeats nothing: it does after a second."""
SLICE_S = 0.05
"""Wall time of one wait: signals that request an end are noticed within it."""
_AT_ONCE_S = 0.005
"""Wall time of the first wait: a firmware under way answers in it."""


class Lockstep:
    """The firmware that sends to ``endpoint``.

    It repeats a frame that is not answered within a second. One that repeats itself although it
    was answered lost the answer and gets it again; what it repeated before is dropped, since a
    second answer to one frame would be taken for that to the next. A frame number that goes back,
    and another sender that begins at 0, is a firmware that was started again. Another one that is
    further on is left out while this one sends.
    """

    def __init__(self, endpoint: UdpListener, clock: Callable[[], float] = time.monotonic) -> None:
        self.endpoint, self._clock = endpoint, clock
        endpoint.budget = Budget.of_raw_bytes()  # 400 frames a second and more, in simulated time
        self.frame: Frame | None = None
        """The newest one."""
        self.restarts = self.repeated = self.lost = self.refused = 0
        self._held = ExitStack()
        # All the time: a request between two waits must not be missed by the second.
        self._interruption = self._held.enter_context(Interruption())
        self._peer: Channel | None = None
        self._answer: bytes | None = None
        self._received_at = 0.0

    def wait_for_frame(self, waiting: Callable[[], None]) -> Frame | None:
        """Return a frame that is not answered yet; None if the process is requested to end.

        ``waiting`` is called while none is there, some times a second, and may raise.
        """
        if not self._is_due() and self.endpoint.wait(_AT_ONCE_S):
            self._take_in()
        if self._is_due():
            return self.frame
        with Interruption():
            while not self._is_due():
                if self._interruption.take():
                    return None
                waiting()
                self.endpoint.wait(SLICE_S)
                self._take_in()
        return self.frame

    def answer(self, data: bytes) -> None:
        """Answer the newest frame."""
        if self._clock() - self._received_at > REPEATED_S:
            self._take_in()  # what was repeated until now is answered with it
        assert self._peer is not None
        self._answer = data
        self._peer.send(data)

    def close(self) -> None:
        """Close the port."""
        self._held.close()
        self.endpoint.close()

    # ------------------------------------------------------------------ inside

    def _is_due(self) -> bool:
        return self.frame is not None and self._answer is None

    def _take_in(self) -> None:
        for channel, data in self.endpoint.poll():
            frame = read_frame(data)
            self.refused += frame is None
            if frame is not None and self._is_ours(channel, frame):
                self._received_at = self._clock()
                self._receive(channel, frame)

    def _is_ours(self, channel: Channel, frame: Frame) -> bool:
        if channel is self._peer or self._peer is None or frame.count == 0:
            return True
        silent = self._clock() - self._received_at > SILENT_S
        self.refused += not silent
        return silent

    def _receive(self, channel: Channel, frame: Frame) -> None:
        if self.frame is not None:
            if channel is self._peer and frame.count == self.frame.count:
                self.repeated += 1
                if self._answer is not None:
                    channel.send(self._answer)
                return
            if channel is not self._peer or frame.count < self.frame.count:
                self.restarts += 1
            else:
                self.lost += frame.count - self.frame.count - 1
        self._peer, self.frame, self._answer = channel, frame, None
