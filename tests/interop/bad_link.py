"""A radio that loses, doubles and reorders, between a ground station and a vehicle over UDP."""

from __future__ import annotations

import heapq
import random
import select
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count

from .running import HOST

_LARGEST = 1 << 16


class BadLink:
    """Carries datagrams between whoever sends to ``port`` and the vehicle, both ways alike.

    Each is lost with probability ``loss``, doubled with ``doubled``, and late by up to
    ``late_s``, so that one overtakes another. The same ``seed`` makes the same choices for the
    same datagrams in the same order.
    """

    def __init__(
        self,
        vehicle: int,
        seed: int,
        *,
        loss: float = 0.1,
        doubled: float = 0.1,
        late_s: float = 0.05,
    ) -> None:
        self._random = random.Random(seed)
        self._loss, self._doubled, self._late = loss, doubled, late_s
        self._near, self._far = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in "12")
        self._near.bind((HOST, 0))
        self._far.bind((HOST, 0))
        self._far.connect((HOST, vehicle))
        self._station: tuple[str, int] | None = None
        self._waiting: list[tuple[float, int, bool, bytes]] = []
        self._number, self._ended = count(), False
        self.carried = self.lost = self.late = 0
        """Datagrams that came, that were dropped, and that went out behind a later one."""
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """Where stations send to."""
        return int(self._near.getsockname()[1])

    def close(self) -> None:
        """End it."""
        self._ended = True
        self._thread.join()
        self._near.close()
        self._far.close()

    def _run(self) -> None:
        newest = {True: -1, False: -1}
        while not self._ended:
            readable, *_ = select.select([self._near, self._far], [], [], 0.002)
            for each in readable:
                self._take(each)
            while self._waiting and self._waiting[0][0] <= time.monotonic():
                _, number, up, data = heapq.heappop(self._waiting)
                self.late += number < newest[up]
                newest[up] = max(number, newest[up])
                self._pass_on(up, data)

    def _take(self, from_: socket.socket) -> None:
        try:
            data, address = from_.recvfrom(_LARGEST)
        except OSError:
            return  # nobody is there yet
        up = from_ is self._near
        if up:
            self._station = address
        self.carried += 1
        if self._random.random() < self._loss:
            self.lost += 1
            return
        for _ in range(2 if self._random.random() < self._doubled else 1):
            due = time.monotonic() + self._random.uniform(0.0, self._late)
            heapq.heappush(self._waiting, (due, next(self._number), up, data))

    def _pass_on(self, up: bool, data: bytes) -> None:
        try:
            if up:
                self._far.send(data)
            elif self._station is not None:
                self._near.sendto(data, self._station)
        except OSError:
            self.lost += 1


@contextmanager
def bad_link(vehicle: int, seed: int) -> Iterator[BadLink]:
    """Yield a bad link to the vehicle that listens at a port."""
    link = BadLink(vehicle, seed)
    try:
        yield link
        assert link.lost > 0.05 * link.carried
        assert link.late > 0
    finally:
        link.close()
