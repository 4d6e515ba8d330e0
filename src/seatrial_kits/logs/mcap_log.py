"""MCAP files of JSON messages as logs: those of ``seatrial export --mcap``, Foxglove and others."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Log, Samples
from seatrial.trial.logs.clock_times import date_of
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import QUANTITIES, Column
from seatrial.trial.logs.reading_progress import open_bytes

from .run_log import of_craft

_MAGIC = b"\x89MCAP0\r\n"
_ROS = (b"ros1", b"ros2")
"""Profiles of recordings that are read as bags."""
_NS = 10**9


def _read(path: Path, _: Column | None) -> Log:
    """Return the log in an MCAP file: numbers of its JSON messages, ``TOPIC.FIELD``.

    A field serves the quantity of its name. Units are those of ``unit`` in the JSON schema. Times
    are those of the messages, from the first one on where they are dates. Messages in other
    encodings are left out with a note, and so are those behind the place where a file is cut.

    Raises InputError for a file without such a message.
    """
    samples, skipped = Samples(), Counter[str]()
    units: dict[int, Mapping[str, str]] = {}
    begun: int | None = None
    with open_bytes(path) as file:
        for row, (schema, channel, message) in enumerate(_messages(file, path, skipped), 1):
            if channel.message_encoding != "json":
                skipped[f"messages {channel.topic} in {channel.message_encoding} are left out"] += 1
                continue
            begun = _begin(message.log_time) if begun is None else begun
            if channel.id not in units:
                units[channel.id] = {} if schema is None else dict(_units("", schema.data))
            try:
                content = json.loads(message.data)
            except ValueError:
                skipped[f"messages {channel.topic} that are no JSON are left out"] += 1
                continue
            time = (message.log_time - begun) / _NS
            for name, value in _numbers("", content):
                full = f"{channel.topic.strip('/')}.{name}" if name else channel.topic.strip("/")
                samples.add(full, units[channel.id].get(name), time, value, row)
    channels = samples.channels()
    notes = tuple(f"{count} {what}" for what, count in skipped.items())
    if not channels:
        raise InputError(f"{path}: no message in JSON with a number; {'; '.join(notes)}")
    craft = of_craft(channels)
    served = {
        what: [what, *craft.get(what, ()), *(n for n in channels if n.endswith(f".{what}"))]
        for what in QUANTITIES
    }
    return Log(path, channels, served, date_of((begun or 0) / _NS), notes)


def _messages(file: Any, path: Path, skipped: Counter[str]) -> Iterator[tuple[Any, Any, Any]]:
    """Yield schema, channel and message in the order of the file, also of one that is cut."""
    from mcap.records import Channel, Chunk, Message, Schema
    from mcap.stream_reader import StreamReader, breakup_chunk

    schemas: dict[int, Any] = {}
    channels: dict[int, Any] = {}
    try:
        for found in StreamReader(file, emit_chunks=True).records:
            for record in breakup_chunk(found) if isinstance(found, Chunk) else (found,):
                if isinstance(record, Schema):
                    schemas[record.id] = record
                elif isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Message):
                    channel = channels[record.channel_id]
                    yield schemas.get(channel.schema_id), channel, record
    except Exception as error:  # whatever mcap makes of bytes that are no recording
        if not channels:
            raise InputError(f"{path}: no MCAP file: {error or type(error).__name__}") from None
        skipped["part is cut off or damaged: the messages behind it are left out"] += 1


def _begin(time: int) -> int:
    """Return what times are counted from, ns: the first where they are dates, else 0."""
    return time if date_of(time / _NS) is not None else 0


def _units(path: str, data: bytes | Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the units of the properties of a JSON schema by their paths."""
    try:
        schema = data if isinstance(data, Mapping) else json.loads(data)
    except ValueError:
        return
    if not isinstance(schema, Mapping):
        return
    if isinstance(schema.get("unit"), str):
        yield path, schema["unit"]
    properties = schema.get("properties")
    for name, each in properties.items() if isinstance(properties, Mapping) else ():
        if isinstance(each, Mapping):
            yield from _units(f"{path}.{name}" if path else name, each)


def _numbers(path: str, content: Any) -> Iterator[tuple[str, float]]:
    """Yield numbers and flags of a message by their paths."""
    if isinstance(content, (bool, int, float)):
        yield path, float(content)
    elif isinstance(content, Mapping):
        for name, each in content.items():
            yield from _numbers(f"{path}.{name}" if path else str(name), each)


def _recognises(path: Path, head: bytes) -> bool:
    """Return whether a file is MCAP, and not one of ROS: those are bags."""
    if not head.startswith(_MAGIC):
        return False
    size = int.from_bytes(head[17:21], "little")  # behind the header's opcode and length
    return head[21 : 21 + size] not in _ROS


MCAP = Format("MCAP of JSON messages", _recognises, _read)
