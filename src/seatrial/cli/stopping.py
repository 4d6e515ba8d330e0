"""Signals that ask a run to stop."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import SimulationError
from .starting import heeded


class Stop:
    """Counts the signals that ask a run to stop.

    The second one and later ones raise KeyboardInterrupt, but only where a component may hang:
    what is being written then, or made of what was written, gets finished. They often come
    twice: ``timeout`` and service managers signal a process and its group, people press twice.
    """

    def __init__(self) -> None:
        self._asked = 0
        self._may_hang = False

    def ask(self, _number: int, _frame: object) -> None:
        """Handle a signal."""
        self._asked += 1
        if self._asked > 1 and self._may_hang:
            raise KeyboardInterrupt

    def requested(self) -> int:
        """Return how many there were."""
        return self._asked

    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """Let a second signal end what is done inside."""
        self._may_hang = True
        try:
            yield
        finally:
            self._may_hang = False


@contextmanager
def stoppable() -> Iterator[Stop]:
    """Make Ctrl-C, a termination signal and a lost terminal end the run after the current step.

    A second one ends it at once, if a component hangs. After a stop the signals stay ignored:
    a late second one must not kill a program that is leaving with its message and its status.
    """
    stop = Stop()
    before = {number: signal.signal(number, stop.ask) for number in heeded()}
    try:
        yield stop
    except KeyboardInterrupt:
        raise SimulationError("stopped") from None
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_IGN if stop.requested() else handler)
