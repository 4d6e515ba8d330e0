"""Parquet files and ROS 2 bags as logs: by pandas and rosbags, and our own exports."""

import math

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from pyarrow import parquet
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from seatrial.errors import InputError
from seatrial.trial.logs.formats import format_of, read_log
from seatrial.trial.logs.quantities import Column, chosen, defaults
from seatrial_kits.logs.parquet_file import write_parquet
from seatrial_kits.logs.ros2_bag import write_ros2_bag

STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPES = STORE.types


# ---------------------------------------------------------------------- Parquet


def test_units_in_the_metadata_and_times_in_milliseconds(tmp_path):
    fields = [pa.field("t", pa.int64(), metadata={"unit": "ms"}), pa.field("HDG", pa.float32(), metadata={"unit": "deg"}),
              pa.field("note", pa.string())]  # fmt: skip
    columns = [
        pa.array([0, 250, 500]),
        pa.array([1.5, 2.5, None], pa.float32()),
        pa.array(["a", "b", "c"]),
    ]
    parquet.write_table(
        pa.Table.from_arrays(columns, schema=pa.schema(fields)), tmp_path / "boat.parquet"
    )
    found = read_log(tmp_path / "boat.parquet", time=Column("t"))
    heading = found.channels["HDG"]
    assert (heading.unit, heading.time.tolist()) == ("deg", [0.0, 0.25, 0.5])
    assert "note" not in found.channels
    assert found.notes == ("cells without a number, by column: HDG (1)",)
    served = chosen(found, {"heading": Column("HDG")}, ["heading"])["heading"]
    assert served.time.tolist() == [0.0, 0.25]


def test_a_column_of_the_time_is_needed(tmp_path):
    pd.DataFrame({"tme": [0.0]}).to_parquet(tmp_path / "boat.parquet")
    with pytest.raises(InputError, match="time: unknown column 'time'; did you mean 'tme'"):
        read_log(tmp_path / "boat.parquet")


def test_our_own_records_are_read(make_run, tmp_path):
    run = make_run()
    write_parquet(run, tmp_path / "boat.parquet")
    write_ros2_bag(run, tmp_path / "bag")
    for path, name in (
        (tmp_path / "boat.parquet", "red.position.x"),
        (tmp_path / "bag", "/red.position_x"),
    ):
        channel = read_log(path).channels[name]
        np.testing.assert_allclose(channel.values, run.signals["red.position.x"])
        np.testing.assert_allclose(channel.time, run.time, atol=1e-9)


# ---------------------------------------------------------------------- ROS 2


def header(seconds):
    whole, ns = divmod(round(1e9 * seconds), 10**9)
    return TYPES["std_msgs/msg/Header"](TYPES["builtin_interfaces/msg/Time"](whole, ns), "map")


def turn(roll, pitch, yaw):
    """Return the quaternion of angles about x, y and z, in that order about fixed axes."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_euler("xyz", (roll, pitch, yaw)).as_quat()
    return TYPES["geometry_msgs/msg/Quaternion"](x, y, z, w)


def odometry(seconds, yaw):
    geometry = "geometry_msgs/msg"
    vector = TYPES[f"{geometry}/Vector3"]
    pose = TYPES[f"{geometry}/Pose"](
        TYPES[f"{geometry}/Point"](3.0, 4.0, -5.0), turn(0.1, 0.2, yaw)
    )
    twist = TYPES[f"{geometry}/Twist"](vector(3.0, 4.0, 0.0), vector(0.0, 0.0, 0.5))
    return TYPES["nav_msgs/msg/Odometry"](
        header(seconds), "base_link",
        TYPES[f"{geometry}/PoseWithCovariance"](pose, np.zeros(36)),
        TYPES[f"{geometry}/TwistWithCovariance"](twist, np.zeros(36)),
    )  # fmt: skip


def fix(seconds, status):
    state = TYPES["sensor_msgs/msg/NavSatStatus"](status, 1)
    return TYPES["sensor_msgs/msg/NavSatFix"](
        header(seconds), state, 63.4, 10.4, 0.0, np.zeros(9), 0
    )


def write(path, entries, plugin=StoragePlugin.MCAP):
    with Writer(path, version=9, storage_plugin=plugin) as bag:
        topics = {topic: kind for topic, kind, _, _ in entries}
        open_topics = {
            t: bag.add_connection(t, kind, typestore=STORE) for t, kind in topics.items()
        }
        for topic, kind, at, message in entries:
            bag.write(open_topics[topic], round(1e9 * at), STORE.serialize_cdr(message, kind))


@pytest.mark.parametrize("plugin", StoragePlugin)
def test_the_axes_of_ros_become_those_of_vessels(tmp_path, plugin):
    """East-north-up to north-east-down, ahead-left-up to ahead-starboard-down (REP 103)."""
    kind = "nav_msgs/msg/Odometry"
    # Recorded 0.2 s after it was measured, and then 0.4 s.
    write(
        tmp_path / "bag",
        [
            ("/odom", kind, 100.2, odometry(100.0, 0.0)),
            ("/odom", kind, 101.4, odometry(101.0, math.pi / 4)),
        ],
        plugin,
    )
    found = read_log(tmp_path / "bag")
    assert format_of(tmp_path / "bag") == "rosbag2"
    values = {name: each.values.tolist()
              for name, each in chosen(found, {}, defaults(found)).items()}  # fmt: skip
    assert (values["north"][0], values["east"][0], values["depth"][0]) == (4.0, 3.0, 5.0)
    np.testing.assert_allclose(values["heading"], [math.pi / 2, math.pi / 4])
    np.testing.assert_allclose(values["roll"], [0.1, 0.1])
    np.testing.assert_allclose(values["pitch"], [-0.2, -0.2])
    assert (values["speed"][0], values["yaw_rate"][0]) == (5.0, -0.5)
    np.testing.assert_allclose(np.diff(found.channels["/odom.north"].time), [1.0])


def test_positions_without_a_fix_are_left_out(tmp_path):
    kind = "sensor_msgs/msg/NavSatFix"
    write(tmp_path / "bag", [("/fix", kind, 1.0, fix(0.0, -1)), ("/fix", kind, 2.0, fix(0.0, 0))])
    found = read_log(next((tmp_path / "bag").glob("*.mcap")))
    assert found.channels["/fix.latitude"].values.tolist() == [63.4]
    assert found.channels["/fix.latitude"].time.tolist() == [1.0]
    assert found.notes == ("1 messages /fix without a fix are left out",)


def test_a_bag_that_is_cut(tmp_path):
    write(tmp_path / "bag", [("/fix", "sensor_msgs/msg/NavSatFix", 1.0, fix(0.0, 0))])
    path = next((tmp_path / "bag").glob("*.mcap"))
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(InputError, match=r"the bag cannot be read: .* 'mcap recover'"):
        read_log(path)
