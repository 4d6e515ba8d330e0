"""A server for clients of socketcand: python-can's ``socketcand``, SavvyCAN, Kayak.

socketcand's protocol in its raw mode (linux-can/socketcand, doc/protocol.md): texts between
``<`` and ``>``. The client is greeted, opens a bus, whose name does not matter here, and asks
for the raw mode.
"""

from __future__ import annotations

import time

from ..endpoints.endpoint import Channel
from ..endpoints.tcp import TcpServer
from .frame import Frame
from .gateway_clients import Client, ClientsGateway
from .messages import error_class
from .operations import Error

QUIET_S = 0.2
"""Wall time without frames after the last reply of the handshake.

python-can's client wants to read that reply alone.
"""
_SWITCH, _ERROR_STATE = 0x01, 0x02
"""Flags of an FD frame (linux/can.h)."""


class SocketcandGateway(ClientsGateway):
    """Any number of socketcand's clients; see `ClientsGateway`."""

    def __init__(self, server: TcpServer) -> None:
        super().__init__(server, _Client)
        self.reached_at = server.url.replace("tcpin", "socketcand", 1)


class _Client(Client):
    end = b">"

    def __init__(self, channel: Channel) -> None:
        super().__init__(channel)
        self._quiet_until: float | None = None
        self._raw = False
        self._held: list[str] = []
        self.say("< hi >")

    def read(self, line: str) -> Frame | None:
        command, *words = line.strip().lstrip("<").split()
        match command:
            case "open" | "bcmmode":
                self._raw = False
                self.say("< ok >")
            case "rawmode":
                self.say("< ok >")
                self._raw, self._quiet_until = True, time.monotonic() + QUIET_S
            case "echo":
                self._tell("< echo >")
            case "send":
                return _frame(words[0], words[2:], int(words[1], 16))
            case "fdsend":
                return _fd_frame(words[0], int(words[1], 16), words[3:], int(words[2]))
            case "sendrtr":
                extended = len(words[0]) == 8
                wanted = int(words[1], 16)
                return Frame(int(words[0], 16), b"", extended, True, requested=wanted)
            case _:
                self.refuse()
        return None

    def refuse(self) -> None:
        self._tell("< error unknown command >")

    def send(self, time_ns: int, frame: Frame) -> None:
        if not self._raw:
            return
        name = f"{frame.identifier:0{8 if frame.extended else 3}X}"
        when, data = _time(time_ns), frame.data.hex().upper()
        if frame.remote:
            self._tell(f"< rtr {name} {when} {frame.requested:X} >")
        elif frame.fd:
            flags = _SWITCH * frame.bit_rate_switch | _ERROR_STATE * frame.error_state
            self._tell(f"< fdframe {name} {flags:02X} {when} {data} >")
        else:
            self._tell(f"< frame {name} {when} {data} >")

    def send_error(self, time_ns: int, error: Error) -> None:
        if self._raw:
            self._tell(f"< error {error_class(error):03X} {_time(time_ns)} >")

    def tick(self) -> None:
        if self._quiet_until is not None and time.monotonic() >= self._quiet_until:
            self._quiet_until = None
            held, self._held = self._held, []
            for text in held:
                self.say(text)

    def _tell(self, text: str) -> None:
        if self._quiet_until is None:
            self.say(text)
        else:
            self._held.append(text)


def _frame(name: str, octets: list[str], size: int) -> Frame:
    return Frame(int(name, 16), _data(octets, size), len(name) == 8)


def _fd_frame(name: str, flags: int, octets: list[str], size: int) -> Frame:
    return Frame(
        int(name, 16),
        _data(octets, size),
        len(name) == 8,
        fd=True,
        bit_rate_switch=bool(flags & _SWITCH),
        error_state=bool(flags & _ERROR_STATE),
    )


def _data(octets: list[str], size: int) -> bytes:
    if len(octets) != size:
        raise ValueError("the length does not fit the data")
    return bytes(int(octet, 16) for octet in octets)


def _time(time_ns: int) -> str:
    return f"{time_ns // 10**9}.{time_ns // 1000 % 10**6:06d}"
