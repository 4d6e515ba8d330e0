"""Resident memory of processes, as Linux has it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

_OWN = re.compile(r"^Rss(?:Anon|Shmem):\s+(\d+) kB$", re.MULTILINE)
_KB = 1024


def resident_bytes(pid: int) -> int:
    """Return the resident memory of a process and of those that it has started, bytes.

    Pages of files (libraries) are left out: processes share them, and the kernel takes them back.
    0 where nothing says so.
    """
    return sum(_own_bytes(each) for each in (pid, *_below(pid)))


def _own_bytes(pid: int) -> int:
    with suppress(OSError):
        text = Path(f"/proc/{pid}/status").read_text("ascii", "replace")
        return _KB * sum(int(number) for number in _OWN.findall(text))
    return 0


def _below(pid: int) -> Iterator[int]:
    """Yield the processes that a process, and those that it has started, have started."""
    with suppress(OSError):  # it has ended
        for task in os.listdir(f"/proc/{pid}/task"):
            for child in map(int, Path(f"/proc/{pid}/task/{task}/children").read_text().split()):
                yield child
                yield from _below(child)
