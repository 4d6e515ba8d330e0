"""Logs of an NMEA 2000 network: recordings of its bus, and the text of gateways."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Log, Samples, counted
from seatrial.trial.logs.clock_times import date_of
from seatrial_kits.can.recorded import recorded_frames

from ..received.memory import Values
from ..received.outputs import DIRECTIONS, ENGINE, ORDERED, SINGLE
from .codec import Decoder, Message, header, is_fast
from .quantities import READERS

_FIX = 129029
_NO_GNSS = 0
_NAMES: dict[str, tuple[tuple[str, str], ...]] = {
    "place": (("latitude", "deg"), ("longitude", "deg")),
    "speed_over_ground": (("speed", "m/s"),),
    "waypoint_place": (("waypoint_latitude", "deg"), ("waypoint_longitude", "deg")),
    **{name: ((name, "rad"),) for name in ("magnetic_heading", "roll", "pitch", "yaw")},
    **{name: ((name, "rad"),) for name in ("wind_angle", "ground_wind_angle", "wind_direction")},
    **{name: ((name, "m/s"),) for name in ("wind_speed", "ground_wind_speed")},
    "altitude": (("altitude", "m"),),
}
"""Channels of quantities, with units, that no output has by their name."""


def _named(quantity: str) -> tuple[tuple[str, str], ...]:
    """Return the channels of a quantity of `READERS`, with units; none of one that no log has."""
    name, _, number = quantity.partition(" ")
    if number:
        return ((quantity, ENGINE[name.removeprefix("engine_")][0]),)
    if name in SINGLE:
        return _NAMES.get(name, ((name, SINGLE[name][0]),))
    return _NAMES.get(name, ((name, "rad"),) if name in DIRECTIONS else ())


_FROM_NORTH = (*DIRECTIONS, "wind_direction")
"""Quantities that a variation makes true ones of, from those called ``magnetic_``."""
_BLOWS_TO = ("wind_angle", "water_wind_angle")
"""Angles that nodes read as where the wind blows to; a log has, as displays do, whence it comes."""


def read(path: Path) -> Log:
    """Return the log of a network: channels ``PGN.NAME`` of the quantities that nodes read here.

    Times are those of the recorder. The first source of a channel keeps its plain name; others have
    their address before it. Headings are true: a magnetic one has its variation added, or is left
    out. Positions without a fix are left out.

    Raises InputError for a file without a frame.
    """
    skipped: Counter[str] = Counter()
    decoder, samples = Decoder({}), Samples()
    others, empty = Counter[int](), Counter[int]()
    begun = None
    variation: list[float] = []
    for row, time, _, frame in recorded_frames(path, skipped, is_fast):
        if not frame.extended or frame.remote or frame.fd:
            continue
        if time is None:
            raise InputError(
                f"{path}, line {row}: the frame has no time, and a log needs one: candump writes "
                "it with -L or -t a"
            )
        begun = time if begun is None else begun
        pgn = header(frame)[0]
        if pgn not in READERS:
            others[pgn] += 1
        elif (message := decoder.decode(frame)) is not None:
            if pgn == _FIX and message.fields.get("method") == _NO_GNSS:
                skipped["positions (129029) without a fix are left out"] += 1
            else:
                values = _values(message, variation, skipped)
                empty[pgn] += not any(values.values())
                _add(samples, message, values, time - begun, row)
    if begun is None:
        raise InputError(f"{path}: no frame of an NMEA 2000 network was found")
    notes = [f"{count} {what}" for what, count in skipped.items()]
    notes += counted(+empty, "messages without a value, by PGN")
    notes += counted(others, "PGNs that are not read")
    return Log(path, samples.channels(), start=date_of(begun), notes=tuple(notes), row="line")


def _values(message: Message, variation: list[float], skipped: Counter[str]) -> Values:
    """Return the values of a message as a log has them: directions from true north, winds from.

    ``variation`` has the last one on the bus, if there was one.
    """
    values = READERS[message.pgn](message.fields)
    variation[:] = values.get("variation") or variation
    for name in ORDERED:
        if ordered := values.pop(name, None):
            values[f"magnetic_{name}" if ordered[1] else name] = ordered[:1]
    for name in _BLOWS_TO:
        if blows_to := values.get(name):
            values[name] = ((blows_to[0] + math.pi) % math.tau,)
    for name in _FROM_NORTH:
        shown = values.get(f"magnetic_{name}")
        if shown is not None and (shown[1:] or variation):
            true = shown[0] + (shown[1] if shown[1:] else variation[0])
            values[name] = (true % math.tau,)
        elif shown is not None:
            skipped[f"magnetic directions ({message.pgn}) before the first variation"] += 1
    return values


def _add(samples: Samples, message: Message, values: Values, time: float, row: int) -> None:
    instance = message.fields.get("instance") if message.pgn == 127245 else 0
    suffix = f"[{instance}]" if instance else ""
    for quantity, found in values.items():
        for (name, unit), value in zip(_named(quantity), found or (), strict=False):
            where = f"{message.pgn}.{name}{suffix}"
            samples.add(where, unit, time, float(value), row, str(message.source))
