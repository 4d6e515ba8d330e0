"""Sockets of a library confined to the loopback interface, whatever address it binds them to.

CycloneDDS sends on the interface of its configuration alone, but receives at all addresses of the
machine. On Linux each socket that it opens is bound to the loopback device, so that the kernel
gives it nothing from elsewhere; other systems have no such binding, and their firewall decides.
"""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

_DEVICE = b"lo\0"
_OPEN = "/proc/self/fd"


@contextmanager
def confined_sockets(reaches_others: bool) -> Iterator[None]:
    """Confine the sockets that are opened inside, unless other hosts are to be reached."""
    if reaches_others or sys.platform != "linux":
        yield
        return
    before = set(_sockets().values())
    yield
    for descriptor, identity in _sockets().items():
        if identity not in before:
            with suppress(OSError), socket.socket(fileno=os.dup(descriptor)) as opened:
                if opened.family in (socket.AF_INET, socket.AF_INET6):
                    opened.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, _DEVICE)


def _sockets() -> dict[int, str]:
    """Return what each open descriptor of a socket leads to."""
    found = {}
    for name in os.listdir(_OPEN):
        with suppress(OSError):  # that of the listing is closed by now
            found[int(name)] = os.readlink(f"{_OPEN}/{name}")
    return {number: where for number, where in found.items() if where.startswith("socket:")}
