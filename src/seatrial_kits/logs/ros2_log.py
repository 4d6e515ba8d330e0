"""ROS 2 bags as logs: numbers of messages, and motion in the axes of vessels."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Log, Samples
from seatrial.trial.logs.clock_times import date_of
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column
from seatrial.trial.logs.reading_progress import tell
from seatrial.trial.records.quaternions import to_euler

_NS = 10**9
_MOST_DELAY_NS = 60 * _NS
"""Between the stamp of a message and its recording; beyond, they are not of one clock."""
_MAGIC = {".mcap": b"\x89MCAP", ".db3": b"SQLite format 3"}
_METADATA = "metadata.yaml"

Values = dict[str, tuple[str | None, float]]


def _read(path: Path, _: Column | None) -> Log:
    """Return the log in a bag, or in one file of it: channels ``TOPIC.FIELD``.

    Odometry, poses, Imu and NavSatFix have channels in the axes of vessels too, made from those of
    REP 103 and 105, east-north-up and ahead-left-up: ``north``, ``east``, ``depth``, ``heading``,
    ``roll``, ``pitch``, ``speed``, ``yaw_rate``, ``acceleration_x``, ``latitude``, ... Time is the
    stamp of the header, or, without one, that of the recording; from the first message on.
    Positions without a fix are left out.

    Raises InputError for a bag that cannot be read.
    """
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    samples, served, skipped = Samples(), dict[str, list[str]](), Counter[str]()
    begun: int | None = None
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as bag:
            for row, (connection, recorded, raw) in enumerate(bag.messages(), 1):
                tell(row / bag.message_count)
                begun = recorded if begun is None else begun
                message = bag.deserialize(raw, connection.msgtype)
                time = (_stamp(message, recorded) - begun) / _NS
                if _without_fix(message):
                    skipped[f"messages {connection.topic} without a fix are left out"] += 1
                    continue
                motion = _MOTIONS.get(connection.msgtype, lambda _: {})(message)
                for what in motion:
                    name = f"{connection.topic}.{what}"
                    if name not in (names := served.setdefault(what, [])):
                        names.append(name)
                for part, (unit, value) in {**dict(_numbers("", message)), **motion}.items():
                    name = f"{connection.topic}.{part}" if part else connection.topic
                    samples.add(name, unit, time, value, row)
    except Exception as error:  # whatever rosbags makes of bytes that are no bag
        raise InputError(
            f"{path}: the bag cannot be read: {error or type(error).__name__}; of a recording that "
            "was cut, 'mcap recover' or 'ros2 bag reindex' may save the rest"
        ) from None
    start = None if begun is None else date_of(begun / _NS)
    notes = tuple(f"{count} {what}" for what, count in skipped.items())
    return Log(path, samples.channels(), served, start, notes)


def _stamp(message: Any, recorded: int) -> int:
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    if stamp is None:
        return recorded
    stamped = int(stamp.sec) * _NS + int(stamp.nanosec)
    return stamped if stamped > 0 and abs(stamped - recorded) < _MOST_DELAY_NS else recorded


def _numbers(path: str, message: Any) -> Iterator[tuple[str, tuple[None, float]]]:
    """Yield the single numbers and flags of a message by their paths; arrays are left out."""
    for field in fields(message):
        value = getattr(message, field.name)
        inner = f"{path}.{field.name}" if path else field.name
        if is_dataclass(value) and field.name not in ("header", "layout"):
            yield from _numbers(inner, value)
        elif isinstance(value, (bool, int, float)):
            yield inner, (None, float(value))


def _without_fix(message: Any) -> bool:
    return getattr(message, "__msgtype__", "") == "sensor_msgs/msg/NavSatFix" and (
        message.status.status < 0
    )


# ---------------------------------------------------------------------- axes of vessels


def _attitude(turn: Any) -> Values:
    """Return the attitude of ahead-left-up in east-north-up as roll, pitch and heading, rad."""
    if not turn.w * turn.w + turn.x * turn.x + turn.y * turn.y + turn.z * turn.z > 0.5:
        return {}
    roll, pitch, yaw = to_euler([turn.w, turn.x, turn.y, turn.z])
    heading = (math.pi / 2 - float(yaw)) % math.tau
    return {
        "roll": ("rad", float(roll)),
        "pitch": ("rad", -float(pitch)),
        "heading": ("rad", heading),
    }


def _pose(pose: Any) -> Values:
    place = pose.position
    position: Values = {"north": ("m", place.y), "east": ("m", place.x), "depth": ("m", -place.z)}
    return {**position, **_attitude(pose.orientation)}


def _odometry(message: Any) -> Values:
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    return {
        **_pose(message.pose.pose),
        "speed": ("m/s", math.hypot(linear.x, linear.y)),
        "yaw_rate": ("rad/s", -angular.z),
    }


def _imu(message: Any) -> Values:
    force = message.linear_acceleration
    known = message.orientation_covariance[0] >= 0.0
    return {
        **(_attitude(message.orientation) if known else {}),
        "yaw_rate": ("rad/s", -message.angular_velocity.z),
        "acceleration_x": ("m/s2", force.x),
        "acceleration_y": ("m/s2", -force.y),
    }


_MOTIONS: Mapping[str, Callable[[Any], Values]] = {
    "nav_msgs/msg/Odometry": _odometry,
    "geometry_msgs/msg/PoseStamped": lambda message: _pose(message.pose),
    "geometry_msgs/msg/PoseWithCovarianceStamped": lambda message: _pose(message.pose.pose),
    "sensor_msgs/msg/Imu": _imu,
    "sensor_msgs/msg/NavSatFix": lambda message: {
        "latitude": ("deg", message.latitude),
        "longitude": ("deg", message.longitude),
    },
    "sensor_msgs/msg/BatteryState": lambda message: {
        "power": ("W", -message.voltage * message.current)  # discharge is negative (REP 147)
    },
}
"""By type of message."""


def _recognises(path: Path, head: bytes) -> bool:
    if path.is_dir():
        return (path / _METADATA).is_file()
    return any(head.startswith(magic) for magic in _MAGIC.values())


ROSBAG2 = Format("ROS 2 bag", _recognises, _read)
