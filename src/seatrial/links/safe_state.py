"""Safe states held by the keeper of this process, to be sent if it ends without doing so.

A link that can move something holds here what stops that, and the descriptor through which it
goes. The keeper (`trial.running.keeper`), if there is one, gets both over a socket that this
process inherited, and sends the data if the process ends without having released them, whatever
ends it. It ends the process itself if that hangs.
"""

from __future__ import annotations

import json
import os
import secrets
import socket
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any

from ..errors import InputError
from .endpoints.endpoint import Channel, Endpoint
from .endpoints.url import reaches_device

ENVIRONMENT = "SEATRIAL_SAFE_STATE"
"""Environment variable with the number of the socket's descriptor; without it nobody keeps."""

_NUMBER_BITS = 63


def inherited() -> tuple[int, ...]:
    """Return the descriptor that a process started from here needs, if there is one."""
    number = os.environ.get(ENVIRONMENT)
    return () if number is None else (int(number),)


class Held:
    """What the supervisor sends in the place of this process."""

    def __init__(self, name: str, where: str, content: dict[str, Any], fds: Sequence[int]) -> None:
        # Not counted: each FMU in this process has a copy of this module, with counts of its own.
        self._number = secrets.randbits(_NUMBER_BITS)
        _send({"number": self._number, "name": name, "where": where, **content}, fds)

    def update(self, data: bytes) -> None:
        """Replace the data."""
        _send({"number": self._number, "data": data.hex()})

    def release(self) -> None:
        """Hold it no more: it was sent, or the link is closed."""
        _send({"number": self._number, "released": True})


def hold(
    name: str, where: str, descriptor: int, data: bytes, address: tuple[str, int] | None = None
) -> Held:
    """Hold ``data`` of the component ``name`` for ``descriptor``, which leads to ``where``.

    ``address`` is the receiver of a datagram, where the descriptor has none of its own.
    """
    return Held(name, where, {"data": data.hex(), "address": address}, [descriptor])


def waits() -> None:
    """Say that this process waits for somebody outside, and does not hang."""
    _send({"waits": True})


def hold_bus(name: str, where: str, bus: Mapping[str, Any], frames: str) -> Held:
    """Hold ``frames`` (`can.safe_state`) for a bus that the supervisor opens by python-can."""
    return Held(name, where, {"bus": dict(bus), "frames": frames}, [])


class HeldChannels:
    """Safe states for the peers of some endpoints, who come and go."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._held: dict[Channel, tuple[Held, bytes]] = {}

    def keep(self, endpoints: Sequence[Endpoint], data: Callable[[Channel], bytes]) -> None:
        """Hold ``data`` of every peer that there is now, if any; call it as they come and go."""
        if not inherited():
            return
        there = {channel: each.url for each in endpoints for channel in each.channels()}
        for channel in self._held.keys() - there.keys():
            self._held.pop(channel)[0].release()
        for channel, url in there.items():
            self._keep(channel, url, data(channel))

    def _keep(self, channel: Channel, url: str, data: bytes) -> None:
        held, before = self._held.get(channel, (None, b""))
        if data == before:
            return
        target = channel.target()
        if held is None and target is not None:
            held = hold(self._name, url, target[0], data, target[1])
        elif held is not None:
            held.update(data)
        if held is not None:
            self._held[channel] = held, data

    def release(self) -> None:
        """Hold nothing any more."""
        for held, _ in self._held.values():
            held.release()
        self._held = {}


def _send(message: dict[str, Any], fds: Sequence[int] = ()) -> None:
    for number in inherited():
        data = json.dumps({"pid": os.getpid(), **message}).encode()
        with socket.socket(fileno=os.dup(number)) as channel, suppress(ConnectionError):
            socket.send_fds(channel, [data], fds)  # an error: the supervisor was killed


UNSET = "unset"
"""Value of a parameter that nobody has written; none at all is written as the empty text."""


def safe_state_bytes(text: str) -> bytes:
    """Return the bytes of hexadecimal numbers. Raises InputError for another text."""
    try:
        return b"" if text == UNSET else bytes.fromhex(text)
    except ValueError:
        raise InputError(f"safe_state: {text!r} is not bytes such as 'FAAF 0100'") from None


def require_safe_state(text: str, urls: str) -> None:
    """Raise InputError if one of ``urls`` reaches a device and nobody has written a safe state."""
    for url in urls.split() if text == UNSET else ():
        if reaches_device(url):
            raise InputError(
                f"safe_state is not set, and {url!r} reaches a device: write the bytes that stop "
                "it, or safe_state = '' if there are none"
            )
