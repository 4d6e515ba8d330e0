"""Logs of an NMEA 2000 network, by which they are recognised; nothing of the codec is imported."""

from __future__ import annotations

from pathlib import Path

from seatrial.trial.logs.channels import Log
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column
from seatrial_kits.can.recorded import is_recording

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
    from .log_reader import read

    return read(path)


NMEA2000 = Format("log of an NMEA 2000 network", is_recording, _read, defaults=_DEFAULTS)
