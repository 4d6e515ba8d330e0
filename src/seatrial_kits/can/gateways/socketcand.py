"""socketcand gateway: a server for python-can's ``socketcand``, SavvyCAN, Kayak.

socketcand's protocol (linux-can/socketcand, doc/protocol.md and src): texts between ``<`` and
``>``. The client is greeted and opens the bus `BUS`; then it is in the mode BCM, where it receives
what it subscribed to. In the raw mode it receives everything, in the control mode statistics.

Not here: cyclic transmission (add, update, delete), filters of content, ISO-TP, bit timing.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.links.endpoints.endpoint import Channel
from seatrial.links.endpoints.tcp import TcpServer

from ..frame import Frame
from ..messages import error_class
from ..operations import Error
from .clients import Client, ClientsGateway

BUS = "can0"
"""Name of the only bus."""
QUIET_S = 0.2
"""Wall time without frames after the last reply of the handshake.

python-can's client wants to read that reply alone.
"""
MOST_SUBSCRIPTIONS = 1000
"""Of one client: each is looked at in every step."""
_SWITCH, _ERROR_STATE = 0x01, 0x02
"""Flags of an FD frame (linux/can.h)."""

_MODES = {"bcmmode": "bcm", "rawmode": "raw", "controlmode": "control"}
_SENDS = ("send", "fdsend", "sendrtr")
_COMMANDS = {
    "no bus": ("open",),
    "bcm": ("echo", *_MODES, *_SENDS, "subscribe", "unsubscribe"),
    "raw": ("echo", *_MODES, *_SENDS),
    "control": ("echo", *_MODES, "statistics"),
    "refused": (),
}
"""What each mode understands."""


@dataclass
class _Traffic:
    """Bytes and frames received from the bus, and those that clients sent."""

    received_bytes: int = 0
    received: int = 0
    sent_bytes: int = 0
    sent: int = 0


@dataclass
class _Subscription:
    """One identifier: at most a frame each ``interval_s`` of wall time, the newest."""

    interval_s: float
    due: float = 0.0
    waiting: str = ""
    """Frame that is sent once it is due."""


class SocketcandGateway(ClientsGateway):
    """Any number of socketcand's clients; see `ClientsGateway`."""

    def __init__(self, server: TcpServer) -> None:
        self._traffic = _Traffic()
        super().__init__(server, lambda channel: _Client(channel, self._traffic))
        self.reached_at = server.url.replace("tcpin", "socketcand", 1)

    def poll(self) -> list[tuple[int, Frame]]:
        """Return frames that have arrived, and each one's sender; count them."""
        found = super().poll()
        self._traffic.sent += len(found)
        self._traffic.sent_bytes += sum(len(frame.data) for _, frame in found)
        return found

    def send(self, time_ns: int, frame: Frame, sender: int | None = None) -> None:
        """Send a frame to all but ``sender``; count those of the bus."""
        if sender is None:
            self._traffic.received += 1
            self._traffic.received_bytes += len(frame.data)
        super().send(time_ns, frame, sender)


class _Client(Client):
    end = b">"

    def __init__(self, channel: Channel, traffic: _Traffic) -> None:
        super().__init__(channel)
        self._traffic = traffic
        self._quiet_until: float | None = None
        self._mode = "no bus"
        self._held: list[str] = []
        self._subscriptions: dict[tuple[int, bool], _Subscription] = {}
        self._statistics_s = self._statistics_due = 0.0
        self.write("< hi >")

    def read(self, line: str) -> Frame | None:
        command, *words = line.strip().lstrip("<").split()
        if command not in _COMMANDS[self._mode]:
            raise ValueError("unknown command")
        if command in _MODES:
            self._enter(_MODES[command])
        elif command in _SENDS:
            return _frame(command, words)
        elif command == "echo":
            self._write_later("< echo >")
        elif command == "open":
            self._open(words[0])
        elif command == "statistics":
            self._statistics_s = _natural(words[0]) / 1e3
        elif command == "subscribe":
            seconds, microseconds, name = words
            self._subscribe(seconds, microseconds, name)
        else:
            self._subscriptions.pop(_identifier(words[0]), None)
        return None

    def refuse(self) -> None:
        if self._mode != "refused":
            self._write_later("< error unknown command >")

    def send(self, time_ns: int, frame: Frame) -> None:
        if self._mode == "raw":
            self._write_later(_written(time_ns, frame))
        elif self._mode == "bcm" and not frame.remote:
            found = self._subscriptions.get((frame.identifier, frame.extended))
            if found is not None:
                found.waiting = _written(time_ns, frame, " ")
                self._write_ready(found)

    def send_error(self, time_ns: int, error: Error) -> None:
        if self._mode == "raw":
            self._write_later(f"< error {error_class(error):03X} {_time(time_ns)} >")

    def written(self, frames: Sequence[Frame]) -> bytes:
        # Not by `send`: that may keep frames back, and these are not sent now.
        wanted = [
            _written(0, frame, "" if self._mode == "raw" else " ")
            for frame in frames
            if self._mode == "raw"
            or (self._mode == "bcm" and (frame.identifier, frame.extended) in self._subscriptions)
        ]
        return "".join(wanted).encode("ascii")

    def finish(self) -> None:
        self._end_quiet()
        for each in self._subscriptions.values():
            if each.waiting:
                self.write(each.waiting)

    def tick(self) -> None:
        now = time.monotonic()
        if self._quiet_until is not None and now >= self._quiet_until:
            self._end_quiet()
        if self._mode == "bcm":
            for each in self._subscriptions.values():
                self._write_ready(each)
        elif self._mode == "control" and self._statistics_s and now >= self._statistics_due:
            self._statistics_due = now + self._statistics_s
            t = self._traffic
            self.write(f"< stat {t.received_bytes} {t.received} {t.sent_bytes} {t.sent} >")

    def _end_quiet(self) -> None:
        self._quiet_until = None
        held, self._held = self._held, []
        for text in held:
            self.write(text)

    def _open(self, bus: str) -> None:
        if bus != BUS:
            self.write("< error could not open bus >")
            self._mode = "refused"
            self._channel.close()
            return
        self._mode = "bcm"
        self.write("< ok >")

    def _enter(self, mode: str) -> None:
        self.write("< ok >")
        if mode != self._mode:
            self._subscriptions, self._statistics_s = {}, 0.0
        self._mode = mode
        if mode == "raw":
            self._quiet_until = time.monotonic() + QUIET_S

    def _subscribe(self, seconds: str, microseconds: str, name: str) -> None:
        if len(self._subscriptions) >= MOST_SUBSCRIPTIONS:
            raise ValueError("too many subscriptions")
        interval_s = _natural(seconds) + _natural(microseconds) / 1e6
        self._subscriptions[_identifier(name)] = _Subscription(interval_s)

    def _write_ready(self, subscription: _Subscription) -> None:
        now = time.monotonic()
        if subscription.waiting and now >= subscription.due:
            self.write(subscription.waiting)
            subscription.waiting, subscription.due = "", now + subscription.interval_s

    def _write_later(self, text: str) -> None:
        if self._quiet_until is None:
            self.write(text)
        else:
            self._held.append(text)


def _identifier(name: str) -> tuple[int, bool]:
    """Return an identifier, and whether it is extended: then it has eight digits."""
    return int(name, 16), len(name) == 8


def _natural(word: str) -> int:
    """Return a number. Raises ValueError for what is none of 32 bits (C's unsigned int)."""
    if not (word.isdecimal() and len(word) <= 10 and int(word) < 1 << 32):
        raise ValueError("no number of 32 bits")
    return int(word)


def _frame(command: str, words: list[str]) -> Frame:
    """Return the frame of a command. Raises ValueError, IndexError or InputError."""
    identifier, extended = _identifier(words[0])
    if command == "sendrtr":
        return Frame(identifier, b"", extended, True, requested=int(words[1], 16))
    if command == "send":
        return Frame(identifier, _data(words[2:], int(words[1], 16)), extended)
    flags = int(words[1], 16)
    return Frame(
        identifier,
        _data(words[3:], int(words[2])),
        extended,
        fd=True,
        bit_rate_switch=bool(flags & _SWITCH),
        error_state=bool(flags & _ERROR_STATE),
    )


def _written(time_ns: int, frame: Frame, separator: str = "") -> str:
    """Return a frame as a text; ``separator`` follows each byte of classic ones: BCM has spaces."""
    name = f"{frame.identifier:0{8 if frame.extended else 3}X}"
    when, data = _time(time_ns), frame.data.hex().upper()
    if frame.remote:
        return f"< rtr {name} {when} {frame.requested:X} >"
    if frame.fd:
        flags = _SWITCH * frame.bit_rate_switch | _ERROR_STATE * frame.error_state
        return f"< fdframe {name} {flags:02X} {when} {data} >"
    spaced = "".join(f"{byte:02X}{separator}" for byte in frame.data)
    return f"< frame {name} {when} {spaced} >"


def _data(octets: list[str], size: int) -> bytes:
    if len(octets) != size:
        raise ValueError("the length does not fit the data")
    return bytes(int(octet, 16) for octet in octets)


def _time(time_ns: int) -> str:
    return f"{time_ns // 10**9}.{time_ns // 1000 % 10**6:06d}"
