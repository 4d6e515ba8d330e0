"""Pseudo-terminals that runs of seatrial have opened: claimed, so that other runs can tell them.

A claim is a socket in the kernel's own name space, named after the terminal's number. It ends with
the process that made it, however that ends, and so never outlives the terminal. Linux only:
elsewhere no terminal is proven to be one of these.
"""

from __future__ import annotations

import os
import re
import socket
import sys
from pathlib import Path

_NAME = "\0seatrial-terminal-{}"


def claim(device: str) -> socket.socket | None:
    """Claim a terminal that this process has opened; close what is returned before its own end."""
    number = _number(device)
    if number is None:
        return None
    claimed = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        claimed.bind(_NAME.format(number))
    except OSError:
        claimed.close()  # the name is taken: the terminal is taken for a device
        return None
    return claimed


def is_own(device: str) -> bool:
    """Return whether a terminal is this user's, with a run of seatrial at its other end."""
    number = _number(device)
    if number is None:
        return False
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as asked:
        try:
            asked.connect(_NAME.format(number))
            return os.stat(device).st_uid == os.getuid()
        except OSError:
            return False


def _number(device: str) -> str | None:
    """Return the number of a pseudo-terminal, None for any other device."""
    found = re.fullmatch(r"/dev/pts/(\d+)", str(Path(device).resolve()))
    return found[1] if found is not None and sys.platform == "linux" else None
