"""Generated parts of the pages; `part` registers a function that makes one."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable
from pathlib import Path

PARTS: dict[str, Callable[[], str]] = {}


def part(name: str) -> Callable[[Callable[[], str]], Callable[[], str]]:
    """Register the function that makes the part ``name``."""

    def register(make: Callable[[], str]) -> Callable[[], str]:
        PARTS[name] = make
        return make

    return register


@contextlib.contextmanager
def elsewhere():
    """Work in an empty folder, where no file can stand in for a shipped one."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        yield Path(folder)
