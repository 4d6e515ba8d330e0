"""Messages as frames and back, by the package nmea2000: no bit is packed here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

from nmea2000 import FieldTypes, NMEA2000Decoder, NMEA2000Field, NMEA2000Message, create_encoder
from nmea2000.backend import DATABASE
from nmea2000.input_formats import N2KFormat

from seatrial_kits.can.frame import Frame
from seatrial_kits.can.messages import frame_of, message

from .catalogue import ALL

GLOBAL, NO_ADDRESS = 255, 254
"""All nodes as a destination; the source of a node without address (ISO 11783-5)."""

_REFUSALS = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
"""What the package lets through for contents that no layout has."""
_LIST = "##list##"
"""What the package calls a message's repeated fields."""
_TEXTS = (FieldTypes.STRING_FIX, FieldTypes.STRING_LZ, FieldTypes.STRING_LAU)
_MOST_FRAMES = 32
"""Frames of the longest fast packet: 6 bytes, then 7 in each, 223 in all."""
_MOST_BYTES = 223
_SEQUENCE = 0xE0
"""Bits of a fast frame's first byte that number the packet; the others number its frames."""

Fields = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Message:
    """A whole message: fields by canboat's names; None, or left out, is not available.

    Numbers are in SI but for latitude and longitude (deg), speeds of engines (rpm), percentages and
    hours; lookups are their numbers, dates days since 1970, times seconds since midnight.
    ``items`` are the repeated fields.
    """

    pgn: int
    fields: Fields
    source: int = NO_ADDRESS
    destination: int = GLOBAL
    items: tuple[Fields, ...] = ()
    id: str = ""
    """Canboat's name of the layout, where a PGN has several."""


class Encoder:
    """Writes messages. ``sequences`` counts the fast packets of each PGN: plain data, its own."""

    def __init__(self, sequences: dict[str, int]) -> None:
        self._encoder = create_encoder(N2KFormat.PYTHON_CAN)
        self._sequences = sequences

    def encode(self, sent: Message) -> list[Frame]:
        """Return the frames of a message; a value that its field cannot hold is not available."""
        key = str(sent.pgn)
        self._encoder.sequence_counter = self._sequences.get(key, 0)
        try:
            frames = self._frames(sent)
        except ValueError:
            kept = {name: value for name, value in sent.fields.items() if self._fits(sent, name)}
            frames = self._frames(Message(sent.pgn, kept, sent.source, sent.destination))
        self._sequences[key] = self._encoder.sequence_counter
        return frames

    def _fits(self, sent: Message, name: str) -> bool:
        try:
            self._frames(Message(sent.pgn, {name: sent.fields[name]}, sent.source, id=sent.id))
        except ValueError:
            return False
        return True

    def _frames(self, sent: Message) -> list[Frame]:
        known = ALL[sent.pgn]
        fields = [_field(name, value) for name, value in sent.fields.items()]
        if sent.items:
            listed = [{name: _field(name, v) for name, v in each.items()} for each in sent.items]
            fields.append(NMEA2000Field(_LIST, value=listed))
        whole = NMEA2000Message(
            PGN=sent.pgn,
            id=sent.id or known.id,
            priority=known.priority,
            source=sent.source,
            destination=sent.destination,
            fields=fields,
        )
        found = [frame_of(each) for each in self._encoder.encode(whole)]
        return [frame for frame in found if frame is not None]


class Decoder:
    """Reads messages. ``unfinished`` holds the frames of fast packets that are not whole yet.

    That is plain data, the caller's, by source: a new decoder goes on where another was.
    """

    def __init__(self, unfinished: dict[str, dict[str, list[list[Any]]]]) -> None:
        self._unfinished = unfinished
        self._begin()

    def decode(self, frame: Frame) -> Message | None:
        """Return the message that a frame completes, None if there is none that is known."""
        if not frame.extended or frame.remote or frame.fd or not frame.data:
            return None
        pgn, source, destination, _ = header(frame)
        if pgn not in ALL:
            return None
        if not is_fast(pgn):
            return _single(frame.identifier, frame.data)
        whole, key = _decoded(self._decoder, frame), f"{pgn} {destination}"
        before = self._unfinished.get(str(source), {}).get(key, [])
        length = _length(frame.data, [bytes.fromhex(data) for _, data in before])
        self._keep(key, str(source), frame, whole is not None)
        return None if whole is None else _read(whole, pgn, source, destination, length)

    def forget(self, source: int) -> None:
        """Drop what a source has begun: its address is another node's now."""
        if self._unfinished.pop(str(source), None):
            self._begin()

    def _begin(self) -> None:
        self._decoder = NMEA2000Decoder()
        for packets in self._unfinished.values():
            for frames in packets.values():
                for identifier, data in frames:
                    frame = Frame(identifier, bytes.fromhex(data), extended=True)
                    _decoded(self._decoder, frame)

    def _keep(self, key: str, source: str, frame: Frame, done: bool) -> None:
        packets = self._unfinished.setdefault(source, {})
        if done:
            packets.pop(key, None)
            if not packets:
                del self._unfinished[source]
            return
        frames = packets.setdefault(key, [])
        frames.append([frame.identifier, frame.data.hex()])
        del frames[:-_MOST_FRAMES]


@cache
def is_fast(pgn: int) -> bool:
    """Whether a PGN goes as a fast packet."""
    return bool(NMEA2000Decoder.is_fast_pgn(pgn))


def header(frame: Frame) -> tuple[int, int, int, int]:
    """Return PGN, source, destination and priority of a frame."""
    found: tuple[int, int, int, int] = NMEA2000Decoder.extract_header(frame.identifier)
    return found


@cache
def _singles() -> Any:
    """Return the decoder of messages of one frame, of which it keeps nothing; slow to make."""
    return NMEA2000Decoder()


@lru_cache(1024)  # a frame is read by all nodes of a bus
def _single(identifier: int, data: bytes) -> Message | None:
    frame = Frame(identifier, data, extended=True)
    pgn, source, destination, _ = header(frame)
    whole = _decoded(_singles(), frame)
    if whole is None:
        return None
    return _read(whole, pgn, source, destination, len(data))


def _length(last: bytes, before: Sequence[bytes]) -> int:
    """Return the bytes of a fast packet, as the first frame of its sequence has them."""
    first = last[0] & _SEQUENCE
    found = (data[1] for data in (last, *reversed(before)) if len(data) > 1 and data[0] == first)
    return next(found, _MOST_BYTES)


@lru_cache(1024)
def _cut(pgn: int, variant: str, bits: int) -> frozenset[str]:
    """Return the fields that end behind a number of bits, by canboat's table."""
    layouts = [each for each in DATABASE.pgn_variants(pgn) if each.id == variant]
    fields = [field for each in layouts for field in each.fields]
    return frozenset(f.id for f in fields if (f.bit_offset or 0) + (f.bit_length or 0) > bits)


def _decoded(decoder: Any, frame: Frame) -> Any:
    """Return what the package makes of a frame; None for what it cannot read."""
    try:
        return decoder.decode(message(frame, 1.0))
    except _REFUSALS:
        return None


def _field(name: str, value: Any) -> Any:
    return NMEA2000Field(name, value=value, raw_value=value)


def _read(whole: Any, pgn: int, source: int, destination: int, length: int) -> Message:
    """Return what the package has read of a number of bytes; a field that is cut has no value."""
    items: tuple[Fields, ...] = ()
    fields: Fields = {}
    cut = _cut(pgn, whole.id, 8 * length)  # the package reads them as if 0 followed
    for each in whole.fields:
        if each.id == _LIST:
            items = tuple({name: _value(f) for name, f in item.items()} for item in each.value)
        else:
            fields[each.id] = None if each.id in cut else _value(each)
    return Message(pgn, fields, source, destination, items, whole.id)


def _value(found: Any) -> Any:
    return found.value if found.type in _TEXTS else found.raw_value


def numbers(fields: Mapping[str, Any], *names: str) -> tuple[float, ...] | None:
    """Return the values of fields, None if one of them is not available."""
    values = [fields.get(name) for name in names]
    return None if None in values else tuple(float(v) for v in values if v is not None)
