"""Logs of an NMEA 2000 network: candump's text, and Vector's .blf."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import can

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Log, Samples
from seatrial.trial.logs.clock_times import date_of
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column
from seatrial_kits.can.frame import Frame

from .codec import Decoder, Message, header
from .quantities import READERS

_LINE = re.compile(
    r"\s*\((?P<time>\d+\.\d+)\)\s+\S+\s+(?:[TR]X?\s+[-B]*\s*)?(?P<id>[0-9A-Fa-f]{3}(?:[0-9A-Fa-f]{5})?)"
    r"(?:#(?P<data>(?:[0-9A-Fa-f]{2}){0,8})|\s+\[\d\]\s+(?P<bytes>(?:[0-9A-Fa-f]{2}(?:\s+|$)){0,8}))"
)
"""As ``candump -L`` and ``candump -ta`` write a frame."""
_BLF = b"LOGG"
_FIX = 129029
_NO_GNSS = _TRUE = 0
_CHANNELS: dict[str, tuple[tuple[str, str], ...]] = {
    "heading": (("heading", "rad"),),
    "rate_of_turn": (("rate_of_turn", "rad/s"),),
    "rudder": (("rudder", "rad"),),
    "rudder_order": (("rudder_order", "rad"),),
    "place": (("latitude", "deg"), ("longitude", "deg")),
    "altitude": (("altitude", "m"),),
    "water_speed": (("water_speed", "m/s"),),
    "depth": (("depth", "m"),),
    "wind": (("wind_speed", "m/s"), ("wind_angle", "rad")),
}
"""Channels of the quantities of `READERS`, with units."""
_FIELDS: dict[int, tuple[tuple[str, str, str], ...]] = {
    127257: (("roll", "roll", "rad"), ("pitch", "pitch", "rad"), ("yaw", "yaw", "rad")),
    129026: (("sog", "speed", "m/s"),),
}
"""Fields that are channels each for itself, by PGN: a node wants all of them, or none."""
_DEFAULTS = {
    "latitude": ("129025.latitude", "129029.latitude"),
    "longitude": ("129025.longitude", "129029.longitude"),
    "heading": ("127250.heading",),
    "course": ("129026.course",),
    "speed": ("129026.speed",),
    "water_speed": ("128259.water_speed",),
    "helm": ("127245.rudder",),
    "roll": ("127257.roll",),
    "pitch": ("127257.pitch",),
    "yaw_rate": ("127251.rate_of_turn",),
    "water_depth": ("128267.depth",),
}


def _read(path: Path, _: Column | None) -> Log:
    """Return the log of a network: channels ``PGN.NAME`` of the quantities that nodes read here.

    Times are those of the recorder. The first source of a channel keeps its plain name; others have
    their address before it. Headings are true: a magnetic one has its variation added, or is left
    out. Positions without a fix are left out.

    Raises InputError for a file without a frame.
    """
    skipped: Counter[str] = Counter()
    frames = _blf(path) if _is_blf(path) else _candump(path, skipped)
    decoder, samples = Decoder({}), Samples()
    others, begun = set(), None
    for row, time, frame in frames:
        begun = time if begun is None else begun
        pgn = header(frame)[0]
        if pgn not in READERS:
            others.add(pgn)
        elif (message := decoder.decode(frame)) is not None:
            if pgn == _FIX and message.fields.get("method") == _NO_GNSS:
                skipped["positions (129029) without a fix are left out"] += 1
            else:
                _add(samples, message, time - begun, row)
    if begun is None:
        raise InputError(f"{path}: no frame of an NMEA 2000 network was found: no candump log")
    notes = [f"{count} {what}" for what, count in skipped.items()]
    if others:
        notes.append(f"{len(others)} PGNs are not read: {', '.join(map(str, sorted(others)))}")
    return Log(
        path, "nmea2000", samples.channels(), _DEFAULTS, date_of(begun), tuple(notes), row="line"
    )


def _add(samples: Samples, message: Message, time: float, row: int) -> None:
    for name, unit, value in _values(message):
        if value is not None:
            where = f"{message.pgn}.{name}"
            samples.add(where, unit, time, float(value), row, str(message.source))


def _values(message: Message) -> Iterator[tuple[str, str, float | None]]:
    """Yield name, unit and value of the channels of a message."""
    fields = message.fields
    for field, name, unit in _FIELDS.get(message.pgn, ()):
        yield name, unit, fields.get(field)
    if message.pgn == 129026 and fields.get("cogReference") == _TRUE:
        yield "course", "rad", fields.get("cog")
    instance = fields.get("instance") if message.pgn == 127245 else 0
    suffix = f"[{instance}]" if instance else ""
    for quantity, values in READERS[message.pgn](fields).items():
        engine = ((quantity, "rad/s"),) if quantity.startswith("engine ") else ()
        named = zip(_CHANNELS.get(quantity, engine), values or (), strict=False)
        for (name, unit), value in named:
            yield name + suffix, unit, value


def _candump(path: Path, skipped: Counter[str]) -> Iterator[tuple[int, float, Frame]]:
    with path.open(encoding="latin-1") as file:
        for row, line in enumerate(file, 1):
            found = _LINE.match(line)
            if found is not None and len(found["id"]) == 8:
                data = found["data"] if found["data"] is not None else found["bytes"]
                identifier = int(found["id"], 16)
                if identifier < 1 << 29:
                    yield (
                        row,
                        float(found["time"]),
                        Frame(identifier, bytes.fromhex(data), extended=True),
                    )
            elif found is None and line.strip():
                skipped["lines that are no frame are skipped"] += 1


def _blf(path: Path) -> Iterator[tuple[int, float, Frame]]:
    try:
        with can.BLFReader(str(path)) as reader:
            for row, entry in enumerate(reader, 1):
                if entry.is_extended_id and not (entry.is_remote_frame or entry.is_error_frame):
                    data = bytes(entry.data)
                    yield row, entry.timestamp, Frame(entry.arbitration_id, data, extended=True)
    except Exception as error:  # whatever python-can makes of bytes that are no log
        raise InputError(f"{path}: no log of Vector: {error}") from None


def _is_blf(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(_BLF)) == _BLF


def _recognises(path: Path, head: bytes) -> bool:
    if head.startswith(_BLF):
        return True
    return any(_LINE.match(line.decode("latin-1")) for line in head.splitlines()[:20])


NMEA2000 = Format("log of an NMEA 2000 network, by candump", _recognises, _read)
