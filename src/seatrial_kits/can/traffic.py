"""Traffic for a bus: periodic frames, and as many others as make a load."""

from __future__ import annotations

import re
from typing import Any, ClassVar, NamedTuple

from seatrial.errors import InputError
from seatrial.model.component import NS, Component, Input, Noise, Output, Parameter, terminal

from .bits import INTERMISSION, length
from .frame import FD_LENGTHS, Frame
from .node import CanNode
from .operations import Confirm, Transmit

FORMATS = ("classic", "fd", "fd-switch")
"""Classic CAN; CAN FD at one bit rate; CAN FD with a data phase at its own rate."""

_MESSAGE = re.compile(
    r"(?P<identifier>0x[0-9A-Fa-f]{1,8}) +(?P<period>\d*\.?\d+(?:e-?\d+)?) +(?P<bytes>\d{1,2})"
    r"(?: +(?P<offset>\d*\.?\d+(?:e-?\d+)?))?"
)
_BLOCK = 64
"""Frames whose random numbers are drawn together."""


class Message(NamedTuple):
    """One periodic frame."""

    identifier: int
    extended: bool
    period_ns: int
    size: int
    offset_ns: int


class CanTraffic(Noise, Component):
    """A node that sends periodic frames, and background frames that make a load.

    ``messages`` has ``IDENTIFIER PERIOD BYTES [OFFSET]`` of each, times in s, with ``;``:
    ``0x123 0.01 8; 0x09F11217 0.1 8 0.05``. Identifiers of more than three digits have 29 bits.
    Frame k is requested at the start of the run + offset + k period, and up to ``jitter`` of a
    period later, uniform.

    ``load`` > 0 adds frames of ``background``, one identifier after the other, ``size`` bytes
    each, at such times that they alone would take this share of a bus at ``bit_rate``: each has
    (its length + 3 bits) / (load bit_rate) to itself. Above 1 the bus cannot carry them.

    Data are the number of the frame (32 bits, the lowest byte first), then random bytes, which
    decide on stuff bits. In ``format`` fd-switch, ``data_bit_rate`` applies to the load.

    ``asked``, ``confirmed`` and ``received`` count frames. ``silent`` stops it.

    Raises InputError at the start for messages and sizes that cannot be.
    """

    discrete = True
    transient = Component.transient | {"_messages", "_drawn"}

    messages = Parameter("", "1", "IDENTIFIER PERIOD BYTES [OFFSET] of each, in s; with ;")
    jitter = Parameter(0.0, "1", "largest delay, as a share of the period", min=0.0, max=1.0)
    load = Parameter(0.0, "1", "load to offer", min=0.0, max=10.0, tunable=True)
    background = Parameter("0x700", "1", "identifiers of the load, separated by spaces")
    size = Parameter(8.0, "1", "bytes of the frames of the load", min=0.0, max=64.0)
    format = Parameter("classic", "1", "format of the frames", choices=FORMATS)
    bit_rate = Parameter(250_000.0, "1/s", "bit rate of the bus", min=1000.0, max=1e6)
    data_bit_rate = Parameter(
        2_000_000.0, "1/s", "bit rate of CAN FD's data phase", min=1000.0, max=2e7
    )

    rx = Input("1", "operations from the bus", type=str, role="can")
    silent = Input("1", "whether it is silent", type=bool, optional=True)

    tx = Output("1", "operations to the bus", type=str, role="can")
    asked = Output("1", "frames requested", type=int)
    confirmed = Output("1", "frames sent", type=int)
    received = Output("1", "frames received", type=int)

    terminals: ClassVar = {"bus": terminal("tx", "rx")}

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Begin to count."""
        if self.size % 1.0:
            raise InputError(f"{self.name}: size is {self.size!r}, a whole number is needed")
        self._begun_ns = self.now_ns
        self._messages = [_message(text) for text in _parts(self.messages)]
        self._identifiers = [_identifier(text, "background") for text in self.background.split()]
        if not self._identifiers:
            raise InputError(f"{self.name}: background names no identifier")
        try:
            for each in self._messages:
                self._frame(each.identifier, each.extended, bytes(each.size))
            for identifier, extended in self._identifiers:
                self._frame(identifier, extended, bytes(int(self.size)))
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        self._counts = [0] * len(self._messages)
        self._background_count = 0
        self._background_ns = float(self.now_ns)
        self._requested = self._confirmed = self._received = 0
        self._can: dict[str, Any] = {}
        self._drawn: dict[int, tuple[int, Any]] = {}

    def step(self, t: float, h: float) -> None:
        """Request what is due from ``t`` to before ``t + h``."""
        node, end_ns = CanNode(self._can), self.now_ns + round(h * NS)
        for _, operation in node.receive(self.rx):
            if isinstance(operation, Confirm):
                self._confirmed += 1
            elif isinstance(operation, Transmit):
                self._received += 1
        due = [
            entry for number in range(len(self._messages)) for entry in self._due(number, end_ns)
        ]
        due += self._background_due(end_ns)
        if not self.silent:
            for when, _, frame in sorted(due, key=lambda entry: entry[:2]):
                node.send(when, frame)
            self._requested += len(due)
        node.flush()

    def outputs(self, t: float) -> None:
        """Publish."""
        self.tx = CanNode(self._can).text
        self.asked, self.confirmed, self.received = self._requested, self._confirmed, self._received

    def set_state(self, state: Any) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._messages = [_message(text) for text in _parts(self.messages)]
        self._drawn = {}

    # ------------------------------------------------------------------ inside

    def _due(self, number: int, end_ns: int) -> list[tuple[int, int, Frame]]:
        """Return (time, order, frame) of a message's frames before ``end_ns``."""
        message = self._messages[number]
        found: list[tuple[int, int, Frame]] = []
        while True:
            k = self._counts[number]
            late, data = self._random(1 + number, k, message.size)
            delay = round(late * self.jitter * message.period_ns)
            when = self._begun_ns + message.offset_ns + k * message.period_ns + delay
            if when >= end_ns:
                return found
            frame = self._frame(message.identifier, message.extended, data)
            found.append((when, number, frame))
            self._counts[number] += 1

    def _background_due(self, end_ns: int) -> list[tuple[int, int, Frame]]:
        found: list[tuple[int, int, Frame]] = []
        if self.load <= 0.0:
            self._background_ns = float(end_ns)
        while self._background_ns < end_ns:
            k = self._background_count
            identifier, extended = self._identifiers[k % len(self._identifiers)]
            _, data = self._random(0, k, int(self.size))
            frame = self._frame(identifier, extended, data)
            found.append((int(self._background_ns), len(self._messages), frame))
            bits = length(frame)
            own = (bits.nominal + INTERMISSION) / self.bit_rate + bits.data / self.data_bit_rate
            self._background_ns += own * NS / self.load
            self._background_count += 1
        return found

    def _frame(self, identifier: int, extended: bool, data: bytes) -> Frame:
        fd, switch = self.format != "classic", self.format == "fd-switch"
        return Frame(identifier, data, extended, fd=fd, bit_rate_switch=switch)

    def _random(self, stream: int, k: int, size: int) -> tuple[float, bytes]:
        """Return the delay's draw, 0 to 1, and the data of frame ``k`` of a stream."""
        block, place = divmod(k, _BLOCK)
        if self._drawn.get(stream, (-1, None))[0] != block:
            generator = self.generator(block, stream)
            delays = generator.random(_BLOCK).tolist()
            self._drawn[stream] = (block, (delays, generator.bytes(64 * _BLOCK)))
        delays, octets = self._drawn[stream][1]
        number = (k & 0xFFFFFFFF).to_bytes(4, "little")
        return delays[place], (number + octets[64 * place : 64 * place + 60])[:size]


def _parts(messages: str) -> list[str]:
    return [text.strip() for text in messages.split(";") if text.strip()]


def _message(text: str) -> Message:
    match = _MESSAGE.fullmatch(text)
    if match is None:
        raise InputError(
            f"messages: {text!r} is not IDENTIFIER PERIOD BYTES [OFFSET], such as '0x123 0.01 8'"
        )
    period, offset = round(float(match["period"]) * NS), float(match["offset"] or 0.0)
    if period < 1 or int(match["bytes"]) not in FD_LENGTHS:
        raise InputError(
            f"messages: {text!r}: the period is above 0, bytes are one of {FD_LENGTHS}"
        )
    identifier, extended = _identifier(match["identifier"], "messages")
    return Message(identifier, extended, period, int(match["bytes"]), round(offset * NS))


def _identifier(text: str, where: str) -> tuple[int, bool]:
    try:
        return int(text, 16), len(text.removeprefix("0x")) > 3
    except ValueError:
        raise InputError(f"{where}: {text!r} is no identifier, such as 0x123") from None
