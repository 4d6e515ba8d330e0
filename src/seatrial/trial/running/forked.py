"""A copy of this process that does what may kill it: its signals, its end and its safe states."""

from __future__ import annotations

import contextlib
import faulthandler
import gc
import logging
import math
import os
import re
import select
import signal
import socket
import tempfile
import time
import warnings
from collections.abc import Callable
from itertools import takewhile
from pathlib import Path
from typing import Any, ClassVar, NoReturn

from ...fmi.isolation.exit_status import how_ended
from ...kits import OURS
from ...links.safe_state import ENVIRONMENT
from ...links.safe_state_keeper import SafeStates
from .call_trace import CallTrace
from .forked_child import ASKING, ORDER, Child, flush_c_streams
from .keeper import Keeper
from .link import Frame, Link

SLICE_MS = 200
"""A stop is passed on within this time."""
_URGENT_S = 2.0
"""Wall time from the first request to stop until it is to be at once: the step takes its time."""
_EXIT_S = 5.0
"""Wall time for a child that is to end at once; one that takes longer is killed."""
_LAST_STREAM = 2
_SHOWN_FRAMES = 3
_FRAME = re.compile(r'^  File "(.+)", line (\d+) in (.+)$', re.MULTILINE)
_LOGGER = logging.getLogger("seatrial.trial.running.forked")
_OWN = tuple(str(Path(__file__).parents[3] / name) for name in OURS)


class Forked:
    """Runs ``body`` in a child of this process, whatever becomes of that. POSIX only.

    This process passes on how urgently a stop is ``asked`` for; so does the child, of the signals
    that it gets itself. It ends in order if this process is killed. A third process, the keeper,
    ends it if it hangs, and sends the safe states of all that have ended without doing so
    themselves; ``sent`` has a line for each.
    """

    _others: ClassVar[set[Forked]] = set()
    """Those that live: a copy of this process must not keep their ends open."""

    def __init__(self, body: Callable[[Child], None], *first: Any) -> None:
        """Start ``body``, which finds the frame ``first`` there, if it is not empty."""
        _fill_standard_streams()
        self.call_trace, self.sent = CallTrace(), list[str]()
        ours, theirs = socket.socketpair()
        states, (alarm, self._alarm) = SafeStates(), os.pipe()
        for end in (alarm, self._alarm):
            os.set_blocking(end, False)
        self._stack = tempfile.TemporaryFile()  # noqa: SIM115  it lives as long as the child
        parent = os.getpid()
        # A handler of this process must not run in the others.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, ASKING)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)  # of other threads
                self._pid = os.fork()
            if not self._pid:
                ours.close()
                os.close(alarm)
                self._be_child(body, Link(theirs), parent, mask, states)
            theirs.close()
            self.link = Link(ours)
            if first:
                self.link.send(*first)  # it begins while there is no keeper yet
            self._keeper = Keeper(self._pid, states, self.call_trace, alarm)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        states.close()
        os.close(alarm)
        self._waiting = select.poll()
        self._waiting.register(self.link.fileno(), select.POLLIN)
        self._waiting.register(self._keeper.fileno(), select.POLLIN)
        self._status: int | None = None
        self._ordered, self._asked_at, self._to_end_by = 0, math.inf, math.inf
        self._others.add(self)

    def descriptors(self) -> tuple[int, int]:
        """Return what can be waited at until there is something for `frames`."""
        return self.link.fileno(), self._keeper.fileno()

    def frames(self, asked: int, *, wait: bool = True) -> list[Frame] | None:
        """Return the frames that come within a moment; None once the child has ended.

        Without ``wait`` they are those that are there.

        ``asked`` is how urgently it is to stop: 1 after its step, 2 at once, which the former
        becomes where the step goes on. It is killed if it does not do the latter.
        """
        ended = self._has_ended()  # before it is looked whether there is anything left to read
        if not ended:
            self._ask(asked)
        slice_ms = 0 if ended or not wait else SLICE_MS
        ready = {descriptor for descriptor, _ in self._waiting.poll(slice_ms)}
        if self._keeper.fileno() in ready:
            self._take_sent()
        if self.link.fileno() in ready:
            frames = self.link.receive()
            if frames is None:
                self._wait()
            return frames
        return None if ended else []

    def how(self) -> str:
        """Return how the child ended, and where in whose Python code if that is known."""
        self._wait()
        assert self._status is not None
        self._stack.seek(0)
        text = self._stack.read().decode("utf-8", "replace")
        called = takewhile(
            lambda frame: not frame[0].startswith(_OWN) and "site-packages" not in frame[0],
            _FRAME.findall(text),
        )
        places = [f"{Path(file).name}:{line} in {function}" for file, line, function in called]
        shown = f" ({', '.join(places[:_SHOWN_FRAMES])})" if places else ""
        return how_ended(self._status) + shown

    def end(self, asked: int = 0) -> None:
        """Let the child end, which then waits for no more frames; kill it if it does not."""
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, ASKING)  # whatever is raised comes later
        try:
            if not self._has_ended():
                self._ask(asked)
            self.link.close()
            self._wait()
        finally:  # whatever went wrong, the vehicle gets its neutral
            self._others.discard(self)
            self.sent += self._keeper.finish()
            self._keeper.close()
            self._stack.close()
            os.close(self._alarm)
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)

    # ------------------------------------------------------------------ inside

    def _let_go(self) -> None:
        """Close what a copy of the parent has of it: it would not notice the parent's end."""
        self.link.close()
        self._keeper.close()
        self._stack.close()
        os.close(self._alarm)

    def _take_sent(self) -> None:
        """Take what the keeper has sent; without a keeper nothing goes on."""
        self.sent += self._keeper.sent()
        if self._keeper.is_gone:
            self._waiting.unregister(self._keeper.fileno())
            _LOGGER.error("the keeper of the safe states was killed: the run is stopped")
            self._ask(2)

    def _ask(self, level: int) -> None:
        trace, now = self.call_trace, time.monotonic()
        level = min(max(level, trace.asked), 2)
        if level:
            self._asked_at = min(self._asked_at, now)
        if now > self._asked_at + _URGENT_S:
            level = 2
        if level > self._ordered:
            self._ordered = trace.asked = level
            trace.orders += 1
            os.kill(self._pid, ORDER)
            if level > 1:
                self._to_end_by = now + _EXIT_S
        if time.monotonic() > self._to_end_by:
            self._kill()

    def _has_ended(self) -> bool:
        if self._status is None:
            pid, status = os.waitpid(self._pid, os.WNOHANG)
            if pid:
                self._status = os.waitstatus_to_exitcode(status)
        return self._status is not None

    def _wait(self) -> None:
        """Wait until the child, which closes its end, has ended."""
        deadline = time.monotonic() + _EXIT_S
        while not self._has_ended():
            if time.monotonic() > deadline:
                self._kill()
            time.sleep(0.001)

    def _kill(self) -> None:
        if not self._has_ended():
            os.kill(self._pid, signal.SIGKILL)

    def _be_child(
        self,
        body: Callable[[Child], None],
        link: Link,
        parent: int,
        mask: set[int | signal.Signals],
        states: SafeStates,
    ) -> NoReturn:
        """Run the body and end, whatever it does: nothing of the parent's may go on here."""
        status = 1
        gc.freeze()  # what it looks through, it would copy: the memory is shared
        try:
            for other in self._others:
                other._let_go()
            os.environ[ENVIRONMENT] = str(states.left_to_child())
            faulthandler.enable(self._stack, all_threads=False)
            child = Child(link, self.call_trace, parent, self._alarm)
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
            body(child)
            status = 0
        finally:
            with contextlib.suppress(BaseException):
                flush_c_streams()
            os._exit(status)


def _fill_standard_streams() -> None:
    """Let no descriptor that is opened from here on be 0, 1 or 2, which C code prints to."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= _LAST_STREAM:
        pass
    os.close(descriptor)
