"""Shared by benchmarks: the yardstick of a loop, peak memory, and a place in a page."""

from __future__ import annotations

import time
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"
_ADDITIONS = 1_000_000


def addition() -> float:
    """Return the time of one addition in a loop, s: what machines and hours differ by."""
    begin, total = time.process_time(), 0
    for k in range(_ADDITIONS):
        total += k
    return (time.process_time() - begin) / _ADDITIONS


def peak_memory() -> float:
    """Return the peak of this process's own memory, MB: none of who started it."""
    status = Path("/proc/self/status").read_text("ascii")
    return next(int(line.split()[1]) for line in status.splitlines() if "VmHWM" in line) / 1024


def write_measured(page: str, text: str, what: str = "measured") -> None:
    """Put ``text`` between the marks of ``what`` in a page of docs/. ValueError without them."""
    path, marks = DOCS / page, (f"<!-- {what} -->\n", f"<!-- end of {what} -->")
    before, begin, rest = path.read_text("utf-8").partition(marks[0])
    _, end, after = rest.partition(marks[1])
    if not (begin and end):
        raise ValueError(f"{path} has no place for what is {what}")
    path.write_text(f"{before}{begin}\n{text}\n\n{end}{after}", "utf-8")
