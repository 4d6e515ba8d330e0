"""Lockstep: the step waits for the commands of other nodes; every run has the same numbers."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from seatrial.errors import InputError, unknown
from seatrial.links.interruption import Interruption
from seatrial.links.watchdog import Watchdog

from .watched import Watched

_POLL_S = 0.0002
_SETTLED_S = 1.0
"""Wall time without a new match after which all readers and writers have met."""
_AGAIN_S = 0.5
"""Wall time after which an instant that nobody answered is written again."""


class Lockstep:
    """Waits, at each instant, for one command on each of the topics ``awaited``.

    ``stamped``: for the command whose stamp is the instant. ``counted``: for exactly one new
    command, whatever its stamp. The first instant waits until a publisher of each topic is
    there, and for `_SETTLED_S` more, so that nodes miss nothing of what is written. A stamped
    instant that stays without its command is written again: a node that came late goes on.

    Raises SimulationError at the limit of wall time, with the topics that are awaited.
    """

    def __init__(
        self, awaited: Sequence[Watched], *, stamped: bool, name: str, limit: float
    ) -> None:
        self.awaited, self._stamped = awaited, stamped
        self._name, self._limit = name, limit
        self._met = False

    def meet(self, matches: Callable[[], int]) -> None:
        """Wait for the publishers; ``matches`` counts the readers of what is written."""
        if self._met:
            return
        self._met = True
        before, since = -1, time.monotonic()
        with Interruption() as interruption:
            dog = self._dog([each for each in self.awaited if not each.publishers])
            while not interruption.requested:
                there = all(each.publishers for each in self.awaited)
                now = matches() + sum(each.publishers for each in self.awaited)
                if now != before or not there:
                    before, since = now, time.monotonic()
                elif time.monotonic() - since > _SETTLED_S:
                    return
                if not there:
                    dog.waiting()
                time.sleep(0.02)

    def wait(self, now: float, now_ns: int, again: Callable[[], None]) -> None:
        """Wait for the commands of the instant; ``again`` writes it anew."""
        left = [each for each in self.awaited if not self._take(each, now, now_ns)]
        if not left:
            return
        dog, written = self._dog(left), time.monotonic()
        with Interruption() as interruption:
            while left and not interruption.requested:
                time.sleep(_POLL_S)
                left = [each for each in left if not self._take(each, now, now_ns)]
                if left and time.monotonic() - written > _AGAIN_S:
                    dog = dog if len(left) == len(self.awaited) else self._dog(left)
                    dog.waiting()
                    written = time.monotonic()
                    if self._stamped:
                        again()

    def _take(self, watched: Watched, now: float, now_ns: int) -> bool:
        return watched.take_stamped(now, now_ns) if self._stamped else watched.take_one(now)

    def _dog(self, left: Sequence[Watched]) -> Watchdog:
        named = ", ".join(
            each.name + ("" if each.publishers else " (it has no publisher)") for each in left
        )
        return Watchdog(self._name, f"a publisher of {named}", self._limit)


def awaited(written: str, watched: dict[str, Watched], *, stamped: bool) -> list[Watched]:
    """Return the topics of ``awaited``.

    Raises InputError for one that is not there, or has no stamp to wait for.
    """
    found = []
    for key in written.split():
        if key not in watched:
            raise InputError(f"awaited: {unknown('topic of commands', key, watched)}")
        if stamped and not watched[key].is_stamped:
            raise InputError(
                f"awaited: {key} is {watched[key].kind}, which has no stamp: "
                "lockstep = 'counted', or cmd_vel_stamped"
            )
        found.append(watched[key])
    return found
