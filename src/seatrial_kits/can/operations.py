"""Operations of FMI-LS-BUS between CAN nodes and a bus, as bytes.

Modelica Association, FMI Layered Standard Network Communication, version 1.3, section CAN: each
operation is a code and its whole length, 32 bits each, then its arguments; all little endian.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache

from seatrial.errors import InputError

from .frame import Frame


class Error(IntEnum):
    """Kinds of bus error."""

    BIT = 1
    STUFF = 2
    FORM = 3
    CRC = 4
    ACK = 5
    BROKEN_ERROR_FRAME = 6


class State(IntEnum):
    """States of a node (ISO 11898-1, fault confinement)."""

    ERROR_ACTIVE = 1
    ERROR_PASSIVE = 2
    BUS_OFF = 3


@dataclass(frozen=True, slots=True)
class FormatError:
    """An operation that its reader could not understand, and its bytes."""

    operation: bytes


@dataclass(frozen=True, slots=True)
class Transmit:
    """To the bus: send a frame. From the bus: a frame was received."""

    frame: Frame


@dataclass(frozen=True, slots=True)
class Confirm:
    """From the bus: the frame with this identifier was sent, and acknowledged."""

    identifier: int


@dataclass(frozen=True, slots=True)
class ArbitrationLost:
    """From the bus: another frame went first, and this one was discarded."""

    identifier: int


@dataclass(frozen=True, slots=True)
class BusError:
    """From the bus: something was wrong with a frame."""

    identifier: int
    error: Error
    primary: bool
    """This node detected it first."""
    sender: bool
    """This node was sending."""


@dataclass(frozen=True, slots=True)
class BitRate:
    """To the bus: the bit rate that a node expects, bit/s; of the data phase if ``fd``."""

    rate: int
    fd: bool = False


@dataclass(frozen=True, slots=True)
class Buffering:
    """To the bus: whether frames that lose an arbitration wait, or are discarded and reported."""

    waits: bool


@dataclass(frozen=True, slots=True)
class Status:
    """To the bus: the state that a node's own controller is in."""

    state: State


@dataclass(frozen=True, slots=True)
class Wakeup:
    """To and from the bus: wake up."""


Operation = (
    FormatError
    | Transmit
    | Confirm
    | ArbitrationLost
    | BusError
    | BitRate
    | Buffering
    | Status
    | Wakeup
)

_HEADER = struct.Struct("<II")
_MOST_SHOWN = 0xFFFF
"""Bytes of an operation that a format error quotes."""
_CAN = struct.Struct("<IBBH")  # identifier, IDE, RTR, length
_FD = struct.Struct("<IBBBH")  # identifier, IDE, BRS, ESI, length
_ID = struct.Struct("<I")
_BUS_ERROR = struct.Struct("<IBBB")
_BIT_RATE = struct.Struct("<BI")
_TWO = struct.Struct("<BB")
_ONE = struct.Struct("<B")
_LENGTH = struct.Struct("<H")

(FORMAT_ERROR, CAN_TRANSMIT, FD_TRANSMIT, XL_TRANSMIT) = (0x01, 0x10, 0x11, 0x12)
(CONFIRM, ARBITRATION_LOST, BUS_ERROR) = (0x20, 0x30, 0x31)
(CONFIGURATION, STATUS, WAKEUP) = (0x40, 0x41, 0x42)
_CAN_RATE, _FD_RATE, _XL_RATE, _BEHAVIOUR = 1, 2, 3, 4
_WAITS, _DISCARDED = 1, 2
_PRIMARY, _SECONDARY = 1, 2


def encode(operation: Operation) -> bytes:
    """Return an operation as bytes."""
    match operation:
        case Transmit(frame):
            return (
                _whole(FD_TRANSMIT, _fd(frame)) if frame.fd else _whole(CAN_TRANSMIT, _can(frame))
            )
        case Confirm(identifier):
            return _whole(CONFIRM, _ID.pack(identifier))
        case ArbitrationLost(identifier):
            return _whole(ARBITRATION_LOST, _ID.pack(identifier))
        case BusError(identifier, error, primary, sender):
            flag = _PRIMARY if primary else _SECONDARY
            return _whole(BUS_ERROR, _BUS_ERROR.pack(identifier, error, flag, sender))
        case BitRate(rate, fd):
            return _whole(CONFIGURATION, _BIT_RATE.pack(_FD_RATE if fd else _CAN_RATE, rate))
        case Buffering(waits):
            return _whole(CONFIGURATION, _TWO.pack(_BEHAVIOUR, _WAITS if waits else _DISCARDED))
        case Status(state):
            return _whole(STATUS, _ONE.pack(state))
        case Wakeup():
            return _whole(WAKEUP, b"")
        case FormatError(found):
            found = found[:_MOST_SHOWN]
            return _whole(FORMAT_ERROR, _LENGTH.pack(len(found)) + found)


def decode(data: bytes) -> list[Operation]:
    """Return the operations in ``data``, one after the other.

    Raises InputError for bytes that are no operations; CAN XL is not known here.
    """
    return list(_decoded_all(data))


@lru_cache(4096)  # a frame is read by all nodes of a bus
def _decoded_all(data: bytes) -> tuple[Operation, ...]:
    found: list[Operation] = []
    while data:
        if len(data) < _HEADER.size:
            raise InputError(f"{data.hex()} is too short for a bus operation")
        code, length = _HEADER.unpack_from(data)
        if not _HEADER.size <= length <= len(data):
            raise InputError(f"a bus operation of {length} bytes, {len(data)} are there")
        found.append(_decoded(code, data[_HEADER.size : length]))
        data = data[length:]
    return tuple(found)


def _whole(code: int, arguments: bytes) -> bytes:
    return _HEADER.pack(code, _HEADER.size + len(arguments)) + arguments


def _can(frame: Frame) -> bytes:
    # As many bytes as a remote frame requests: its length would be lost otherwise.
    data = bytes(frame.requested) if frame.remote else frame.data
    return _CAN.pack(frame.identifier, frame.extended, frame.remote, len(data)) + data


def _fd(frame: Frame) -> bytes:
    flags = (frame.extended, frame.bit_rate_switch, frame.error_state)
    return _FD.pack(frame.identifier, *flags, len(frame.data)) + frame.data


def _decoded(code: int, arguments: bytes) -> Operation:
    try:
        return _read(code, arguments)
    except (struct.error, ValueError) as error:
        raise InputError(f"bus operation 0x{code:02X}, {arguments.hex()}: {error}") from None


def _read(code: int, arguments: bytes) -> Operation:
    match code:
        case 0x10:
            identifier, extended, remote, length = _CAN.unpack_from(arguments)
            data = _data(arguments, _CAN.size, length)
            if _truth(remote):
                request = Frame(identifier, b"", _truth(extended), True, requested=length)
                return Transmit(request)
            return Transmit(Frame(identifier, data, _truth(extended)))
        case 0x11:
            identifier, extended, switch, passive, length = _FD.unpack_from(arguments)
            data = _data(arguments, _FD.size, length)
            return Transmit(
                Frame(
                    identifier,
                    data,
                    _truth(extended),
                    fd=True,
                    bit_rate_switch=_truth(switch),
                    error_state=_truth(passive),
                )
            )
        case 0x20:
            return Confirm(*_ID.unpack(arguments))
        case 0x30:
            return ArbitrationLost(*_ID.unpack(arguments))
        case 0x31:
            identifier, error, flag, sender = _BUS_ERROR.unpack(arguments)
            if flag not in (_PRIMARY, _SECONDARY):
                raise InputError(f"error flag {flag}, allowed 1 and 2")
            return BusError(identifier, Error(error), flag == _PRIMARY, _truth(sender))
        case 0x40:
            return _configuration(arguments)
        case 0x41:
            return Status(State(*_ONE.unpack(arguments)))
        case 0x42 if not arguments:
            return Wakeup()
        case 0x01:
            (length,) = _LENGTH.unpack_from(arguments)
            return FormatError(_data(arguments, _LENGTH.size, length))
    raise InputError(f"unknown bus operation 0x{code:02X}")


def _configuration(arguments: bytes) -> Operation:
    kind = arguments[0] if arguments else 0
    if kind in (_CAN_RATE, _FD_RATE):
        return BitRate(_BIT_RATE.unpack(arguments)[1], kind == _FD_RATE)
    if kind == _BEHAVIOUR:
        behaviour = _TWO.unpack(arguments)[1]
        if behaviour in (_WAITS, _DISCARDED):
            return Buffering(behaviour == _WAITS)
    raise InputError(f"unknown configuration {arguments.hex()}")


def _data(arguments: bytes, offset: int, length: int) -> bytes:
    if len(arguments) - offset != length:
        raise InputError(f"{len(arguments) - offset} bytes of data, {length} announced")
    return arguments[offset:]


def _truth(value: int) -> bool:
    if value not in (0, 1):
        raise InputError(f"{value} is neither true (1) nor false (0)")
    return bool(value)
