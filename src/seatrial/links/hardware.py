"""Whether real ports and buses may be opened."""

from __future__ import annotations

import os
from pathlib import Path

ALLOWED = "SEATRIAL_HARDWARE"
"""Environment variable that allows it, if it is 1: components may run in other processes."""


def allow() -> None:
    """Allow it, in this process and those that it starts."""
    os.environ[ALLOWED] = "1"


def is_allowed() -> bool:
    """Say if the person who started this run allowed real ports."""
    return os.environ.get(ALLOWED) == "1"


def is_simulated_port(device: str) -> bool:
    """Say if ``device`` is a pseudo-terminal: a port with a program, not a board, behind it."""
    return Path(device).resolve().is_relative_to("/dev/pts")
