"""A pseudo-terminal: a serial port with this program in the place of a device. POSIX only."""

from __future__ import annotations

import fcntl
import os
import termios
import time
import tty
from array import array
from pathlib import Path

from ...errors import InputError
from ..own_terminals import claim
from .descriptor import DescriptorEndpoint

_TIOCGPTN = 0x80045430
"""Linux's request for the number of the terminal behind a master, which Python has no name for."""
_ARRIVES_S = 0.05
"""Wall time in which Linux carries what was written from one end of a terminal to the other."""
_UNREAD_S, _LAST_S = 0.5, 1.0
"""Wall time for programs to read what was sent last, which a closed terminal forgets: at the end of
a run, and of one that has died."""
LONGEST_QUEUE = 1 << 16
"""Bytes kept while the other end does not read; what comes beyond is lost."""


class PseudoTerminal(DescriptorEndpoint):
    """One end of a new pseudo-terminal; ``url`` is the device that others open.

    A ``place`` becomes a symbolic link to that device until the endpoint is closed. Raises
    InputError if there is something at ``place`` other than such a link from before.
    """

    def __init__(self, place: str = "") -> None:
        super().__init__()
        self._place = Path(place) if place else None
        if self._place is not None:
            _clear(self._place)
        self._own, self._other = os.openpty()  # the other stays open: its users may come and go
        tty.setraw(self._other)
        os.set_blocking(self._own, False)
        self._device = os.ttyname(self._other)
        self._claim = claim(self._device)
        self.url = f"pty:{place}" if place else self._device
        self.connect(self._own, LONGEST_QUEUE)
        if self._place is not None:
            try:
                self._place.symlink_to(self._device)
            except OSError as error:
                self._close_ends()
                raise InputError(
                    f"cannot open the link {self.url!r}: {error.strerror or error}"
                ) from None

    def close(self) -> None:
        """Close both ends, once what was sent is read, and take the symbolic link away."""
        _wait_until_read(self._other, _UNREAD_S)
        # Another run may have put its own link there in the meantime.
        if self._place is not None and _leads_to(self._place) == self._device:
            self._place.unlink()
        self._close_ends()

    def _close_ends(self) -> None:
        if self._claim is not None:
            self._claim.close()
        os.close(self._own)
        os.close(self._other)


def wait_until_others_read(own: int) -> None:
    """Wait until what went to a pseudo-terminal is read; at any other device nothing is done.

    ``own`` is this program's end: the programs' end is opened, which is how that is known.
    """
    number = array("i", [0])
    try:
        fcntl.ioctl(own, _TIOCGPTN, number)
        other = os.open(f"/dev/pts/{number[0]}", os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError:
        return
    try:
        _wait_until_read(other, _LAST_S)
    finally:
        os.close(other)


def _wait_until_read(terminal: int, limit: float) -> None:
    """Wait until nothing is left to be read at a terminal, ``limit`` of wall time at most, s."""
    unread, deadline = array("i", [0]), time.monotonic() + limit
    time.sleep(_ARRIVES_S)
    fcntl.ioctl(terminal, termios.FIONREAD, unread)
    while unread[0] and time.monotonic() < deadline:
        time.sleep(0.005)
        fcntl.ioctl(terminal, termios.FIONREAD, unread)


def _leads_to(place: Path) -> str:
    return str(place.readlink()) if place.is_symlink() else ""


def _clear(place: Path) -> None:
    """Take away a link to a terminal that a run left behind when it was killed."""
    if _leads_to(place).startswith("/dev/pts/"):
        place.unlink()
    elif place.exists() or place.is_symlink():
        raise InputError(f"cannot open the link 'pty:{place}': there is something else at {place}")
