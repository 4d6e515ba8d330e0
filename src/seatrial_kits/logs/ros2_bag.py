"""ROS 2 bag export, MCAP inside, for ``ros2 bag``, RViz, PlotJuggler and Foxglove."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.model.component import NS
from seatrial.trial.records.run_folder import Run
from seatrial.trial.records.scene import WORLD, Craft, crafts, rows

from .record import Column, columns, nanoseconds

_PLAIN = {"Real": "float64", "Integer": "int64", "Boolean": "bool", "String": "string"}
"""Types of fields; bytes have none."""
_PACKAGE = "seatrial_msgs"
"""Of the types of components: their definitions are in the bag, and nowhere else."""


def write_ros2_bag(run: Run, path: Path) -> None:
    """Write the record of a run as a folder with a ROS 2 bag.

    Each component is a topic, ``/vehicle/hull``, whose recorded numbers, flags and texts are the
    fields of its messages, ``position_x``; their type is defined in the bag. Craft are in the
    axes of ROS (REP 103, REP 105): ``/tf`` from "map", east-north-up, to NAME, ahead-left-up;
    below ``/NAME`` the topics of the kit ros2: ``odometry/ground_truth`` nav_msgs/Odometry with
    velocity and rates in body axes; ``imu/data`` sensor_msgs/Imu, the truth without noise;
    ``gnss/fix`` sensor_msgs/NavSatFix, if the profile says a home. Times are those of the
    simulation.

    Raises InputError if ``path`` is there already, if the package rosbags is not installed,
    and for a record that begins before the time 0.
    """
    try:
        import rosbags.rosbag2  # noqa: F401
    except ImportError:
        raise InputError('ROS 2 bags need rosbags: pip install "seatrial[ros2]"') from None
    if path.exists():
        raise InputError(f"{path} is there already")
    times = nanoseconds(run)
    if times and times[0] < 0:
        raise InputError(f"{run.folder} begins at {times[0]} ns; a bag has no times before 0")
    try:
        _write(run, path, times)
    except BaseException:
        shutil.rmtree(path, ignore_errors=True)
        raise


def _write(run: Run, path: Path, times: Sequence[int]) -> None:
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    bag = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
    bag.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with bag:

        def topic(name: str, kind: str) -> Callable[[int, Any], None]:
            connection = bag.add_connection(name, kind, typestore=store)
            return lambda time, message: bag.write(
                connection, time, store.serialize_cdr(message, kind)
            )

        found = crafts(run)
        if found:
            _write_frames(topic("/tf", "tf2_msgs/msg/TFMessage"), found, times, store.types)
        for craft in found:
            for name, kind, messages in _of_craft(craft, times, store.types):
                write = topic(f"/{_token(craft.name)}/{name}", kind)
                for time, message in zip(times, messages, strict=True):
                    write(time, message)
        for name, signals in _by_component(run).items():
            _write_component(topic, name, signals, times, store)


def _by_component(run: Run) -> Mapping[str, list[Column]]:
    """Return what messages can hold, by the component's path; the longest path is the nearest."""
    paths = sorted(run.manifest["components"], key=len, reverse=True)
    found: dict[str, list[Column]] = {}
    for signal in columns(run):
        if signal.type in _PLAIN:
            first = signal.name.partition(".")[0]
            owner = next((p for p in paths if signal.name.startswith(f"{p}.")), first)
            found.setdefault(owner, []).append(signal)
    return found


def _write_component(
    topic: Any, path: str, signals: Sequence[Column], times: Sequence[int], store: Any
) -> None:
    from rosbags.typesys import get_types_from_msg

    names: dict[str, Column] = {}
    for signal in signals:
        field = _token(signal.name.removeprefix(f"{path}.")).lower().strip("_")
        field = field if field[:1].isalpha() else f"x{field}"
        while field in names:
            field += "_x"
        names[field] = signal
    parts = [_token(part) for part in path.split(".")]
    kind = f"{_PACKAGE}/msg/{''.join(part.title().replace('_', '') for part in parts)}"
    while kind in store.types:
        kind += "X"
    fields = "".join(f"{_PLAIN[signal.type]} {field}\n" for field, signal in names.items())
    store.register(get_types_from_msg(fields, kind))
    write, made = topic("/" + "/".join(parts), kind), store.types[kind]
    for time, row in zip(times, zip(*(s.values for s in signals), strict=True), strict=True):
        write(time, made(*row))


def _write_frames(write: Any, found: Sequence[Craft], times: Sequence[int], types: Any) -> None:
    geometry = "geometry_msgs/msg"
    for number, time in enumerate(times):
        transforms = [
            types[f"{geometry}/TransformStamped"](
                header=_header(types, time, WORLD),
                child_frame_id=craft.name,
                transform=types[f"{geometry}/Transform"](
                    translation=types[f"{geometry}/Vector3"](*craft.position[number].tolist()),
                    rotation=types[f"{geometry}/Quaternion"](*craft.orientation[number].tolist()),
                ),
            )
            for craft in found
        ]
        write(time, types["tf2_msgs/msg/TFMessage"](transforms=transforms))


def _of_craft(
    craft: Craft, times: Sequence[int], types: Any
) -> Iterator[tuple[str, str, Iterator[Any]]]:
    if craft.velocity is not None and craft.rates is not None:
        yield "odometry/ground_truth", "nav_msgs/msg/Odometry", _odometry(craft, times, types)
    if craft.specific_force is not None and craft.rates is not None:
        yield "imu/data", "sensor_msgs/msg/Imu", _imu(craft, times, types)
    if craft.geodetic is not None:
        yield "gnss/fix", "sensor_msgs/msg/NavSatFix", _fixes(craft, times, types)


def _odometry(craft: Craft, times: Sequence[int], types: Any) -> Iterator[Any]:
    geometry, none = "geometry_msgs/msg", np.zeros(36)
    vector, columns_of = types[f"{geometry}/Vector3"], (craft.velocity, craft.rates)
    moving = zip(*map(rows, (craft.position, craft.orientation, *columns_of)), strict=True)
    for time, (position, turn, velocity, rates) in zip(times, moving, strict=True):
        pose = types[f"{geometry}/Pose"](
            position=types[f"{geometry}/Point"](*position),
            orientation=types[f"{geometry}/Quaternion"](*turn),
        )
        twist = types[f"{geometry}/Twist"](linear=vector(*velocity), angular=vector(*rates))
        yield types["nav_msgs/msg/Odometry"](
            header=_header(types, time, WORLD),
            child_frame_id=craft.name,
            pose=types[f"{geometry}/PoseWithCovariance"](pose=pose, covariance=none),
            twist=types[f"{geometry}/TwistWithCovariance"](twist=twist, covariance=none),
        )


def _imu(craft: Craft, times: Sequence[int], types: Any) -> Iterator[Any]:
    geometry, exact = "geometry_msgs/msg", np.zeros(9)
    vector = types[f"{geometry}/Vector3"]
    read = zip(*map(rows, (craft.orientation, craft.rates, craft.specific_force)), strict=True)
    for time, (turn, rates, force) in zip(times, read, strict=True):
        yield types["sensor_msgs/msg/Imu"](
            header=_header(types, time, craft.name),
            orientation=types[f"{geometry}/Quaternion"](*turn),
            orientation_covariance=exact,
            angular_velocity=vector(*rates),
            angular_velocity_covariance=exact,
            linear_acceleration=vector(*force),
            linear_acceleration_covariance=exact,
        )


def _fixes(craft: Craft, times: Sequence[int], types: Any) -> Iterator[Any]:
    status = types["sensor_msgs/msg/NavSatStatus"](status=0, service=1)
    for time, (latitude, longitude, altitude) in zip(times, rows(craft.geodetic), strict=True):
        yield types["sensor_msgs/msg/NavSatFix"](
            header=_header(types, time, craft.name),
            status=status,
            latitude=latitude,
            longitude=longitude,
            altitude=altitude,
            position_covariance=np.zeros(9),
            position_covariance_type=0,
        )


def _header(types: Any, time: int, frame: str) -> Any:
    seconds, nanoseconds_left = divmod(time, NS)
    stamp = types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=nanoseconds_left)
    return types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame)


def _token(text: str) -> str:
    """Return a name as a token of a ROS topic: letters, digits, single underscores."""
    token = re.sub(r"_+", "_", re.sub(r"\W", "_", text, flags=re.ASCII)).strip("_") or "x"
    return f"_{token}" if token[0].isdigit() else token
