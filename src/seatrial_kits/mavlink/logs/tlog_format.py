"""Telemetry logs of ground stations (.tlog) as logs."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Channel, Log, Samples, channel
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


@dataclass(frozen=True)
class _Frame:
    stamp_us: int
    number: int
    message: Any

    @property
    def sender(self) -> str:
        """System and component, ``1.1``."""
        return f"{self.message.get_srcSystem()}.{self.message.get_srcComponent()}"


def _read(path: Path, _: Column | None) -> Log:
    """Return the log of a .tlog: a channel for each number of each kind of message, ``KIND.FIELD``.

    The autopilot keeps plain names, the lowest of several; other senders have their system and
    component before them. The time of a message is that at which the vehicle sent it
    (``time_boot_ms``), shifted by the shortest delay of all to the clock of the recorder; without
    it, that at which it was received. Positions of GPS_RAW_INT without a fix are left out.

    Raises InputError for a file without a frame of MAVLink.
    """
    data = path.read_bytes()
    skipped: Counter[str] = Counter()
    frames = list(_frames(data, skipped))
    if not frames:
        raise InputError(f"{path}: no frame of MAVLink after a time stamp was found: no tlog")
    notes = [f"{count} {what}" for what, count in skipped.items()]
    begun = min(frame.stamp_us for frame in frames)
    delays, restarted = _delays(frames)
    if restarted:
        notes.append("the vehicle restarted: its times are those at which messages were received")
    samples, parameters = Samples(), {}
    without_fix = 0
    for frame in frames:
        kind, message = frame.message.get_type(), frame.message
        if kind == "PARAM_VALUE":
            parameters[message.param_id] = float(message.param_value)
            continue
        if kind == "GPS_RAW_INT" and message.fix_type < _FIX_2D:
            without_fix += 1
            continue
        time = frame.stamp_us
        if frame.sender in delays and "time_boot_ms" in message.fieldnames:
            time = message.time_boot_ms * 1000 + delays[frame.sender]
        _add(samples, frame, (time - begun) / 1e6)
    if without_fix:
        notes.append(f"{without_fix} messages GPS_RAW_INT without a fix are left out")
    channels = samples.channels(_autopilot(frames))
    channels |= _derived(channels, parameters)
    return Log(path, channels, start=date_of(begun / 1e6), notes=tuple(notes))


def _frames(data: bytes, skipped: Counter[str]) -> Iterator[_Frame]:
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
            yield _Frame(stamp, number, message)


def _length(data: bytes, place: int) -> int:
    """Return the length of the frame that begins at a place, 0 if none does."""
    magic = data[place]
    if magic not in _OVERHEAD or place + 2 >= len(data):
        return 0
    signed = magic == _V2 and data[place + 2] & 1
    return int(data[place + 1]) + _OVERHEAD[magic] + (_SIGNATURE if signed else 0)


def _delays(frames: list[_Frame]) -> tuple[dict[str, int], bool]:
    """Return what leads from each vehicle's clock to the recorder's, us; and if one restarted."""
    delays: dict[str, int] = {}
    latest: dict[str, int] = {}
    restarted: set[str] = set()
    for frame in frames:
        if "time_boot_ms" in frame.message.fieldnames:
            boot, sender = frame.message.time_boot_ms, frame.sender
            if boot < latest.get(sender, 0) - _RESTART_MS:
                restarted.add(sender)
            latest[sender] = boot
            delay = frame.stamp_us - boot * 1000
            delays[sender] = min(delay, delays.get(sender, delay))
    return {sender: each for sender, each in delays.items() if sender not in restarted}, bool(
        restarted
    )


def _autopilot(frames: list[_Frame]) -> str | None:
    senders = {
        (frame.message.get_srcSystem(), frame.message.get_srcComponent(), frame.sender)
        for frame in frames
        if frame.message.get_type() == "HEARTBEAT" and frame.message.autopilot != _NOT_AN_AUTOPILOT
    }
    return min(senders)[2] if senders else None


def _add(samples: Samples, frame: _Frame, time: float) -> None:
    kind, message = frame.message.get_type(), frame.message
    for field in message.fieldnames:
        value = getattr(message, field)
        name = f"{kind}.{field}"
        factor, unit = unit_of(message.fieldunits_by_name.get(field, ""))
        if isinstance(value, (list, tuple)):
            parts = {f"{name}[{k}]": each for k, each in enumerate(value)}
        else:
            parts = {name: value}
        for part, each in parts.items():
            if isinstance(each, (int, float)):
                known = np.nan if _UNKNOWN.get(part) == each else factor * each
                samples.add(part, unit, time, known, frame.number, frame.sender)


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


def _recognises(path: Path, head: bytes) -> bool:
    return (
        len(head) > _STAMP
        and _length(head, _STAMP) > 0
        and (0 < int.from_bytes(head[:_STAMP], "big") <= _LATEST_US)
    )


TLOG = Format("MAVLink telemetry log", _recognises, _read, defaults=_DEFAULTS)
