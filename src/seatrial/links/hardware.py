"""Permission to open real ports and buses."""

from __future__ import annotations

import os
from pathlib import Path

ALLOWED = "SEATRIAL_HARDWARE"
"""Environment variable that allows it, if it is 1: components may run in other processes."""


def allow() -> None:
    """Allow it, in this process and those that it starts."""
    os.environ[ALLOWED] = "1"


def is_allowed() -> bool:
    """Return whether the person who started this run allowed real ports."""
    return os.environ.get(ALLOWED) == "1"


def is_simulated_port(device: str) -> bool:
    """Return whether ``device`` is a pseudo-terminal: a program, not a board, is behind it."""
    return Path(device).resolve().is_relative_to("/dev/pts")
