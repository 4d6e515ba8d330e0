"""The keeper of a run: a process that stops what a link moves, whatever happens to the others.

It leads a session of its own, so that no signal to a terminal or a process group reaches it. It
does not trust that the others live: it looks whether the run gets on. Where it does not it ends
the run's process, waits until that has ended, and sends the safe states then, so that nothing of
the run comes after them.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import math
import os
import select
import signal
import socket
import sys
import time
import warnings
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import NoReturn

from ...links.safe_state_keeper import Process, SafeStates
from .call_trace import ASKED_IN_VAIN, BEYOND_MEMORY, BEYOND_WALL, HUNG, CallTrace
from .forked_child import ASKING
from .memory import resident_bytes

ASKED_S = 4.0
"""Wall time from the first request to stop until the links must have got their safe states."""
_LOOK_S = 0.1
_MOST_COUNTED_S = 3 * _LOOK_S
"""What is counted between two looks: more is time in which this process did not run either."""
_IN_ORDER_S = 3.0
"""Wall time in which processes may end in order, and send it themselves."""
_FINISH_S = 30.0
_LONGEST = 1 << 16
_TITLE = b"keeper-of-links"
"""Its name, 15 bytes at most: who kills all that is called seatrial must not mean this one."""
_PR_SET_NAME = 15


class Keeper:
    """The supervisor's end of a keeper of the process ``run``.

    ``alarm`` is a pipe with the numbers of the signals that the run gets.
    """

    def __init__(self, run: int, states: SafeStates, trace: CallTrace, alarm: int) -> None:
        self._ours, theirs = socket.socketpair()
        self._unread, self.is_gone = b"", False
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of other threads
            between = os.fork()
        if not between:
            _begin(run, states, trace, alarm, theirs)
        os.waitpid(between, 0)  # so that it is nobody's child, whom somebody might kill with it
        theirs.close()
        self._pid = 0

    def fileno(self) -> int:
        """Return the descriptor to wait at."""
        return self._ours.fileno()

    def sent(self) -> list[str]:
        """Wait for more, and return a line for each safe state that was sent."""
        try:
            data = self._ours.recv(_LONGEST)
        except OSError:
            data = b""
        self.is_gone = not data
        *lines, self._unread = (self._unread + data).split(b"\n")
        if lines and not self._pid:
            self._pid = int(lines.pop(0))
        return [line.decode() for line in lines]

    def finish(self) -> list[str]:
        """Let it end, with the processes of the run; return what it has sent until then."""
        lines = []
        self._ours.settimeout(_FINISH_S)
        with contextlib.suppress(OSError):
            self._ours.shutdown(socket.SHUT_WR)
        while not self.is_gone:
            lines += self.sent()
        return lines

    def close(self) -> None:
        """Close this end; process 1 of a container is who adopted the keeper, and reaps it."""
        self._ours.close()
        if self.is_gone and self._pid:
            with contextlib.suppress(ChildProcessError):
                os.waitpid(self._pid, 0)


class _Watch:
    """Says which of its limits the run is beyond."""

    def __init__(self, trace: CallTrace, run: int) -> None:
        self._trace, self._run = trace, run
        self._before: object = None
        self._runs = 0
        self._looked, self._idle, self._wall = time.monotonic(), 0.0, 0.0

    def beyond(self, states: SafeStates) -> int:
        """Return why the process is to be ended, 0 if it is not."""
        now, trace = time.monotonic(), self._trace
        passed, self._looked = min(now - self._looked, _MOST_COUNTED_S), now
        progress = (trace.progress(), states.waits)
        self._idle = self._idle + passed if progress == self._before else 0.0
        self._before = progress
        if trace.runs != self._runs:
            self._runs, self._wall = trace.runs, 0.0
        limits, goes_on = trace.limits, self._runs % 2
        is_hung = self._idle > trace.limit(states.held)
        is_timed = goes_on and math.isfinite(limits.wall)
        if (is_hung or is_timed) and not trace.devices and _is_suspended(self._run):
            self._idle = 0.0  # a person who suspends a simulation goes on with it
            return 0
        self._wall += passed
        if is_timed and self._wall > limits.wall:
            return BEYOND_WALL
        if is_hung:
            return HUNG
        if goes_on and math.isfinite(limits.memory):
            more = resident_bytes(self._run) - trace.before
            return BEYOND_MEMORY if more > limits.memory else 0
        return 0


@dataclass
class _Alarm:
    """Signals that the run's process gets, whatever it does: C code writes their numbers."""

    descriptor: int
    heeded: list[int]

    def has_rung(self) -> bool:
        """Return whether one asks for the end of the run."""
        with contextlib.suppress(BlockingIOError):
            return not set(self.heeded).isdisjoint(os.read(self.descriptor, _LONGEST))
        return False


def _begin(
    run: int, states: SafeStates, trace: CallTrace, alarm: int, control: socket.socket
) -> NoReturn:
    """Be the keeper, as nobody's child, with nothing open but what it needs."""
    try:
        os.setsid()
        if os.fork():
            os._exit(0)
        control.sendall(b"%d\n" % os.getpid())
        gc.disable()  # what it looks through, it would copy: the memory is shared
        heeded = [each for each in ASKING if signal.getsignal(each) != signal.SIG_IGN]
        for number in (*ASKING, signal.SIGPIPE):
            signal.signal(number, signal.SIG_IGN)  # those who send them to all mean the others
        signal.set_wakeup_fd(-1)
        signal.pthread_sigmask(signal.SIG_SETMASK, [])
        _close_others(states.left_to_keeper(), alarm, control.fileno())
        _name()
        control.setblocking(False)
        _keep(run, states, trace, _Alarm(alarm, heeded), control)
    finally:
        os._exit(0)


def _keep(
    run: int, states: SafeStates, trace: CallTrace, alarm: _Alarm, control: socket.socket
) -> None:
    process, watch = Process(run), _Watch(trace, run)
    asked = supervised_until = math.inf
    supervised = lives = True
    while supervised or lives or states.held:
        _wait(
            *states.descriptors(),
            alarm.descriptor,
            process.fileno() if lives else -1,
            control.fileno() if supervised else -1,
        )
        now, lives = time.monotonic(), not process.has_ended()
        _say(control, states.of_ended())
        if supervised and _is_over(control):
            supervised, supervised_until = False, now
        if alarm.has_rung() and not trace.asked:
            trace.asked = 1  # the run itself cannot say so in code that holds Python's lock
        asked = min(asked, now) if trace.asked else math.inf
        if (beyond := watch.beyond(states)) and lives:
            end = beyond
        elif states.held and (now > asked + ASKED_S or now > supervised_until + _IN_ORDER_S):
            end = ASKED_IN_VAIN
        else:
            continue
        trace.end = trace.end or end
        _say(control, states.of_killed(process))


def _wait(*descriptors: int) -> None:
    waiting = select.poll()
    for descriptor in descriptors:
        if descriptor >= 0:
            waiting.register(descriptor, select.POLLIN)
    waiting.poll(_LOOK_S * 1e3)


def _is_over(control: socket.socket) -> bool:
    """Return whether the supervisor has let go of its end."""
    try:
        return not control.recv(1)
    except BlockingIOError:
        return False
    except OSError:
        return True


def _say(control: socket.socket, lines: list[str]) -> None:
    with contextlib.suppress(OSError):
        control.sendall("".join(f"{line}\n" for line in lines).encode())


def _is_suspended(pid: int) -> bool:
    with contextlib.suppress(OSError):
        state = Path(f"/proc/{pid}/stat").read_text("ascii", "replace").rpartition(")")[2]
        return state.split()[0] in ("T", "t")
    return False


def _close_others(*kept: int) -> None:
    """Close all descriptors but some: who waits for an end of the others must not wait for this."""
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        if stream not in kept:
            os.dup2(nothing, stream)
    edges = [2, *sorted(kept), os.sysconf("SC_OPEN_MAX")]
    for before, after in pairwise(edges):
        os.closerange(before + 1, after)


def _name() -> None:
    """Have a name and a command line of its own."""
    if sys.platform != "linux":
        return
    ctypes.CDLL(None).prctl(_PR_SET_NAME, _TITLE)
    with contextlib.suppress(OSError, ValueError, IndexError):
        places = Path("/proc/self/stat").read_text("ascii", "replace").rpartition(")")[2].split()
        begin, end = int(places[45]), int(places[46])  # of the command line, proc(5)
        if begin and end - begin > len(_TITLE):  # some kernels say 0
            ctypes.memset(begin, 0, end - begin)
            ctypes.memmove(begin, _TITLE, len(_TITLE))
