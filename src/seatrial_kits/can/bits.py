"""Exact lengths of frames on the bus: fields, CRC and stuff bits (ISO 11898-1).

After five equal bits a transmitter inserts one of the other value: in classic frames from the
start of frame to the end of the CRC, in CAN FD to the end of the data. CAN FD's CRC field has
stuff bits at fixed places instead: before its first bit and after each four.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from .frame import Frame

CRC15 = 0x4599
"""x15 + x14 + x10 + x8 + x7 + x4 + x3 + 1, without its highest bit."""
TAIL = 10
"""CRC delimiter, acknowledgement and its delimiter, and seven bits of end of frame."""
INTERMISSION = 3
"""Bits between frames."""


class Length(NamedTuple):
    """Bits of a frame from its start to its end, without the intermission."""

    nominal: int
    """At the nominal rate."""
    data: int = 0
    """At the rate of the data phase."""


def crc15(bits: int, count: int) -> int:
    """Return the CRC of the ``count`` lowest bits of ``bits``, the highest first."""
    register = 0
    for byte in bits.to_bytes((count + 7) // 8, "big"):  # zeros in front leave it at 0
        register = (register << 8 & 0x7F00) ^ _CRC_OF[(register >> 7 & 0xFF) ^ byte]
    return register


def length(frame: Frame) -> Length:
    """Return how many bits ``frame`` has on the bus."""
    if frame.fd:
        return _fd_length(frame)
    data = frame.data
    found, state, register = _begun(frame.identifier, frame.extended, frame.remote, frame.dlc)
    for byte in data:
        added, state = _BYTE[state][byte]
        found += added
        register = (register << 8 & 0x7F00) ^ _CRC_OF[(register >> 7 & 0xFF) ^ byte]
    added, state = _SEVEN[state][register >> 8]
    found += added + _BYTE[state][register & 0xFF][0]
    return Length(found + 8 * len(data) + (64 if frame.extended else 44))


def sequence(frame: Frame) -> tuple[int, int]:
    """Return a classic frame's bits from start of frame to CRC, unstuffed, and their number."""
    header, count = _header(frame.identifier, frame.extended, frame.remote, frame.dlc)
    size = 8 * len(frame.data)
    bits, count = header << size | int.from_bytes(frame.data, "big"), count + size
    return bits << 15 | crc15(bits, count), count + 15


def stuffed(bits: int, count: int) -> int:
    """Return the number of stuff bits of ``count`` bits, the highest first."""
    return _after(_START, bits, count)[0]


def first_difference(one: Frame, other: Frame) -> tuple[int, bool]:
    """Return the place of the first bit in which two different frames differ on the bus.

    Counted from 0 at the start of frame, stuff bits included; and whether ``one`` is recessive
    there. They must have the same arbitration field.
    """
    first, second = _on_the_bus(one), _on_the_bus(other)
    for place, (a, b) in enumerate(zip(first, second, strict=False)):
        if a != b:
            return place, a == 1
    raise ValueError("the frames do not differ")


def _on_the_bus(frame: Frame) -> list[int]:
    """Return the bits from start of frame to the end of what is stuffed, stuff bits included."""
    if frame.fd:
        count, *_ = _fd_begun(frame.identifier, frame.extended, frame.bit_rate_switch)
        bits = _fd_arbitration(frame.identifier, frame.extended, frame.bit_rate_switch)
        size = 8 * len(frame.data)
        control = int(frame.error_state) << 4 | frame.dlc
        bits = (bits << 5 | control) << size | int.from_bytes(frame.data, "big")
        count += 5 + size
    else:
        bits, count = sequence(frame)
    state, stuffed = _START, []
    for shift in range(count - 1, -1, -1):
        bit = bits >> shift & 1
        added, state = _after_bit(state, bit)
        stuffed += [bit, 1 - bit] if added else [bit]
    return stuffed


@lru_cache(4096)
def _begun(identifier: int, extended: bool, remote: bool, dlc: int) -> tuple[int, int, int]:
    """Return the stuff bits, the state and the CRC register after a classic frame's header."""
    bits, count = _header(identifier, extended, remote, dlc)
    return *_after(_START, bits, count), crc15(bits, count)


def _header(identifier: int, extended: bool, remote: bool, dlc: int) -> tuple[int, int]:
    """Return start of frame, arbitration and control field: the bits and their number."""
    if extended:
        base, rest = identifier >> 18, identifier & 0x3FFFF
        # SOF 0, base, SRR 1, IDE 1, rest, RTR, r1 0, r0 0, DLC
        return (((base << 2 | 0b11) << 18 | rest) << 1 | remote) << 6 | dlc, 39
    return (identifier << 1 | remote) << 6 | dlc, 19  # SOF 0, ID, RTR, IDE 0, r0 0, DLC


def _fd_length(frame: Frame) -> Length:
    count, before, state = _fd_begun(frame.identifier, frame.extended, frame.bit_rate_switch)
    inside = _fd_stuffed(state, frame)
    crc = 4 + (17 if len(frame.data) <= 16 else 21)  # stuff count with parity, CRC
    fast = 5 + 8 * len(frame.data) + inside + crc + (crc + 3) // 4
    slow = count + before + TAIL
    if frame.bit_rate_switch:
        # BRS and the CRC delimiter change the rate at their sample points: together they last one
        # bit of either rate.
        return Length(slow - 1, fast + 1)
    return Length(slow + fast)


def _fd_arbitration(identifier: int, extended: bool, switch: bool) -> int:
    """Return the bits from start of frame to BRS."""
    if extended:
        base, rest = identifier >> 18, identifier & 0x3FFFF
        # SOF 0, base, SRR 1, IDE 1, rest, RRS 0, FDF 1, res 0, BRS
        return ((base << 2 | 0b11) << 18 | rest) << 4 | 0b0100 | switch
    return identifier << 5 | 0b00100 | switch  # SOF 0, ID, RRS 0, IDE 0, FDF 1, res 0, BRS


@lru_cache(4096)
def _fd_begun(identifier: int, extended: bool, switch: bool) -> tuple[int, int, int]:
    """Return the bits from start of frame to BRS, their stuff bits, and the state after them."""
    count = 36 if extended else 17
    return count, *_after(_START, _fd_arbitration(identifier, extended, switch), count)


def _fd_stuffed(state: int, frame: Frame) -> int:
    """Return the stuff bits from ESI to the end of the data.

    A stuff bit due after the very last bit is the CRC field's first fixed one, and not counted.
    """
    control = int(frame.error_state) << 4 | frame.dlc
    if not frame.data:
        return _after(state, control >> 1, 4)[0]
    found, state = _after(state, control, 5)
    for byte in frame.data[:-1]:
        added, state = _BYTE[state][byte]
        found += added
    return found + _SEVEN[state][frame.data[-1] >> 1][0]


def _crc_table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        register = byte << 7
        for _ in range(8):
            register = register << 1 ^ (CRC15 if register & 0x4000 else 0)
            register &= 0x7FFF
        table.append(register)
    return tuple(table)


# States of the run of equal bits at the end of what was sent: 2 * (length - 1) + bit, or none.
_START = 10


def _after_bit(state: int, bit: int) -> tuple[int, int]:
    """Return the stuff bits that a bit brings, 0 or 1, and the state after them."""
    run = 1 if state == _START or state & 1 != bit else (state >> 1) + 2
    if run == 5:
        return 1, 1 - bit  # the inserted bit begins a run of one
    return 0, 2 * (run - 1) + bit


def _after(state: int, bits: int, count: int) -> tuple[int, int]:
    """Return the stuff bits that ``count`` bits bring, and the state after them."""
    found = 0
    for shift in range(count - 1, -1, -1):
        added, state = _after_bit(state, bits >> shift & 1)
        found += added
    return found, state


_CRC_OF = _crc_table()
_BYTE = tuple(tuple(_after(state, byte, 8) for byte in range(256)) for state in range(11))
_SEVEN = tuple(tuple(_after(state, bits, 7) for bits in range(128)) for state in range(11))
