"""Craft of records in other tools' axes, against the closed form of a climbing turn."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from mcap_ros2.reader import read_ros2_messages
from scipy.spatial.transform import Rotation

from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import Run, load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.logs.mcap_file import write_mcap
from seatrial_kits.logs.ros2_bag import write_ros2_bag

RADIUS, RATE, CLIMB, ROLL = 20.0, 0.5, 0.3, 0.2
CIRCLE = f'''
"""A craft that climbs in a turn to starboard, heeled."""
import math

from seatrial.model.component import Output
from seatrial.model.sampled import Sampled
from seatrial.model.terminals import MOTION


class Circle(Sampled):
    """On a circle about the origin of {{n}}, clockwise from above; its bow is level."""

    terminals = {{"motion": MOTION}}
    position = Output("m", "position", axes="xyz", frame="n")
    velocity = Output("m/s", "velocity", axes="uvw", frame="b")
    attitude = Output("rad", "attitude", axes=("phi", "theta", "psi"))
    rates = Output("rad/s", "rates", axes="pqr", frame="b")
    acceleration = Output("m/s2", "acceleration", axes="xyz", frame="b")

    def sample(self, t, k):
        angle = {RATE} * t
        c, s = math.cos({ROLL}), math.sin({ROLL})
        ahead, inward = {RADIUS} * {RATE}, {RADIUS} * {RATE}**2
        self.position = ({RADIUS} * math.cos(angle), {RADIUS} * math.sin(angle), -{CLIMB} * t)
        self.attitude = ({ROLL}, 0.0, angle + math.pi / 2)
        self.velocity = (ahead, -{CLIMB} * s, -{CLIMB} * c)
        self.rates = (0.0, {RATE} * s, {RATE} * c)
        self.acceleration = (0.0, inward * c, -inward * s)
'''
PROFILE = """
title = "Circle"

[home]
latitude  = "-31.78 deg"
longitude = "-52.26 deg"
altitude  = "2 m"
date      = 2026-03-20
source    = "made up"
"""


@pytest.fixture
def run(write: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    write("circle.py", CIRCLE)
    write("hil_profiles/circle.toml", PROFILE)
    write(
        "rig.toml",
        'step = "50 ms"\nprofile = "circle"\n[components]\nboat = { fmu = "circle.py:Circle" }\n'
        'course = { fmu = "course", set = { count = 1.0, "waypoint_1.north" = "5 m", '
        '"waypoint_1.east" = "7 m" } }\n',
    )
    write("trial.toml", 'rig = "rig.toml"\nstop = "20 s"\n')
    result = run_trial(load_trial("trial.toml"), tmp_path / "run", engine="direct")
    return load_run(result.folder)


def at(time_ns: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return position, direction of the bow and of port, in east-north-up."""
    t = time_ns / 1e9
    angle = RATE * t
    position = [RADIUS * math.sin(angle), RADIUS * math.cos(angle), CLIMB * t]
    bow = [math.cos(angle), -math.sin(angle), 0.0]
    outward = np.array([math.sin(angle), math.cos(angle), 0.0])
    # Heeled to starboard, which is inward: port is outward and up.
    port = outward * math.cos(ROLL) + np.array([0.0, 0.0, math.sin(ROLL)])
    return np.array(position), np.array(bow), port


def assert_pose(time: int, position: Any, turn: Any, previous: list[np.ndarray]) -> None:
    place, bow, port = at(time)
    quaternion = np.array([turn.x, turn.y, turn.z, turn.w])
    matrix = Rotation.from_quat(quaternion).as_matrix()
    assert [position.x, position.y, position.z] == pytest.approx(place, abs=1e-9)
    assert matrix[:, 0] == pytest.approx(bow, abs=1e-9)
    assert matrix[:, 1] == pytest.approx(port, abs=1e-9)
    if previous:
        assert quaternion @ previous[-1] > 0.99  # it turns on, and never jumps to its negative
    previous.append(quaternion)


def test_foxglove_sees_the_craft_where_it_is(run: Run, tmp_path: Path) -> None:
    write_mcap(run, tmp_path / "a.mcap")
    write_mcap(run, tmp_path / "b.mcap")
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()
    found: dict[str, list[Any]] = {}
    with (tmp_path / "a.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        topics = ["/tf", "/boat/pose", "/boat/location", "/scene"]
        for schema, channel, message, decoded in reader.iter_decoded_messages(topics=topics):
            found.setdefault(channel.topic, []).append((schema.name, message.log_time, decoded))
    assert {topic: rows[0][0] for topic, rows in found.items()} == {
        "/tf": "foxglove.FrameTransform",
        "/boat/pose": "foxglove.PoseInFrame",
        "/boat/location": "foxglove.LocationFix",
        "/scene": "foxglove.SceneUpdate",
    }
    seen: list[np.ndarray] = []
    for _, time, tf in found["/tf"]:
        assert (tf.parent_frame_id, tf.child_frame_id) == ("map", "boat")
        assert time == tf.timestamp.seconds * 10**9 + tf.timestamp.nanos
        assert_pose(time, tf.translation, tf.rotation, seen)
    assert len(seen) == 401
    for (_, time, pose), turn in zip(found["/boat/pose"], seen, strict=True):
        assert pose.frame_id == "map"
        assert_pose(time, pose.pose.position, pose.pose.orientation, [turn])
    for _, time, fix in found["/boat/location"]:
        place = at(time)[0]
        metres = 111_000.0  # of a degree of latitude, within half a per cent
        assert fix.latitude == pytest.approx(-31.78 + place[1] / metres, abs=0.1 / metres)
        east = metres * math.cos(math.radians(31.78))
        assert fix.longitude == pytest.approx(-52.26 + place[0] / east, abs=0.2 / metres)
        assert fix.altitude == pytest.approx(2.0 + place[2])
    ((_, _, scene),) = found["/scene"]
    body, track, course = scene.entities
    assert (body.frame_id, body.frame_locked, len(body.cubes)) == ("boat", True, 1)
    points = [(p.x, p.y, p.z) for p in track.lines[0].points]
    assert (track.frame_id, len(points)) == ("map", 401)
    assert points[-1] == pytest.approx(at(20 * 10**9)[0], abs=1e-9)
    (mark,) = course.spheres
    assert (mark.pose.position.x, mark.pose.position.y) == (7.0, 5.0)


@pytest.mark.slow
def test_a_ros_2_bag_reads_back(run: Run, tmp_path: Path) -> None:
    write_ros2_bag(run, tmp_path / "bag")
    (file,) = (tmp_path / "bag").glob("*.mcap")
    found: dict[str, list[Any]] = {}
    for message in read_ros2_messages(str(file)):
        found.setdefault(message.channel.topic, []).append(message)
    assert {len(messages) for messages in found.values()} == {401}
    seen: list[np.ndarray] = []
    for message in found["/tf"]:
        (transform,) = message.ros_msg.transforms
        stamp = transform.header.stamp
        assert stamp.sec * 10**9 + stamp.nanosec == message.log_time_ns
        assert (transform.header.frame_id, transform.child_frame_id) == ("map", "boat")
        assert_pose(
            message.log_time_ns, transform.transform.translation, transform.transform.rotation, seen
        )
    c, s = math.cos(ROLL), math.sin(ROLL)
    for message, turn in zip(found["/boat/odometry/ground_truth"], seen, strict=True):
        pose, twist = message.ros_msg.pose.pose, message.ros_msg.twist.twist
        assert_pose(message.log_time_ns, pose.position, pose.orientation, [turn])
        linear = [twist.linear.x, twist.linear.y, twist.linear.z]
        angular = [twist.angular.x, twist.angular.y, twist.angular.z]
        assert linear == pytest.approx([RADIUS * RATE, CLIMB * s, CLIMB * c])
        assert angular == pytest.approx([0.0, -RATE * s, -RATE * c])
    inward = RADIUS * RATE**2
    for message in found["/boat/imu/data"]:
        read = message.ros_msg.linear_acceleration
        expected = [0.0, -inward * c + 9.80665 * s, inward * s + 9.80665 * c]
        assert [read.x, read.y, read.z] == pytest.approx(expected)
    fix = found["/boat/gnss/fix"][0].ros_msg
    assert (fix.header.frame_id, fix.altitude) == ("boat", pytest.approx(2.0))
    down = [message.ros_msg.position_z for message in found["/boat"]]
    assert down == run.signals["boat.position.z"].tolist()


def test_bags_are_not_written_over_and_need_rosbags(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "bag").mkdir()
    with pytest.raises(InputError, match="bag is there already"):
        write_ros2_bag(run, tmp_path / "bag")
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(InputError, match="need rosbags: pip install"):
        write_ros2_bag(run, tmp_path / "other")
    assert not (tmp_path / "other").exists()
