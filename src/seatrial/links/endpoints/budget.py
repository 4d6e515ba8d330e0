"""Budget of what one poll takes in from each peer: a flood stops neither the run nor other peers.

It follows wall time since the poll before, as what a real line brings does, between two bounds: a
run that is faster than real time polls often, and takes in the least each time.
"""

from __future__ import annotations

import time
from collections.abc import Callable

RATE = 50_000.0
"""Bytes per second of wall time: a serial line of 500 kbaud."""
LEAST, MOST = 1024, 8192
"""Bytes in one poll, of all peers together unless there are many."""
SMALLEST_SHARE = 256
"""Bytes in one poll that each of many peers has."""


class Budget:
    """What one poll may take in; ``exceeded`` is in how many polls a peer brought more.

    ``rate`` is in bytes per second; ``clock`` is wall time, s.
    """

    def __init__(self, rate: float = RATE, clock: Callable[[], float] = time.monotonic) -> None:
        self._rate, self._clock = rate, clock
        self._last = clock()
        self._left: dict[object, int] = {}
        self._share, self._is_exceeded = 0, False
        self.exceeded = 0

    def renew(self, peers: int) -> None:
        """Begin a poll of so many peers, which share what it may take in."""
        now = self._clock()
        whole = min(max(self._rate * (now - self._last), LEAST), MOST)
        self._last, self._is_exceeded = now, False
        self._share = max(round(whole) // max(peers, 1), SMALLEST_SHARE)
        self._left.clear()

    def left(self, peer: object) -> int:
        """Return the bytes that a peer may still bring in this poll."""
        return self._left.get(peer, self._share)

    def take(self, peer: object, size: int) -> bool:
        """Return whether ``size`` bytes of a peer's may be taken in, and count them if so.

        Its first piece always may: a datagram comes whole.
        """
        fits = peer not in self._left or size <= self._left[peer]
        if fits:
            self._left[peer] = self.left(peer) - size
        else:
            self.exceed()
        return fits

    def exceed(self) -> None:
        """Note that a peer brought more than this poll takes in."""
        self.exceeded += not self._is_exceeded
        self._is_exceeded = True
