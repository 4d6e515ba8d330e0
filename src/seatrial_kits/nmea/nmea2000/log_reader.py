"""Logs of an NMEA 2000 network: recordings of its bus, and the text of gateways."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Log, Samples, not_read
from seatrial.trial.logs.clock_times import date_of
from seatrial_kits.can.recorded import recorded_frames

from .codec import Decoder, Message, header, is_fast
from .quantities import READERS

_FIX = 129029
_NO_GNSS = 0
_CHANNELS: dict[str, tuple[tuple[str, str], ...]] = {
    "heading": (("heading", "rad"),),
    "magnetic_heading": (("magnetic_heading", "rad"),),
    "variation": (("variation", "rad"),),
    "rate_of_turn": (("rate_of_turn", "rad/s"),),
    "roll": (("roll", "rad"),),
    "pitch": (("pitch", "rad"),),
    "yaw": (("yaw", "rad"),),
    "rudder": (("rudder", "rad"),),
    "rudder_order": (("rudder_order", "rad"),),
    "place": (("latitude", "deg"), ("longitude", "deg")),
    "altitude": (("altitude", "m"),),
    "course": (("course", "rad"),),
    "speed_over_ground": (("speed", "m/s"),),
    "water_speed": (("water_speed", "m/s"),),
    "depth": (("depth", "m"),),
    "wind_speed": (("wind_speed", "m/s"),),
    "wind_angle": (("wind_angle", "rad"),),
    "ground_wind_speed": (("ground_wind_speed", "m/s"),),
    "wind_direction": (("wind_direction", "rad"),),
    "water_temperature": (("water_temperature", "K"),),
    "air_temperature": (("air_temperature", "K"),),
    "air_pressure": (("air_pressure", "Pa"),),
    "cross_track": (("cross_track", "m"),),
}
"""Channels of the quantities of `READERS`, with units."""
_REFERRED = ("magnetic_heading", "magnetic_course", "magnetic_wind_direction")
"""Quantities that a variation turns into true ones."""


def read(path: Path) -> Log:
    """Return the log of a network: channels ``PGN.NAME`` of the quantities that nodes read here.

    Times are those of the recorder. The first source of a channel keeps its plain name; others have
    their address before it. Headings are true: a magnetic one has its variation added, or is left
    out. Positions without a fix are left out.

    Raises InputError for a file without a frame.
    """
    skipped: Counter[str] = Counter()
    decoder, samples = Decoder({}), Samples()
    others: Counter[int] = Counter()
    begun = None
    variation: list[float] = []
    for row, time, _, frame in recorded_frames(path, skipped, is_fast):
        if not frame.extended or frame.remote or frame.fd:
            continue
        if time is None:
            raise InputError(f"{path}, line {row}: no time stands before the frame: no log")
        begun = time if begun is None else begun
        pgn = header(frame)[0]
        if pgn not in READERS:
            others[pgn] += 1
        elif (message := decoder.decode(frame)) is not None:
            if pgn == _FIX and message.fields.get("method") == _NO_GNSS:
                skipped["positions (129029) without a fix are left out"] += 1
            else:
                _add(samples, message, time - begun, row, variation, skipped)
    if begun is None:
        raise InputError(f"{path}: no frame of an NMEA 2000 network was found")
    notes = [f"{count} {what}" for what, count in skipped.items()]
    notes += not_read(others, "PGNs")
    return Log(path, samples.channels(), start=date_of(begun), notes=tuple(notes), row="line")


def _add(
    samples: Samples,
    message: Message,
    time: float,
    row: int,
    variation: list[float],
    skipped: Counter[str],
) -> None:
    """Add the values of a message; ``variation`` has the last one on the bus, if there was one."""
    values = READERS[message.pgn](message.fields)
    variation[:] = values.get("variation") or variation
    for name in _REFERRED:
        shown = values.get(name)
        if shown is not None and (shown[1:] or variation):
            true = shown[0] + (shown[1] if shown[1:] else variation[0])
            values[name.removeprefix("magnetic_")] = (true % math.tau,)
        elif shown is not None:
            skipped[f"magnetic directions ({message.pgn}) before the first variation"] += 1
    instance = message.fields.get("instance") if message.pgn == 127245 else 0
    suffix = f"[{instance}]" if instance else ""
    for quantity, found in values.items():
        engine = ((quantity, "rad/s"),) if quantity.startswith("engine_speed ") else ()
        named = zip(_CHANNELS.get(quantity, engine), found or (), strict=False)
        for (name, unit), value in named:
            where = f"{message.pgn}.{name}{suffix}"
            samples.add(where, unit, time, float(value), row, str(message.source))
