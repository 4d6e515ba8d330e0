"""A record played to a node of somebody else, and bags that hold it."""

import math
import os
import shutil
import subprocess
import sys
import time

import pytest
from rosbags.rosbag2 import Writer
from rosbags.typesys import Stores, get_typestore

from tests.command import seatrial, seatrial_process

from . import peer

READER = """
import sys, time
from tests.kits.ros2 import peer
node = peer.Node(int(sys.argv[1]))
odometry = node.reader("/vehicle/odometry/ground_truth", peer.Odometry)
print("ready", flush=True)
seen, until = [], time.monotonic() + 40.0
while time.monotonic() < until and (not seen or seen[-1].header.stamp.sec < 1):
    seen += peer.taken(odometry)
    time.sleep(0.01)
for each in seen:
    at = each.pose.pose.position
    print(each.header.stamp.sec + 1e-9 * each.header.stamp.nanosec, at.x, at.y, at.z)
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("played")
    text = """
title = "ahead"
rig = "sil"
choices = { vehicle = "otter", autopilot = "guidance" }
stop = "1.2 s"
[set]
"autopilot.course.waypoint_1" = ["50 m", "20 m", "0 m"]
[record]
signals = ["vehicle.hull.*"]
every = "100 ms"
"""
    (folder / "ahead.toml").write_text(text)
    done = seatrial("run", "ahead.toml", "--engine", "direct", "--out", "run", cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder / "run"


@pytest.mark.slow
def test_a_node_gets_the_record_in_its_own_time(run, domain, tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    environment = {**os.environ, "CYCLONEDDS_URI": peer.LOOPBACK}
    command = [sys.executable, "-c", READER, str(domain)]
    node = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    assert node.stdout.readline() == "ready\n"
    begun = time.monotonic()
    done = seatrial_process("play", str(run), "--ros2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert time.monotonic() - begun > 1.2
    rows = [[*map(float, line.split())] for line in node.communicate(timeout=60.0)[0].splitlines()]
    header, *lines = (run / "signals.csv").read_text().splitlines()
    names = header.split(",")
    columns = [names.index(f"vehicle.hull.position.{axis}") for axis in "yx"]
    recorded = {round(float(line.split(",")[0]), 6): line.split(",") for line in lines}
    assert len(rows) >= 8
    for stamp, east, north, _ in rows:
        found = [float(recorded[round(stamp, 6)][column]) for column in columns]
        assert (east, north) == pytest.approx(found, abs=1e-9)
    assert math.hypot(rows[-1][1], rows[-1][2]) > 0.0


def test_a_second_run_beside_nodes_is_refused(run):
    done = seatrial("play", str(run), str(run), "--ros2", cwd=run)
    assert done.returncode == 2
    assert "--ros2 plays one run" in done.stderr


def test_types_of_another_distribution_are_refused(run, tmp_path):
    record = shutil.copytree(run, tmp_path / "record")
    jazzy = get_typestore(Stores.ROS2_JAZZY)
    with Writer(record / "link", version=9) as bag:
        kind = "sensor_msgs/msg/Range"
        ping = jazzy.types[kind](
            header=jazzy.types["std_msgs/msg/Header"](
                stamp=jazzy.types["builtin_interfaces/msg/Time"](sec=0, nanosec=0), frame_id=""
            ),
            radiation_type=0, field_of_view=0.0, min_range=0.0, max_range=9.0, range=1.0, variance=0.0,
        )  # fmt: skip
        topic = bag.add_connection("/otter/echo_sounder", kind, typestore=jazzy)
        bag.write(topic, 0, jazzy.serialize_cdr(ping, kind))
    done = seatrial("play", str(record), "--ros2", cwd=tmp_path)
    assert done.returncode == 2
    assert "/otter/echo_sounder is sensor_msgs/msg/Range of another distribution" in done.stderr
    assert "ROS_DISTRO" in done.stderr
