"""Runs that are ended at random moments, also while they start: what the vehicle behind them gets."""

from __future__ import annotations

import ctypes
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from .gateway import ENDS, SAFE, Start, Vehicle
from .test_stop import children_of, has_ended, wait_for

MOMENTS = 20
LONGEST_S = 3.0
KILLS = signal.SIGKILL, signal.SIGSEGV
_IN_OPEN = 0x20
_HELD_WITHIN_S = 0.1
"""Wall time from the opening of a device until the supervisor holds its safe state."""


class Openings:
    """Notices that a file is opened (inotify)."""

    def __init__(self, path: str) -> None:
        libc = ctypes.CDLL(None)
        self._descriptor = libc.inotify_init1(os.O_NONBLOCK)
        assert libc.inotify_add_watch(self._descriptor, path.encode(), _IN_OPEN) >= 0

    def noticed(self) -> bool:
        """Return whether it was, since the last time."""
        try:
            return bool(os.read(self._descriptor, 4096))
        except BlockingIOError:
            return False

    def close(self) -> None:
        os.close(self._descriptor)


def heeds_signals(process: subprocess.Popen[str]) -> bool:
    """Say if a process has handlers of its own yet: before, signals are the interpreter's."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    caught = re.search(r"SigCgt:\s*(\w+)", status)
    return caught is not None and bool(int(caught[1], 16) >> (signal.SIGTERM - 1) & 1)


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="processes, terminals, inotify")
@pytest.mark.parametrize(("whose", "number"), [end.values for end in ENDS])
def test_seven_ends_at_twenty_random_moments(
    whose: str, number: int, start: Start, vehicle: Vehicle
) -> None:
    """The vehicle gets its safe state last if its device was opened, and else nothing.

    Before there is a child, what would end that ends the command.
    """
    chance = random.Random(f"17 {whose} {number}")
    openings = Openings(vehicle.device)
    for k in range(MOMENTS):
        vehicle.received = b""
        process = start(isolated=bool(k % 2), start_takes=0.2, out=f"run{k}")
        while not heeds_signals(process):
            time.sleep(0.001)
        moment = chance.uniform(0.0, LONGEST_S)
        opened_s = opened_for(openings, moment)
        children = children_of(process)
        hit = children[0] if whose == "child" and children else process.pid
        os.kill(hit, number)
        _, message = process.communicate(timeout=60)  # also the child's end: it has these pipes
        for child in children:
            wait_for(lambda child=child: has_ended(child))
        seen = f"moment {k}, {moment:.3f} s, opened {opened_s:.3f} s before: {message}"
        opened = opened_s > 0.0 or openings.noticed()
        if opened_s > _HELD_WITHIN_S or (opened and number not in KILLS):
            wait_for(lambda: vehicle.read().endswith(SAFE))
        time.sleep(0.2)  # nothing may come after it
        assert not vehicle.read() or (opened and vehicle.received.endswith(SAFE)), seen
        assert "Traceback" not in message, seen
        killed = number in KILLS and hit == process.pid
        assert process.returncode == (-number if killed else 3), seen
    openings.close()


def opened_for(openings: Openings, moment: float) -> float:
    """Wait; return for how long the file has been open then, s: 0 if it has not been opened."""
    until, opened_at = time.monotonic() + moment, 0.0
    while (now := time.monotonic()) < until:
        if not opened_at and openings.noticed():
            opened_at = now
        time.sleep(0.002)
    return now - opened_at if opened_at else 0.0
