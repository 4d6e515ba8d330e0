"""Budget of what one poll takes in from each peer: a flood stops neither the run nor other peers.

It follows wall time since the poll before, as what a real line brings does, between two bounds: a
run that is faster than real time polls often, and takes in the least each time.
"""

from __future__ import annotations

import time
from collections.abc import Callable

RATE, LEAST = 12_000.0, 64
"""Bytes per second of wall time, and in one poll at least, where messages are read: a full line of
115 200 baud. A message of 20 bytes takes some 30 to 50 us."""
RAW_RATE, RAW_LEAST = 100_000.0, 1024
"""The same where bytes are passed on alone: a line of 1 Mbaud."""
MOST = 4096
"""Bytes in one poll, of all peers together unless there are many."""
SMALLEST_SHARE = 64
"""Bytes in one poll that each of many peers has."""


class Budget:
    """What one poll may take in; ``exceeded`` is in how many polls a peer brought more.

    ``rate`` is in bytes per second, ``least`` in bytes per poll; ``clock`` is wall time, s.
    """

    def __init__(
        self,
        rate: float = RATE,
        least: int = LEAST,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._rate, self._least, self._clock = rate, least, clock
        self._last = clock()
        self._left: dict[object, int] = {}
        self._share, self._is_exceeded = 0, False
        self.exceeded = 0

    @classmethod
    def of_raw_bytes(cls) -> Budget:
        """Return one for bytes that nobody reads here."""
        return cls(RAW_RATE, RAW_LEAST)

    def renew(self, peers: int) -> None:
        """Begin a poll of so many peers, which share what it may take in."""
        now = self._clock()
        whole = min(max(self._rate * (now - self._last), self._least), MOST)
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
