"""Budget of what one poll takes in from each peer: a flood stops neither the run nor other peers.

It follows wall time since the poll before, as what a real line brings does, between two bounds: a
run that is faster than real time polls often, and takes in the least each time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Hashable

RATE = 80_000.0
"""Bytes per second of wall time where messages are read, with what each costs beside its bytes."""
ALL_RATE = 2 * RATE
"""The same of all links of a component."""
RAW_RATE = 100_000.0
"""The same where bytes are passed on alone: a line of 1 Mbaud."""
LEAST, RAW_LEAST = 64, 1024
"""Bytes in one poll at least, where messages are read and where bytes are passed on alone."""
MOST = 16_384
"""Bytes in one poll, and of one peer."""
SMALLEST_SHARE = 64
"""Bytes in one poll that each of many peers has."""


class Budget:
    """Bytes that one poll may accept; ``exceeded`` counts the polls in which a peer sent more.

    What a peer does not use it has later, up to `MOST`: an honest one may send at once what it had
    to say. Peers that have that much leave their share to the others.

    ``rate`` is in bytes per second, ``least`` in bytes per poll; ``clock`` is wall time, s.
    """

    def __init__(
        self, rate: float = RATE, least: int = LEAST, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._rate, self._least, self._clock = rate, least, clock
        self._last = clock()
        self._left: dict[Hashable, int] = {}
        self._share, self._is_exceeded = 0, False
        self.exceeded = 0

    @classmethod
    def of_raw_bytes(cls) -> Budget:
        """Return one for bytes that nobody reads here."""
        return cls(RAW_RATE, RAW_LEAST)

    def renew(self, peers: Collection[Hashable]) -> None:
        """Begin a poll of these peers, which share what it may take in."""
        now = self._clock()
        whole = min(max(self._rate * (now - self._last), self._least), MOST)
        self._last, self._is_exceeded = now, False
        needy = sum(self._left.get(peer, 0) < MOST for peer in peers)
        self._share = max(round(whole) // max(needy, 1), SMALLEST_SHARE)
        self._left = {peer: min(self._left.get(peer, 0) + self._share, MOST) for peer in peers}

    def left(self, peer: Hashable) -> int:
        """Return the bytes that a peer may bring now."""
        return max(self._left.get(peer, self._share), 0)

    def take(self, peer: Hashable, size: int) -> bool:
        """Return whether ``size`` bytes of a peer's may be taken in, and note them if so.

        A piece that is larger than what is left comes whole, and is made up for later.
        """
        left = self._left.get(peer, self._share)
        if left > 0:
            self._left[peer] = left - size
        else:
            self.exceed()
        return left > 0

    def charge(self, peer: Hashable, messages: int, each: int) -> None:
        """Count messages that a peer's bytes turned out to hold as ``each`` bytes more.

        It is made up for in the polls that follow: short messages cost no less than long ones.
        """
        if peer in self._left:
            self._left[peer] -= messages * each

    def exceed(self) -> None:
        """Note that a peer brought more than this poll takes in."""
        self.exceeded += not self._is_exceeded
        self._is_exceeded = True
