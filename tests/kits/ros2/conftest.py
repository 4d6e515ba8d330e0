import os
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

from seatrial_kits.ros2 import joining as ros2_joining

from .peer import LOOPBACK

_DOMAINS = iter(range(100))
os.environ.pop("ROS_DISTRO", None)  # the types of the peer are those of Humble
if os.environ.get("SEATRIAL_TEST_TRANSPORT") == "rclpy":  # test_rclpy.py
    os.environ["RMW_IMPLEMENTATION"] = "rmw_cyclonedds_cpp"
    ros2_joining._prefers_rclpy = lambda: True


@pytest.fixture(scope="module")
def domain(worker_id, testrun_uid):
    """A domain of this module alone: other tests, and other runs of tests, go on meanwhile."""
    worker = int(worker_id.removeprefix("gw")) if worker_id.startswith("gw") else 0
    return 1 + (zlib.crc32(testrun_uid.encode()) + worker * 12 + next(_DOMAINS)) % 100


@pytest.fixture
def peer(domain):
    """A function that starts a helmsman in a process of its own; it ends with the test."""
    started = []

    def start(what):
        command = [sys.executable, str(Path(__file__).with_name("peer.py")), str(domain), what]
        environment = {**os.environ, "CYCLONEDDS_URI": LOOPBACK}
        started.append(subprocess.Popen(command, stdin=subprocess.PIPE, env=environment))
        return started[-1]

    yield start
    for process in started:
        process.stdin.close()
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
