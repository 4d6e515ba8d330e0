"""Whether real ports, buses and other hosts may be reached."""

from __future__ import annotations

import ipaddress
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import InputError

ALLOWED = "SEATRIAL_HARDWARE"
"""Environment variable that allows it, if it is 1: components may run in other processes."""
_CONFINED = "confined"
"""Its value while no more than programs on this machine may be reached."""


def allow() -> None:
    """Allow it, in this process and those that it starts."""
    os.environ[ALLOWED] = "1"


def is_allowed() -> bool:
    """Return whether the person who started this run allowed real ports."""
    return os.environ.get(ALLOWED) == "1"


def permission() -> str:
    """Return what would allow a real port, for messages."""
    if os.environ.get(ALLOWED) == _CONFINED:
        return "a simulation in Python opens none; run it with seatrial run --hardware"
    return (
        f"allow it with --hardware (or {ALLOWED}=1 in the environment) "
        "if nothing behind it can do harm"
    )


@contextmanager
def confined() -> Iterator[None]:
    """Allow neither real ports nor other hosts to components that start inside.

    Those in processes of their own keep to that.
    """
    before = os.environ.get(ALLOWED)
    os.environ[ALLOWED] = _CONFINED
    try:
        yield
    finally:
        if before is None:
            del os.environ[ALLOWED]
        else:
            os.environ[ALLOWED] = before


def refuse_other_host(what: str, address: str) -> None:
    """Raise InputError for an IP address that is not this machine's own, where confined."""
    if os.environ.get(ALLOWED) == _CONFINED and not ipaddress.ip_address(address).is_loopback:
        raise InputError(
            f"{what} reaches other hosts, by {address}; a simulation in Python opens 127.0.0.1 "
            "only; run it with seatrial run"
        )


def is_simulated_port(device: str) -> bool:
    """Return whether ``device`` is a pseudo-terminal: a program, not a board, is behind it."""
    return Path(device).resolve().is_relative_to("/dev/pts")
