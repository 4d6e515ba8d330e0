"""Parts at a board's buses and pins: what a file of one declares and does, for every back end.

A part is a class of one of the kinds here. Its registers are data; `Part.measure` fills them from
the ports that it names, at the beginning of each step in which these have changed. The board reads
and writes registers by itself: the class is called for those only that are declared so.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from traceback import walk_tb
from typing import Any, ClassVar, Literal

from seatrial.errors import SimulationError

from .board import Inputs
from .mcus import CLOCK

_REGISTERS, _STREAM, _SPI, _PIN = 1, 2, 3, 4
_NEXT, _ACCESS, _REPLY = 1, 2, 3
_RUN = 8
_BYTES = struct.Struct(f"<BBH{_RUN}s")
"""Registers that follow each other, in one record."""
_BEGINS = 0x100
_READ_ONLY, _WRITE_CALLS, _READ_CALLS = 1, 2, 4
BEGIN, WRITE, READ, TRANSFER, SELECT, EDGE = b"bwrxse"
"""Calls of a board: see ``shared/parts.h``."""
NONE = 2
"""A level that is none: a part leaves a pin alone, and what pulls it has it."""


def part_failed(board: str, part: Part, error: Exception) -> SimulationError:
    """Return an error of a part's class, with the line of its file."""
    frames = [
        each for each in walk_tb(error.__traceback__) if each[0].f_code.co_filename != __file__
    ]
    frame, line = frames[-1]
    file = frame.f_code.co_filename
    return SimulationError(
        f"{board}: the part {type(part).__name__} has failed ({file}:{line}): "
        f"{type(error).__name__}: {error}"
    )


@dataclass(frozen=True)
class Register:
    """A register at ``at`` with its value at power-on.

    ``form`` is its format: ``u8 s16be u16le`` and so on, of one byte and more. ``access`` is
    ``rw``, ``r`` (writing does nothing), ``acts`` (`I2CRegisters.written` follows a write) or
    ``latches`` (`I2CRegisters.reading` precedes a read). A value that a sketch writes to a register
    of ``rw`` stays at the board: a part that needs the value declares ``acts``.
    """

    at: int
    value: int = 0
    form: str = "u8"
    access: str = "rw"

    @property
    def places(self) -> range:
        """The addresses of its bytes."""
        return range(self.at, self.at + _format(self.form)[0])


_ACCESSES = {"rw": 0, "r": _READ_ONLY, "acts": _WRITE_CALLS, "latches": _READ_CALLS}


@cache
def _format(form: str) -> tuple[int, Literal["little", "big"], bool, int, int]:
    """Return bytes, order, whether signed, and the least and greatest number of a format."""
    signed, order = form[0] == "s", "little" if form.endswith("le") else "big"
    bits = int(form[1:].rstrip("ble"))
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    return bits // 8, order, signed, low, high  # type: ignore[return-value]


@cache
def _packing(form: str, count: int) -> str:
    """Return the format of so many numbers for `struct`."""
    size, order, signed, _, _ = _format(form)
    letter = {1: "b", 2: "h", 4: "i"}[size]
    return f"{'<' if order == 'little' else '>'}{count}{letter if signed else letter.upper()}"


def packed(form: str, value: float) -> bytes:
    """Return a number in a register's format, rounded, and at most what the format holds."""
    size, order, signed, low, high = _format(form)
    return round(min(max(low, value), high)).to_bytes(size, order, signed=signed)


def unpacked(form: str, data: bytes | bytearray) -> int:
    """Return the number in bytes of a register's format."""
    _, order, signed, _, _ = _format(form)
    return int.from_bytes(data, order, signed=signed)


class Part:
    """A part at ``places`` of a board: an I2C address, or pins.

    ``ports`` names the inputs of `Arduino` that it measures; they are in ``inputs``, SI units, each
    a number or a tuple. Of ports in groups (``angle``, ``distance``, ``temperature``) it has the
    one of the number behind its name in ``wires``. ``pulses`` has the widths of pulses that it
    makes, s, by number of the output ``pulse``.
    """

    ports: ClassVar[tuple[str, ...]] = ()
    address: ClassVar[bool] = False
    """Whether its place is an I2C address."""
    pins: ClassVar[int] = 1
    """How many pins it has, written with commas between."""
    kind: ClassVar[int] = 0

    def __init__(self, places: tuple[int, ...], number: int = 1) -> None:
        self.places, self.number = places, number
        self.inputs: dict[str, Any] = {}
        self.pulses: dict[int, float] = {}
        self.line = 0
        """UART at whose ports its packets are, in the place of bytes; 0: none."""
        self.packets: list[tuple[float, bytes]] = []
        """Packets that it has sent, each with the time at which it is over."""
        self.time = 0.0
        """Seconds since the board has had power."""
        self._records = Inputs()
        self._index = 0
        self.reset()

    def reset(self) -> None:
        """Begin as at power-on."""

    def measure(self) -> None:
        """Take in ``inputs``: called before the first step and when they have changed."""

    def end(self) -> None:
        """Keep what is to outlast the run: called at its end."""

    def arrived(self, time: float, data: bytes) -> None:
        """Take in a packet that came on its ``line``."""

    # ------------------------------------------------------------------ for the board

    def connect(self, index: int, records: Inputs) -> None:
        """Put the part at the board as its part ``index``."""
        self._index = index
        records.put("I", self.places[0], self._mask(), self.kind)

    def update(self, time: float, inputs: dict[str, Any], records: Inputs) -> None:
        """Measure, and put what has changed into ``records``."""
        self.time, self.inputs = time, inputs
        self.measure()
        self.flush(records)

    def answer(self, call: int, value: int, cycle: int, sent: bytes) -> tuple[int, Inputs]:
        """Answer a call of the board; return its result, and what has changed."""
        self.time = cycle / CLOCK
        result = self._called(call, value, sent)
        records = Inputs()
        self.flush(records)
        return result, records

    def _mask(self) -> int:
        return 0

    def _called(self, call: int, value: int, sent: bytes) -> int:
        return 1

    def flush(self, records: Inputs) -> None:
        """Put what has changed into ``records``."""
        records.data += self._records.data
        self._records = Inputs()

    def drive(self, pin: int, levels: Iterable[tuple[float, int]]) -> None:
        """Drive a pin: (time, level) of each change, s; earlier plans are dropped. See `NONE`."""
        self._records.put("f", pin)
        for when, level in levels:
            self._records.put("d", pin, float(round(when * CLOCK)), level)

    def pulse(self, pin: int, width: float, period: float) -> None:
        """Have pulses of ``width`` at a pin, every ``period``, s, from the next on; 0: none."""
        self._records.put("Q", pin, period)
        self._records.put("R", pin, width)

    def _reply(self, data: bytes, beyond: int, deaf: bool = False) -> None:
        self._records.put("y", self._index, 0.0, int(deaf) << 8 | beyond)
        self._extend(data)

    def _extend(self, data: bytes) -> None:
        for byte in data:
            self._records.put("g", self._index, _REPLY, byte)


class I2CRegisters(Part):
    """A part with a pointer to registers: the first byte written sets it, and it advances.

    ``pointer_mask`` takes the register out of the byte. Undeclared registers keep what is written.
    """

    kind = _REGISTERS
    address = True
    registers: ClassVar[dict[str, Register]] = {}
    pointer_mask: ClassVar[int] = 0xFF
    answers = True
    """Whether it acknowledges its address."""

    def __init__(self, places: tuple[int, ...], number: int = 1) -> None:
        self.store = bytearray(256)
        self._unsent: list[tuple[int, int]] = []
        self._answered = True
        self._next: list[int] = []
        for register in self.registers.values():
            self._put(register, register.value)
        super().__init__(places, number)

    def advanced(self, pointer: int) -> int:
        """Return the pointer behind an access at ``pointer``."""
        return pointer + 1

    def written(self, name: str, value: int) -> bool:
        """Act on a value written to a register that acts; return whether it is acknowledged."""
        return True

    def reading(self, name: str) -> None:
        """Prepare a register that latches for being read."""

    def put(self, name: str, value: float) -> None:
        """Set a register: rounded, and at most what its format holds."""
        self._put(self.registers[name], value)

    def get(self, name: str) -> int:
        """Return a register's value."""
        register = self.registers[name]
        places = register.places
        return unpacked(register.form, self.store[places.start : places.stop])

    def put_vector(self, first: str, values: Iterable[float]) -> None:
        """Set registers of the format of the first, one behind the other."""
        register = self.registers[first]
        listed = list(values)
        try:
            data = struct.pack(_packing(register.form, len(listed)), *map(round, listed))
        except (struct.error, ValueError, OverflowError):  # beyond what the format holds
            data = b"".join(packed(register.form, value) for value in listed)
        self._store(register, data)

    def _put(self, register: Register, value: float) -> None:
        self._store(register, packed(register.form, value))

    def _store(self, register: Register, data: bytes) -> None:
        begin, end = register.at, register.at + len(data)
        # Of registers that the sketch may have written, the board's value is another.
        if register.access == "rw" or self.store[begin:end] != data:
            self.store[begin:end] = data
            self._unsent.append((begin, end))

    def _mask(self) -> int:
        return self.pointer_mask

    def connect(self, index: int, records: Inputs) -> None:
        """Put the part at the board, with its registers."""
        super().connect(index, records)
        for register in self.registers.values():
            self._unsent.append((register.places.start, register.places.stop))
            for at in register.places:
                if access := _ACCESSES[register.access]:
                    records.put("g", index, _ACCESS, at << 8 | access)
        self._next = [(pointer + 1) & 0xFF for pointer in range(256)]
        self._point()
        self.flush(records)

    def _called(self, call: int, value: int, sent: bytes) -> int:
        at = value >> 8 if call == WRITE else value
        name = next((name for name, each in self.registers.items() if at in each.places), "")
        if call == READ:
            self.reading(name)
            return 1
        self.store[at] = value & 0xFF
        taken = self.written(name, value & 0xFF)
        self._point()
        return int(taken)

    def _point(self) -> None:
        """Send where the pointer goes, as far as that has changed."""
        for pointer, sent in enumerate(self._next):
            if (following := self.advanced(pointer) & 0xFF) != sent:
                self._next[pointer] = following
                self._records.put("g", self._index, _NEXT, pointer << 8 | following)

    def flush(self, records: Inputs) -> None:
        """Put what has changed into ``records``."""
        super().flush(records)
        for begin, end in self._unsent:
            for at in range(begin, end, _RUN):
                count = min(_RUN, end - at)
                data = self.store[at : at + count]
                records.data += _BYTES.pack(ord("G"), self._index, at << 8 | count, data)
        self._unsent.clear()
        if self.answers != self._answered:
            self._answered = self.answers
            records.put("y", self._index, 0.0, int(not self.answers) << 8)


class I2CStream(Part):
    """A part that takes commands, byte by byte, and whose reply is then read."""

    kind = _STREAM
    address = True
    begins: ClassVar[bool] = False
    """Whether `begun` is called before each reading."""

    def written(self, byte: int) -> bool:
        """Take a byte in; return whether it is acknowledged."""
        return True

    def begun(self, left: int) -> None:
        """Prepare a reply, for a reading begins; ``left`` bytes of the last are unread."""

    def reply(self, data: bytes, beyond: int = 0) -> None:
        """Let ``data`` be read next, then ``beyond`` for ever."""
        self._reply(data, beyond)

    def _mask(self) -> int:
        return _BEGINS if self.begins else 0

    def _called(self, call: int, value: int, sent: bytes) -> int:
        if call == WRITE:
            return int(self.written(value))
        self.begun(value)
        return 1


class SpiPart(Part):
    """A part at the SPI, its first place the pin that selects it, low.

    A byte goes each way at the same time, so that a reply is there before its byte has come.
    """

    kind = _SPI

    def __init__(self, places: tuple[int, ...], number: int = 1) -> None:
        super().__init__(places, number)
        self.drive(places[0], [(0.0, 1)])  # a pull-up holds it until the sketch does

    def selected(self) -> None:
        """Begin: the pin went low."""

    def exchange(self, sent: bytes) -> bytes:
        """Take in what has come since the last call, and return the next replies, one at least."""
        return b"\xff"

    def released(self, sent: bytes) -> None:
        """End: the pin went high; ``sent`` has come since the last call."""

    def _called(self, call: int, value: int, sent: bytes) -> int:
        if call == TRANSFER:
            self._reply(self.exchange(sent) or b"\xff", 0xFF)
        elif value:
            self._reply(b"", 0xFF)
            self.selected()
        else:
            self.released(sent)
        return 1


class PinPart(Part):
    """A part at pins, the first of which it follows."""

    kind = _PIN

    def edge(self, level: int) -> None:
        """Take in that the sketch has turned the first pin, now, at ``time``."""

    def _called(self, call: int, value: int, sent: bytes) -> int:
        self.edge(value)
        return 1


class UartPart(Part):
    """A part at the line of a UART, written ``uart1``, besides what is on ``rx``.

    It has what the board sends at the end of each step, and what it sends arrives from the next on.
    """

    def received(self, data: bytes) -> None:
        """Take in what the board has sent until ``time``."""

    def send(self, data: bytes) -> None:
        """Put bytes on the line to the board, one after the other at its rate."""
        for byte in data:
            self._records.put("U", self.places[0], self.time * CLOCK, byte)

    def connect(self, index: int, records: Inputs) -> None:
        """Put nothing at the board: its UART is there."""
