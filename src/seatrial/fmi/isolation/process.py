"""A process at the other end of two pipes: exchanging frames, time limits, and how it ended."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence

from ...links.safe_state import inherited
from ...printable import printable
from .exit_status import how_ended
from .pipe import MESSAGE, MOST_BYTES, Frame, Frames

_SLICE_S = 0.2
"""A wait looks up so often: a signal that comes just before it begins must not be missed."""
_EXIT_S = 5.0
_IN_ORDER_S = 2.0
"""Wall time for the end of a call that was interrupted, and what the component does then."""
_LAST_STREAM = 2
_STACK_S = 0.5
_KEPT_BYTES = 8192
_KEPT_LINES = 50


class EndedError(Exception):
    """The process has ended, or was ended: ``how``, and the last that it ``printed``."""

    def __init__(self, how: str, printed: str, *, timed_out: bool = False) -> None:
        super().__init__(how)
        self.how, self.printed, self.timed_out = how, printed, timed_out


class WorkerProcess:
    """A worker, started by exec: it has nothing of this process but the ends of its pipes.

    It leads a session of its own, so that Ctrl-C in a terminal does not reach it, and ends with
    the thread that made it. ``message`` gets the level and text of its log messages.
    ``sandbox`` is a command that the worker's is an argument of, which makes ``parent`` the process
    that the worker ends with, as it sees it.
    """

    def __init__(
        self,
        module: str,
        name: str,
        environment: dict[str, str],
        message: Callable[[int, str], None],
        sandbox: Sequence[str] = (),
        parent: int | None = None,
    ) -> None:
        self._message = message
        self._frames, self._output = Frames(), _Output()
        theirs_in, self._requests = _pipe()
        self._answers, theirs_out = _pipe()
        self._printed, theirs_printed = _pipe()
        fds = (theirs_in, theirs_out)
        own = [sys.executable, "-P", "-m", module]
        command = [*sandbox, *own, *map(str, fds), str(parent or os.getpid()), name]
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=theirs_printed,
                stderr=theirs_printed,
                pass_fds=(*fds, *inherited()),
                env=environment,
                start_new_session=True,
            )
        except BaseException:
            self._close(self._requests, self._answers, self._printed)
            raise
        finally:
            self._close(theirs_in, theirs_out, theirs_printed)
        self._poll = select.poll()
        for fd in (self._answers, self._printed):
            os.set_blocking(fd, False)
            self._poll.register(fd, select.POLLIN)
        os.set_blocking(self._requests, False)

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    def exchange(self, request: bytes, timeout_s: float) -> Frame:
        """Send a request and return its answer.

        Raises EndedError if the process ends before, or is ended because it takes longer.
        Whatever else is raised (KeyboardInterrupt) has ended the process too: the answer that
        is still to come would be taken for that of the next request.
        """
        deadline = time.monotonic() + timeout_s
        try:
            unsent = self._send(request)
            while (answer := self._taken()) is None:
                left = deadline - time.monotonic()
                if left <= 0:
                    self._ask_where_it_is()
                    how = f"was ended for not answering within {timeout_s:g} s"
                    raise self._gone(how, timed_out=True)
                unsent = self._wait(unsent, min(_SLICE_S, left))
        except EndedError:
            self.end()
            raise
        except BaseException:  # the component may hang, or be a link that has to stop something
            self.wait(_IN_ORDER_S)
            raise
        self._output.release()
        return answer

    def wait(self, within_s: float = _EXIT_S) -> None:
        """Let the process, whose end was requested, end by itself; end it if it does not."""
        self._close_requests()
        try:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(within_s)
        finally:
            self.end()
            self._output.release()

    def end(self) -> None:
        """End the process and all that it started, and close the pipes. Harmless when repeated."""
        if self._answers < 0:
            return
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        with contextlib.suppress(subprocess.TimeoutExpired):  # stuck in the kernel
            self._process.wait(_EXIT_S)
        self._drain()
        self._close_requests()
        self._close(self._answers, self._printed)
        self._answers = self._printed = -1

    # ------------------------------------------------------------------ inside

    def _send(self, data: bytes) -> bytes:
        """Send what the pipe takes now; return the rest."""
        try:
            sent = os.write(self._requests, data)
        except BlockingIOError:
            sent = 0
        except BrokenPipeError:
            raise self._ended() from None
        if sent < len(data):
            self._poll.register(self._requests, select.POLLOUT)
            return data[sent:]
        return b""

    def _taken(self) -> Frame | None:
        """Return an answer that has arrived whole; log messages before it are passed on."""
        while (found := self._frames.take()) is not None and found[0] == MESSAGE:
            self._message(found[1], found[2].decode("utf-8", "replace"))
        return found

    def _wait(self, unsent: bytes, timeout_s: float) -> bytes:
        """Wait until something happens, and handle it; return what is still to be sent."""
        events = self._poll.poll(timeout_s * 1e3)
        if not events:
            self._output.release()
            # A process that it started may hold its pipes open.
            if self._process.poll() is not None and not self._receive():
                raise self._ended()
        for fd, _ in events:
            if fd == self._answers:
                if not self._receive():
                    raise self._ended()
            elif fd == self._printed:
                self._drain()
            else:
                self._poll.unregister(self._requests)
                unsent = self._send(unsent)
        return unsent

    def _receive(self) -> bool:
        """Take what has arrived; False at the end."""
        try:
            data = os.read(self._answers, MOST_BYTES)
        except BlockingIOError:
            return False
        self._frames.feed(data)
        return bool(data)

    def _drain(self) -> None:
        """Take what the process has printed, without waiting for more."""
        with contextlib.suppress(BlockingIOError):
            data = os.read(self._printed, MOST_BYTES)
            self._output.add(data)
            if not data and self._answers >= 0:  # it has closed its end: nothing to wait for
                with contextlib.suppress(KeyError):
                    self._poll.unregister(self._printed)

    def _ended(self) -> EndedError:
        """Return how the process has ended by itself."""
        try:
            status = self._process.wait(_EXIT_S)
        except subprocess.TimeoutExpired:
            return self._gone("closed its pipes")
        return self._gone(how_ended(status))

    def _ask_where_it_is(self) -> None:
        """Let a process that hangs print its Python stack; see `worker.main`."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self._process.pid, signal.SIGUSR1)
        time.sleep(_STACK_S)

    def _gone(self, how: str, *, timed_out: bool = False) -> EndedError:
        self.end()
        return EndedError(how, self._output.last_lines(), timed_out=timed_out)

    def _close_requests(self) -> None:
        if self._requests >= 0:
            self._close(self._requests)
            self._requests = -1

    @staticmethod
    def _close(*fds: int) -> None:
        for fd in fds:
            os.close(fd)


class _Output:
    """What a process prints: passed on to stderr, and its end kept for an error's message.

    Of a short call it is passed on when that returns, so that a crash is reported only once.
    """

    def __init__(self) -> None:
        self._held, self._passed_on = b"", b""

    def add(self, data: bytes) -> None:
        """Take what was printed."""
        self._held += data
        if len(self._held) > MOST_BYTES:
            self.release()

    def release(self) -> None:
        """Pass on what is held."""
        if self._held:
            if sys.stderr is not None:
                with contextlib.suppress(OSError, ValueError):  # nobody reads it, or it is closed
                    sys.stderr.write(printable(self._held.decode("utf-8", "replace")))
            self._passed_on = (self._passed_on + self._held)[-_KEPT_BYTES:]
            self._held = b""

    def last_lines(self) -> str:
        """Return the last lines."""
        kept = (self._passed_on + self._held)[-_KEPT_BYTES:]
        return "\n".join(kept.decode("utf-8", "replace").splitlines()[-_KEPT_LINES:]).strip()


def _pipe() -> tuple[int, int]:
    """Return a pipe whose ends are none of the descriptors 0 to 2.

    Those are free in a process that was started with a closed stdin, stdout or stderr; in the
    worker they become its own standard streams.
    """
    import fcntl  # not on Windows, where there are no isolated components

    low: list[int] = []
    try:
        ends = list(os.pipe())
        for index, fd in enumerate(ends):
            if fd <= _LAST_STREAM:
                low.append(fd)
                ends[index] = fcntl.fcntl(fd, fcntl.F_DUPFD_CLOEXEC, _LAST_STREAM + 1)
    finally:
        for fd in low:
            os.close(fd)
    return ends[0], ends[1]
