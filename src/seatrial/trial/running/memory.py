"""Resident memory of processes, as Linux has it."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

_OWN = re.compile(r"^Rss(?:Anon|Shmem):\s+(\d+) kB$", re.MULTILINE)
_KB = 1024


def resident_bytes(pid: int | str = "self") -> int:
    """Return the resident memory of a process that is no file's, bytes; 0 where nothing says so.

    Pages of files (libraries) are left out: processes share them, and the kernel takes them back.
    """
    with suppress(OSError):
        text = Path(f"/proc/{pid}/status").read_text("ascii", "replace")
        return _KB * sum(int(number) for number in _OWN.findall(text))
    return 0
