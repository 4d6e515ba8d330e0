"""PX4's own logs (.ulg) as logs: pyulog reads them."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Array, Channel, Log, channel
from seatrial.trial.logs.clock_times import date_of
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column
from seatrial.trial.records.quaternions import to_euler

_MAGIC = b"ULog\x01\x12\x35"
_DEFAULTS: Mapping[str, tuple[str, ...]] = {
    "north": ("vehicle_local_position.x",),
    "east": ("vehicle_local_position.y",),
    "depth": ("vehicle_local_position.z",),
    "latitude": ("vehicle_global_position.lat", "vehicle_gps_position.latitude_deg",
                 "vehicle_gps_position.lat"),
    "longitude": ("vehicle_global_position.lon", "vehicle_gps_position.longitude_deg",
                  "vehicle_gps_position.lon"),
    "heading": ("vehicle_attitude.yaw", "vehicle_local_position.heading"),
    "roll": ("vehicle_attitude.roll",),
    "pitch": ("vehicle_attitude.pitch",),
    "yaw_rate": ("vehicle_angular_velocity.xyz[2]",),
    "speed": ("vehicle_gps_position.vel_m_s",),
    "course": ("vehicle_gps_position.cog_rad",),
    "helm": ("actuator_servos.control[0]",),
    "command": ("actuator_motors.control[0]",),
    "port": ("actuator_motors.control[1]",),
    "starboard": ("actuator_motors.control[0]",),
    "power": ("battery_status.power",),
    "acceleration_x": ("vehicle_acceleration.xyz[0]", "sensor_combined.accelerometer_m_s2[0]"),
    "acceleration_y": ("vehicle_acceleration.xyz[1]", "sensor_combined.accelerometer_m_s2[1]"),
}  # fmt: skip
"""Of actuators: rudder or right motor first, as PX4's rovers have them."""
_UNITS: Mapping[str, tuple[float, str]] = {
    "vehicle_local_position.x": (1.0, "m"),
    "vehicle_local_position.y": (1.0, "m"),
    "vehicle_local_position.z": (1.0, "m"),
    "vehicle_local_position.vx": (1.0, "m/s"),
    "vehicle_local_position.vy": (1.0, "m/s"),
    "vehicle_local_position.vz": (1.0, "m/s"),
    "vehicle_local_position.heading": (1.0, "rad"),
    "vehicle_global_position.lat": (1.0, "deg"),
    "vehicle_global_position.lon": (1.0, "deg"),
    "vehicle_gps_position.latitude_deg": (1.0, "deg"),
    "vehicle_gps_position.longitude_deg": (1.0, "deg"),
    "vehicle_gps_position.lat": (1e-7, "deg"),
    "vehicle_gps_position.lon": (1e-7, "deg"),
    "vehicle_gps_position.vel_m_s": (1.0, "m/s"),
    "vehicle_gps_position.cog_rad": (1.0, "rad"),
    **{f"vehicle_angular_velocity.xyz[{k}]": (1.0, "rad/s") for k in range(3)},
    **{f"vehicle_acceleration.xyz[{k}]": (1.0, "m/s2") for k in range(3)},
    **{f"sensor_combined.accelerometer_m_s2[{k}]": (1.0, "m/s2") for k in range(3)},
    **{f"actuator_servos.control[{k}]": (1.0, "1") for k in range(8)},
    **{f"actuator_motors.control[{k}]": (1.0, "1") for k in range(12)},
    "battery_status.voltage_v": (1.0, "V"),
    "battery_status.current_a": (1.0, "A"),
}
"""Factor and unit of fields (PX4's msg/*.msg); a ULog does not say them."""
_MOST_DELAY_US = 1_000_000
"""From a sample to its message; beyond, the field is not set."""
_TURN = ("q[0]", "q[1]", "q[2]", "q[3]")
_FIX_2D = 2
_VALID = {"vehicle_local_position": ("xy_valid", 1), "vehicle_gps_position": ("fix_type", _FIX_2D)}
"""Field, and its least value, without which a position is none."""


def _read(path: Path, _: Column | None) -> Log:
    """Return the log of a PX4: a channel for each number of each topic, ``TOPIC.FIELD``.

    Time is that of the sample, where the topic has it, else of the message; from the start of the
    log. Of topics with several instances the later ones are ``TOPIC[N].FIELD``. The attitude has
    roll, pitch and yaw beside its quaternion. Positions that are marked invalid are left out.

    Raises InputError for a file that is no ULog.
    """
    from pyulog import ULog

    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            read = ULog(str(path))
    except Exception as error:  # whatever pyulog makes of bytes that are no log
        raise InputError(f"{path}: no ULog: {error or type(error).__name__}") from None
    notes = ["parts of the file cannot be read, and are skipped"] if read.file_corruption else []
    if read.dropouts:
        lost = sum(each.duration for each in read.dropouts) / 1e3
        notes.append(f"the logger dropped messages {len(read.dropouts)} times, {lost:g} s in all")
    channels: dict[str, Channel] = {}
    for topic in read.data_list:
        channels |= _topic(topic, float(read.start_timestamp), notes)
    return Log(path, channels, start=_start(read), notes=tuple(notes))


def _topic(topic: Any, begun_us: float, notes: list[str]) -> dict[str, Channel]:
    name = topic.name if topic.multi_id == 0 else f"{topic.name}[{topic.multi_id}]"
    fields = {key: np.asarray(values) for key, values in topic.data.items()}
    stamps = fields.pop("timestamp", None)
    if stamps is None:
        notes.append(f"the topic {name} has no times, and is left out")
        return {}
    sampled = fields.pop("timestamp_sample", stamps)
    delay = stamps.astype(np.int64) - sampled.astype(np.int64)
    measured = np.where((delay >= 0) & (delay < _MOST_DELAY_US), sampled, stamps)
    time = (measured.astype(np.float64) - begun_us) / 1e6
    kept = np.ones(len(time), bool)
    field, least = _VALID.get(topic.name, ("", 0))
    if field in fields:
        kept = fields[field] >= least
    if not kept.all():
        notes.append(
            f"{np.count_nonzero(~kept)} messages {name} without a valid position are left out"
        )
    rows = np.flatnonzero(kept) + 1
    found = {}
    for key, values in fields.items():
        factor, unit = _UNITS.get(f"{topic.name}.{key}", (1.0, None))
        found[f"{name}.{key}"] = channel(
            f"{name}.{key}", unit, time[kept], values[kept] * factor, rows
        )
    for key, (unit, values) in _derived(topic.name, fields).items():
        found[f"{name}.{key}"] = channel(f"{name}.{key}", unit, time[kept], values[kept], rows)
    return found


def _derived(topic: str, fields: Mapping[str, Array]) -> dict[str, tuple[str, Array]]:
    """Return unit and values of what several fields of a topic make."""
    turn = [fields[key] for key in _TURN if key in fields]
    if topic == "vehicle_attitude" and len(turn) == len(_TURN):
        angles = to_euler(np.column_stack(turn))
        return dict(zip(("roll", "pitch", "yaw"), (("rad", each) for each in angles), strict=True))
    if topic == "battery_status" and {"voltage_v", "current_a"} <= fields.keys():
        return {"power": ("W", fields["voltage_v"] * fields["current_a"])}
    return {}


def _start(read: Any) -> datetime | None:
    """Return the date of the time 0, by the first position that has one."""
    for topic in read.data_list:
        utc = topic.data.get("time_utc_usec", ()) if "gps" in topic.name else ()
        for row in np.flatnonzero(utc)[:1]:
            unix_us = float(utc[row]) - float(topic.data["timestamp"][row]) + read.start_timestamp
            return date_of(unix_us / 1e6)
    return None


ULOG = Format("ULog of PX4", lambda path, head: head.startswith(_MAGIC), _read, defaults=_DEFAULTS)
