"""ArduPilot's own logs (.bin, and .log as text) as logs."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Channel, Log, channel
from seatrial.trial.logs.clock_times import date_of
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column
from seatrial_kits.mavlink.logs.log_units import unit_of
from seatrial_kits.mavlink.logs.servo_outputs import DEFAULTS, servo_orders

_HEADER = 3
_TIMES = {"TimeUS": 1e-6, "TimeMS": 1e-3}
"""Columns of the time since the boot, and s in its unit."""
_FIX_2D = 2

_DEFAULTS: Mapping[str, tuple[str, ...]] = {
    "north": ("XKF1.PN", "NKF1.PN"),
    "east": ("XKF1.PE", "NKF1.PE"),
    "latitude": ("POS.Lat", "GPS.Lat"),
    "longitude": ("POS.Lng", "GPS.Lng"),
    "heading": ("ATT.Yaw",),
    "course": ("GPS.GCrs",),
    "speed": ("GPS.Spd",),
    "roll": ("ATT.Roll",),
    "pitch": ("ATT.Pitch",),
    "yaw_rate": ("IMU.GyrZ",),
    "depth": ("XKF1.PD", "-POS.RelHomeAlt", "-BARO.Alt"),
    "power": ("BAT.power",),
    "acceleration_x": ("IMU.AccX",),
    "acceleration_y": ("IMU.AccY",),
    **DEFAULTS,
}
_UNITS = {
    "XKF1": {"PN": "m", "PE": "m", "PD": "m"},
    "NKF1": {"PN": "m", "PE": "m", "PD": "m"},
    "POS": {"Lat": "deg", "Lng": "deg", "RelHomeAlt": "m"},
    "GPS": {"Lat": "deg", "Lng": "deg", "GCrs": "deg", "Spd": "m/s"},
    "ATT": {"Yaw": "deg", "Roll": "deg", "Pitch": "deg"},
    "IMU": {"GyrZ": "rad/s", "AccX": "m/s2", "AccY": "m/s2"},
    "BARO": {"Alt": "m"},
}
"""Units of those, for logs of firmware before 3.6, which do not say them (LogStructure.h)."""


@dataclass(frozen=True)
class _Messages:
    """The messages of one kind: arrays (n,) by column, and units."""

    kind: str
    columns: dict[str, NDArray[Any]]
    units: dict[str, str]
    rows: NDArray[np.int64]
    """Byte of the file that each begins at, or its number."""
    instance: str | None
    """Column that distinguishes several sensors."""

    @property
    def seconds(self) -> NDArray[np.float64] | None:
        """Time since the boot, s."""
        for name, scale in _TIMES.items():
            if name in self.columns:
                return np.asarray(self.columns[name], np.float64) * scale
        return None

    def where(self, which: NDArray[np.bool_]) -> _Messages:
        """Return some of the messages."""
        columns = {name: values[which] for name, values in self.columns.items()}
        return _Messages(self.kind, columns, self.units, self.rows[which], self.instance)


def _read(path: Path, _: Column | None) -> Log:
    """Return the log of an ArduPilot: a channel for each number of each kind, ``KIND.COLUMN``.

    Time is the vehicle's, from the first message on. The first of several sensors keeps the plain
    name, others are ``KIND[N].COLUMN``. Positions of GPS without a fix are left out.

    Raises InputError for a file without messages.
    """
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            parts = list(_text_parts(path) if _is_text(path) else _binary_parts(path))
    except Exception as error:  # whatever pymavlink makes of bytes that are no log
        raise InputError(f"{path}: no log of ArduPilot: {error}") from None
    timed = [part for part in parts if part.seconds is not None and len(part.rows)]
    if not timed:
        raise InputError(f"{path}: no message with a time was found: no log of ArduPilot")
    lines = said.getvalue().splitlines()
    notes = [f"bytes that are no message are skipped: {lines[0]}"] if lines else []
    begun = min(float(part.seconds.min()) for part in timed if part.seconds is not None)
    channels: dict[str, Channel] = {}
    for part in timed:
        if part.kind == "GPS" and "Status" in part.columns:
            fix = part.columns["Status"] >= _FIX_2D
            if not fix.all():
                notes.append(f"{np.count_nonzero(~fix)} messages GPS without a fix are left out")
            part = part.where(fix)
        channels |= _channels(part, begun)
    channels |= _derived(channels, _parameters(parts))
    return Log(path, channels, start=_start(timed, begun), notes=tuple(notes))


# ---------------------------------------------------------------------- messages


def _is_text(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(1) != b"\xa3"


def _binary_parts(path: Path) -> Iterator[_Messages]:
    """Yield the messages of each kind: found by pymavlink's index, taken as one array."""
    from pymavlink.DFReader import FORMAT_TO_STRUCT, DFReader_binary

    class Index(DFReader_binary):  # type: ignore[misc]
        def init_clock(self) -> None:
            """Do nothing: to find the date it would decode all messages, one by one."""

    index = Index(str(path))
    content = np.frombuffer(index.data_map, np.uint8)
    for number, form in index.formats.items():
        kinds = [(name, _numpy_type(FORMAT_TO_STRUCT[code][0]))
                 for name, code in zip(form.columns, form.msg_fmts, strict=False)]  # fmt: skip
        kind = np.dtype(kinds)
        offsets = np.array(index.offsets[number], np.int64)
        offsets = offsets[offsets + form.len <= len(content)]
        if kind.itemsize != form.len - _HEADER or not len(offsets):
            continue
        body = content[offsets[:, None] + _HEADER + np.arange(kind.itemsize)]
        table = np.ascontiguousarray(body).view(kind)[:, 0]
        columns = {
            name: table[name] if scale is None else table[name] * scale
            for name, scale in zip(form.columns, form.msg_mults, strict=False)
        }
        units = dict(zip(form.columns, form.units or (), strict=False))
        yield _Messages(form.name, columns, units, offsets, form.instance_field)


def _numpy_type(code: str) -> str:
    return f"S{code[:-1]}" if code.endswith("s") else f"<{code}"


def _text_parts(path: Path) -> Iterator[_Messages]:
    from pymavlink.DFReader import DFReader_text

    class Lines(DFReader_text):  # type: ignore[misc]
        def init_clock(self) -> None:
            """Do nothing: as for those in binary."""

    reader = Lines(str(path))
    found: dict[str, list[tuple[int, Any]]] = {}
    number = 0
    while (message := reader.recv_msg()) is not None:
        number += 1
        found.setdefault(message.get_type(), []).append((number, message))
    for kind, entries in found.items():
        form = reader.formats[kind]
        columns = {
            name: np.array([getattr(message, name) for _, message in entries])
            for name in form.columns
        }
        units = dict(zip(form.columns, form.units or (), strict=False))
        rows = np.array([row for row, _ in entries], np.int64)
        yield _Messages(kind, columns, units, rows, form.instance_field)


# ---------------------------------------------------------------------- channels


def _channels(part: _Messages, begun: float) -> dict[str, Channel]:
    """Return the numbers of one kind of messages, each sensor's apart."""
    assert part.seconds is not None
    sensors = part.columns.get(part.instance) if part.instance else None
    found = {}
    for order, sensor in enumerate([None] if sensors is None else np.unique(sensors)):
        own = part if sensor is None else part.where(sensors == sensor)
        kind = part.kind if order == 0 else f"{part.kind}[{sensor}]"
        for name, values in own.columns.items():
            if name not in _TIMES and values.dtype.kind in "iuf" and own.seconds is not None:
                text = own.units.get(name) or _UNITS.get(part.kind, {}).get(name, "")
                factor, unit = unit_of(text)
                found[f"{kind}.{name}"] = channel(
                    f"{kind}.{name}", unit, own.seconds - begun, values * factor, own.rows
                )
    return found


def _parameters(parts: list[_Messages]) -> dict[str, float]:
    """Return the last value of each parameter."""
    found: dict[str, float] = {}
    for part in parts:
        if part.kind == "PARM" and {"Name", "Value"} <= part.columns.keys():
            names = [_text(each) for each in part.columns["Name"]]
            found |= zip(names, part.columns["Value"].astype(float).tolist(), strict=True)
    return found


def _text(name: Any) -> str:
    return name.decode("ascii", "replace") if isinstance(name, bytes) else str(name)


def _derived(
    channels: Mapping[str, Channel], parameters: Mapping[str, float]
) -> dict[str, Channel]:
    """Return the orders of the servo outputs, and the power of the battery."""
    pulses = {output: channels[name] for output in range(1, 15)
              if (name := f"RCOU.C{output}") in channels}  # fmt: skip
    found = servo_orders(pulses, parameters)
    volts, amperes = channels.get("BAT.Volt"), channels.get("BAT.Curr")
    if volts is not None and amperes is not None:
        watts = volts.values * amperes.values
        found["BAT.power"] = channel("BAT.power", "W", volts.time, watts, volts.rows)
    return found


def _start(parts: list[_Messages], begun: float) -> datetime | None:
    """Return the date of the time 0, by the first GPS message that has one."""
    from pymavlink.DFReader import DFReaderClock

    for part in parts:
        if part.kind == "GPS" and {"GWk", "GMS"} <= part.columns.keys():
            for row in np.flatnonzero(part.columns["GWk"] > 0)[:1]:
                week, ms = (float(part.columns[name][row]) for name in ("GWk", "GMS"))
                assert part.seconds is not None
                since = float(part.seconds[row]) - begun
                unix = DFReaderClock()._gpsTimeToTime(week, ms) - since
                return date_of(unix)
    return None


def _recognises(path: Path, head: bytes) -> bool:
    return head.startswith((b"\xa3\x95\x80", b"FMT, ", b"FMT,"))


DATAFLASH = Format("log of ArduPilot", _recognises, _read, defaults=_DEFAULTS)
