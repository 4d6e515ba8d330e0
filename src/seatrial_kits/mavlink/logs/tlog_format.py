"""Telemetry logs of ground stations (.tlog) as logs."""

from __future__ import annotations

import contextlib
from array import array
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Array, Channel, Log, channel, distinguished
from seatrial.trial.logs.clock_times import date_of
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column
from seatrial.trial.logs.reading_progress import tell

from .log_units import unit_of
from .servo_outputs import DEFAULTS, servo_orders

_STAMP = 8
_V1, _V2 = 0xFE, 0xFD
_OVERHEAD = {_V1: 8, _V2: 12}
_SIGNATURE = 13
_TOLD_EVERY = 1000
"""Messages between two reports of the place."""
_OLDEST_US, _LATEST_US = 0, 4_102_444_800_000_000
"""1970 to 2100."""


class Frame(NamedTuple):
    """A message, when it was recorded, its number in the file, and its sender."""

    stamp_us: int
    number: int
    message: Any
    sender: str
    """System and component, ``1.1``."""


def tlog_frames(data: bytes | mmap, skipped: Counter[str]) -> Iterator[Frame]:
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
        if number % _TOLD_EVERY == 0:
            tell(place / len(data))
        if message.get_type().startswith("UNKNOWN"):
            skipped["messages of an unknown kind are skipped"] += 1
        else:
            sender = f"{message.get_srcSystem()}.{message.get_srcComponent()}"
            yield Frame(stamp, number, message, sender)


def _length(data: bytes | mmap, place: int) -> int:
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


_BOOT_TIME = "time_boot_ms"
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


@dataclass
class _Kind:
    """The messages of one kind and sender, n of them."""

    first: Any
    """The first message, which has the names and units of the fields."""
    stamps_us: array[int] = field(default_factory=lambda: array("q"))
    numbers: array[int] = field(default_factory=lambda: array("q"))
    numeric: list[str] = field(init=False)
    """Fields that are numbers, or several."""
    names: list[str] = field(init=False)
    """Of each number, ``FIELD`` or ``FIELD[k]``."""
    flat: array[float] = field(default_factory=lambda: array("d"))
    """Numbers of the messages, one message after the other."""

    def __post_init__(self) -> None:
        values = {name: getattr(self.first, name) for name in self.first.fieldnames}
        self.numeric = [name for name, value in values.items()
                        if isinstance(value, (int, float, list))]  # fmt: skip
        self.names = [
            part
            for name in self.numeric
            for part in (
                [f"{name}[{k}]" for k in range(len(values[name]))]
                if isinstance(values[name], list)
                else [name]
            )
        ]

    def take(self, frame: Frame) -> None:
        """Add a message."""
        self.stamps_us.append(frame.stamp_us)
        self.numbers.append(frame.number)
        for name in self.numeric:
            value = getattr(frame.message, name)
            if isinstance(value, list):
                self.flat.extend(value)
            else:
                self.flat.append(value)

    @property
    def table(self) -> Array:
        """The numbers (n, names)."""
        return np.asarray(self.flat).reshape(len(self.numbers), len(self.names))

    def column(self, name: str) -> Array | None:
        """Return the numbers (n,) of a field, None if there is none of that name."""
        return self.table[:, self.names.index(name)] if name in self.names else None


_Kinds = Mapping[tuple[str, str], _Kind]
"""By kind and sender."""


def _read(path: Path, _: Column | None) -> Log:
    """Return the log of a .tlog: a channel for each number of each kind of message, ``KIND.FIELD``.

    The autopilot keeps plain names, the lowest of several; other senders have their system and
    component before them. The time of a message is that at which the vehicle sent it
    (``time_boot_ms``), shifted by the shortest delay of all to the clock of the recorder; without
    it, that at which it was received. Positions of GPS_RAW_INT without a fix are left out.

    Raises InputError for a file without a frame of MAVLink.
    """
    skipped: Counter[str] = Counter()
    kinds: dict[tuple[str, str], _Kind] = {}
    parameters: dict[str, float] = {}
    with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as data:
        for frame in tlog_frames(data, skipped):
            kind = frame.message.get_type()
            own = kinds.get((kind, frame.sender))
            if own is None:
                own = kinds[kind, frame.sender] = _Kind(frame.message)
            own.take(frame)
            if kind == "PARAM_VALUE":
                parameters[frame.message.param_id] = frame.message.param_value
    if not kinds:
        raise InputError(f"{path}: no frame of MAVLink after a time stamp was found: no tlog")
    begun = min(each.stamps_us[0] for each in kinds.values())
    delays = {sender: _delay(kinds, sender, skipped) for _, sender in kinds}
    found: dict[tuple[str, str], Channel] = {}
    for (kind, sender), each in kinds.items():
        if kind != "PARAM_VALUE":
            found |= _channels(kind, sender, each, _times(each, delays[sender], begun), skipped)
    channels = distinguished(found, _autopilot(kinds))
    channels |= _derived(channels, parameters)
    notes = tuple(f"{count} {what}" for what, count in skipped.items() if count)
    return Log(path, channels, start=date_of(begun / 1e6), notes=notes)


def _delay(kinds: _Kinds, sender: str, skipped: Counter[str]) -> float | None:
    """Return what leads from a vehicle's clock to the recorder's, us; None if it restarted."""
    parts = [
        (each.numbers, each.stamps_us, boots)
        for (_, by), each in kinds.items()
        if by == sender and (boots := each.column(_BOOT_TIME)) is not None
    ]
    if not parts:
        return None
    numbers, stamps, boots = (np.concatenate(each) for each in zip(*parts, strict=True))
    if np.any(np.diff(boots[np.argsort(numbers)]) < -_RESTART_MS):
        skipped[f"restarts of {sender}: its times are those at which messages were received"] += 1
        return None
    return float(np.min(stamps - 1000.0 * boots))


def _times(kind: _Kind, delay: float | None, begun: int) -> Array:
    """Return the times of messages of one kind, s from the beginning of the log."""
    boots = kind.column(_BOOT_TIME)
    moments = np.asarray(kind.stamps_us) if delay is None or boots is None else boots * 1e3 + delay
    return np.asarray((moments - begun) / 1e6)


def _autopilot(kinds: _Kinds) -> str | None:
    senders = [
        (each.first.get_srcSystem(), each.first.get_srcComponent(), sender)
        for (kind, sender), each in kinds.items()
        if kind == "HEARTBEAT" and each.first.autopilot != _NOT_AN_AUTOPILOT
    ]
    return min(senders)[2] if senders else None


def _channels(
    kind: str, sender: str, messages: _Kind, time: Array, skipped: Counter[str]
) -> dict[tuple[str, str], Channel]:
    """Return the numbers of messages of one kind, by name and sender."""
    table, rows = messages.table, np.asarray(messages.numbers)
    if kind == "GPS_RAW_INT":
        fixed = table[:, messages.names.index("fix_type")] >= _FIX_2D
        skipped["messages GPS_RAW_INT without a fix are left out"] += int((~fixed).sum())
        table, rows, time = table[fixed], rows[fixed], time[fixed]
    found: dict[tuple[str, str], Channel] = {}
    for place, part in enumerate(messages.names if len(rows) else ()):
        units = messages.first.fieldunits_by_name
        factor, unit = unit_of(units.get(part.partition("[")[0], ""))
        name, values = f"{kind}.{part}", table[:, place]
        known = np.where(values == _UNKNOWN.get(name), np.nan, values * factor)
        found[name, sender] = channel(name, unit, time, known, rows)
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
