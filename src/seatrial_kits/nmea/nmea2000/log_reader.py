"""Logs of an NMEA 2000 network: recordings of its bus, and the text of gateways."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Log, Samples
from seatrial.trial.logs.clock_times import date_of
from seatrial_kits.can.recorded import recorded_frames

from .codec import Decoder, Message, header, is_fast
from .quantities import READERS

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


def read(path: Path) -> Log:
    """Return the log of a network: channels ``PGN.NAME`` of the quantities that nodes read here.

    Times are those of the recorder. The first source of a channel keeps its plain name; others have
    their address before it. Headings are true: a magnetic one has its variation added, or is left
    out. Positions without a fix are left out.

    Raises InputError for a file without a frame.
    """
    skipped: Counter[str] = Counter()
    decoder, samples = Decoder({}), Samples()
    others, begun = set(), None
    for row, time, _, frame in recorded_frames(path, skipped, is_fast):
        if not frame.extended or frame.remote or frame.fd:
            continue
        if time is None:
            raise InputError(f"{path}, line {row}: no time stands before the frame: no log")
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
        raise InputError(f"{path}: no frame of an NMEA 2000 network was found")
    notes = [f"{count} {what}" for what, count in skipped.items()]
    if others:
        notes.append(f"{len(others)} PGNs are not read: {', '.join(map(str, sorted(others)))}")
    return Log(path, samples.channels(), start=date_of(begun), notes=tuple(notes), row="line")


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
