"""Hashes of types against those that a real ROS 2 Jazzy made, and where endpoints announce them."""

import json
import os
import subprocess
import sys
from pathlib import Path

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import Policy

from seatrial_kits.ros2.joining import join

REFERENCE = Path(__file__).parents[2] / "reference/ros2_jazzy_type_hashes.json"
HASHED = """
import json, sys
from seatrial_kits.ros2.messages.hashes import type_hash
print(json.dumps({kind: type_hash(kind) for kind in json.load(sys.stdin)}))
"""
ANNOUNCED = """
import sys, time
from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import Policy
from seatrial_kits.ros2.joining import join

joined = join(int(sys.argv[1]), "/seatrial", "dds")
clock = joined.writer("/clock", "rosgraph_msgs/msg/Clock")
step = joined.service("/step", "simulation_interfaces/srv/StepSimulation", print)
reader = BuiltinDataReader(joined.dds, BuiltinTopicDcpsPublication)
left = {"rt/clock", "rr/stepReply"}
until = time.monotonic() + 20.0
while left and time.monotonic() < until:
    for each in reader.take(100):
        if each.topic_name in left:
            left.remove(each.topic_name)
            print(each.topic_name, each.qos[Policy.Userdata].data.decode())
"""


def jazzy(program, *arguments, given=""):
    done = subprocess.run(
        [sys.executable, "-c", program, *arguments], input=given, text=True,
        env={**os.environ, "ROS_DISTRO": "jazzy"}, capture_output=True, check=True,
    )  # fmt: skip
    return done.stdout


def test_hashes_of_messages_services_and_actions_are_those_of_ros():
    hashes = json.loads(REFERENCE.read_text())["hashes"]
    assert len(hashes) == 54
    assert json.loads(jazzy(HASHED, given=json.dumps(sorted(hashes)))) == hashes


def test_endpoints_announce_them_to_distributions_that_have_them(domain):
    hashes = json.loads(REFERENCE.read_text())["hashes"]
    clock, step = "rosgraph_msgs/msg/Clock", "simulation_interfaces/srv/StepSimulation"
    told = dict(line.split(" ") for line in jazzy(ANNOUNCED, str(domain)).splitlines())
    assert told == {
        "rt/clock": f"typehash={hashes[clock]};",
        "rr/stepReply": f"typehash={hashes[step]};",
    }


def test_humble_has_none(domain):
    joined = join(domain, "/test", "dds")
    try:
        clock = joined.writer("/clock", "rosgraph_msgs/msg/Clock")
        reader = BuiltinDataReader(joined.dds, BuiltinTopicDcpsPublication)
        told = [each.qos[Policy.Userdata] for each in reader.take(100)]
    finally:
        joined.close()
    assert clock
    assert len(told) > 1
    assert not any(each and each.data for each in told)
