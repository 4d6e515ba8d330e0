"""Telemetry logs of ground stations (.tlog) as logs."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Array, Channel, Log, channel, distinguished
from seatrial.trial.logs.clock_times import date_of
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column

from .log_units import unit_of
from .servo_outputs import DEFAULTS, servo_orders

_STAMP = 8
_V1, _V2 = 0xFE, 0xFD
_OVERHEAD = {_V1: 8, _V2: 12}
_SIGNATURE = 13
_OLDEST_US, _LATEST_US = 0, 4_102_444_800_000_000
"""1970 to 2100."""


class Frame(NamedTuple):
    """A message, when it was recorded, its number in the file, and its sender."""

    stamp_us: int
    number: int
    message: Any
    sender: str
    """System and component, ``1.1``."""


def tlog_frames(data: bytes, skipped: Counter[str]) -> Iterator[Frame]:
    """Yield the frames with good checksums; of what is none, find the next stamp and frame."""
    from pymavlink.dialects.v20 import all as mavlink

    parser = mavlink.MAVLink(None)
    place, number, lost = 0, 0, False
    while place + _STAMP < len(data):
        length = _length(data, place + _STAMP)
        end = place + _STAMP + length
        if length and end > len(data):
            skipped["record at the end is cut"] += not lost
            return
        stamp = int.from_bytes(data[place : place + _STAMP], "big")
        message = None
        if length and _OLDEST_US <= stamp <= _LATEST_US:
            with contextlib.suppress(mavlink.MAVError, ValueError, LookupError, TypeError):
                message = parser.decode(bytearray(data[place + _STAMP : end]))
        if message is None:
            if not lost:
                skipped["places without a readable frame are skipped"] += 1
            lost, place = True, place + 1
            continue
        lost, place, number = False, end, number + 1
        if message.get_type().startswith("UNKNOWN"):
            skipped["messages of an unknown kind are skipped"] += 1
        else:
            sender = f"{message.get_srcSystem()}.{message.get_srcComponent()}"
            yield Frame(stamp, number, message, sender)


def _length(data: bytes, place: int) -> int:
    """Return the length of the frame that begins at a place, 0 if none does."""
    magic = data[place]
    if magic not in _OVERHEAD or place + 2 >= len(data):
        return 0
    signed = magic == _V2 and data[place + 2] & 1
    return int(data[place + 1]) + _OVERHEAD[magic] + (_SIGNATURE if signed else 0)


def begins_as_tlog(head: bytes) -> bool:
    """Return whether the first bytes of a file are a time stamp and the header of a frame."""
    stamp = int.from_bytes(head[:_STAMP], "big")
    return len(head) > _STAMP and _length(head, _STAMP) > 0 and 0 < stamp <= _LATEST_US


_RESTART_MS = 1000
_NOT_AN_AUTOPILOT = 8  # MAV_AUTOPILOT_INVALID
_UNKNOWN = {"GLOBAL_POSITION_INT.hdg": 65535, "GPS_RAW_INT.cog": 65535, "GPS_RAW_INT.vel": 65535}
"""Values that say that there is none (message definitions of MAVLink, common.xml)."""
_FIX_2D = 2

_DEFAULTS: Mapping[str, tuple[str, ...]] = {
    "north": ("LOCAL_POSITION_NED.x",),
    "east": ("LOCAL_POSITION_NED.y",),
    "latitude": ("GLOBAL_POSITION_INT.lat", "GPS_RAW_INT.lat"),
    "longitude": ("GLOBAL_POSITION_INT.lon", "GPS_RAW_INT.lon"),
    "heading": ("ATTITUDE.yaw", "GLOBAL_POSITION_INT.hdg", "VFR_HUD.heading"),
    "course": ("GPS_RAW_INT.cog",),
    "speed": ("VFR_HUD.groundspeed",),
    "roll": ("ATTITUDE.roll",),
    "pitch": ("ATTITUDE.pitch",),
    "yaw_rate": ("ATTITUDE.yawspeed",),
    "depth": ("LOCAL_POSITION_NED.z", "-GLOBAL_POSITION_INT.relative_alt"),
    "power": ("SYS_STATUS.power",),
    "acceleration_x": ("RAW_IMU.xacc", "SCALED_IMU2.xacc"),
    "acceleration_y": ("RAW_IMU.yacc", "SCALED_IMU2.yacc"),
    **DEFAULTS,
}


def _read(path: Path, _: Column | None) -> Log:
    """Return the log of a .tlog: a channel for each number of each kind of message, ``KIND.FIELD``.

    The autopilot keeps plain names, the lowest of several; other senders have their system and
    component before them. The time of a message is that at which the vehicle sent it
    (``time_boot_ms``), shifted by the shortest delay of all to the clock of the recorder; without
    it, that at which it was received. Positions of GPS_RAW_INT without a fix are left out.

    Raises InputError for a file without a frame of MAVLink.
    """
    skipped: Counter[str] = Counter()
    kinds: dict[tuple[str, str], list[Frame]] = {}
    for frame in tlog_frames(path.read_bytes(), skipped):
        kinds.setdefault((frame.message.get_type(), frame.sender), []).append(frame)
    if not kinds:
        raise InputError(f"{path}: no frame of MAVLink after a time stamp was found: no tlog")
    begun = min(frames[0].stamp_us for frames in kinds.values())
    delays = {sender: _delay(kinds, sender, skipped) for _, sender in kinds}
    found: dict[tuple[str, str], Channel] = {}
    parameters: dict[str, float] = {}
    for (kind, sender), frames in kinds.items():
        if kind == "PARAM_VALUE":
            parameters |= {each.message.param_id: each.message.param_value for each in frames}
        elif kind == "GPS_RAW_INT":
            fixed = [each for each in frames if each.message.fix_type >= _FIX_2D]
            skipped["messages GPS_RAW_INT without a fix are left out"] += len(frames) - len(fixed)
            found |= _channels(kind, sender, fixed, _times(fixed, delays[sender], begun))
        else:
            found |= _channels(kind, sender, frames, _times(frames, delays[sender], begun))
    channels = distinguished(found, _autopilot(kinds))
    channels |= _derived(channels, parameters)
    notes = tuple(f"{count} {what}" for what, count in skipped.items() if count)
    return Log(path, channels, start=date_of(begun / 1e6), notes=notes)


def _delay(
    kinds: Mapping[tuple[str, str], list[Frame]], sender: str, skipped: Counter[str]
) -> float | None:
    """Return what leads from a vehicle's clock to the recorder's, us; None if it restarted."""
    frames = [frame for (_, by), own in kinds.items() if by == sender for frame in own
              if "time_boot_ms" in frame.message.fieldnames]  # fmt: skip
    frames.sort(key=lambda frame: frame.number)
    boots = [frame.message.time_boot_ms for frame in frames]
    if any(later < before - _RESTART_MS for before, later in pairwise(boots)):
        skipped[f"restarts of {sender}: its times are those at which messages were received"] += 1
        return None
    stamps = (frame.stamp_us - 1000 * frame.message.time_boot_ms for frame in frames)
    return min(stamps, default=None)


def _times(frames: list[Frame], delay: float | None, begun: float) -> Array:
    """Return the times of messages of one kind, s from the beginning of the log."""
    if delay is None or not frames or "time_boot_ms" not in frames[0].message.fieldnames:
        stamps = np.array([each.stamp_us for each in frames], np.float64)
    else:
        stamps = np.array([1000 * each.message.time_boot_ms + delay for each in frames])
    return (stamps - begun) / 1e6


def _autopilot(kinds: Mapping[tuple[str, str], list[Frame]]) -> str | None:
    senders = [
        (frame.message.get_srcSystem(), frame.message.get_srcComponent(), frame.sender)
        for (kind, _), (frame, *_) in kinds.items()
        if kind == "HEARTBEAT" and frame.message.autopilot != _NOT_AN_AUTOPILOT
    ]
    return min(senders)[2] if senders else None


def _channels(
    kind: str, sender: str, frames: list[Frame], time: Array
) -> dict[tuple[str, str], Channel]:
    """Return the numbers of messages of one kind, by name and sender."""
    found: dict[tuple[str, str], Channel] = {}
    rows = [each.number for each in frames]
    for field in frames[0].message.fieldnames if frames else ():
        values = np.array([getattr(each.message, field) for each in frames])
        if values.dtype.kind not in "iuf":
            continue
        factor, unit = unit_of(frames[0].message.fieldunits_by_name.get(field, ""))
        name = f"{kind}.{field}"
        known = np.where(values == _UNKNOWN.get(name), np.nan, values * factor)
        names = [name] if known.ndim == 1 else [f"{name}[{k}]" for k in range(known.shape[1])]
        for part, column in zip(names, known.reshape(len(frames), -1).T, strict=True):
            found[part, sender] = channel(part, unit, time, column, rows)
    return found


def _derived(
    channels: Mapping[str, Channel], parameters: Mapping[str, float]
) -> dict[str, Channel]:
    """Return the orders of the servo outputs, and the power of the battery."""
    pulses = {
        output: channels[name]
        for output in range(1, 17)
        if (name := f"SERVO_OUTPUT_RAW.servo{output}_raw") in channels
    }
    found = servo_orders(pulses, parameters)
    volts = channels.get("SYS_STATUS.voltage_battery")
    amperes = channels.get("SYS_STATUS.current_battery")
    if volts is not None and amperes is not None and len(volts.values) == len(amperes.values):
        watts = volts.values * 1e-3 * np.where(amperes.values < 0.0, np.nan, amperes.values * 1e-2)
        found["SYS_STATUS.power"] = channel("SYS_STATUS.power", "W", volts.time, watts, volts.rows)
    return found


TLOG = Format(
    "MAVLink telemetry log", lambda path, head: begins_as_tlog(head), _read, defaults=_DEFAULTS
)
