"""Criteria of a trial on /diagnostics while it runs, read by a node of somebody else."""

import math
import subprocess
import time
from dataclasses import dataclass

import pytest
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import sequence, uint8

from tests.command import SEATRIAL

from . import peer

PACKAGE = "diagnostic_msgs::msg::dds_"
TRIAL = """
rig = "sil"
choices = { vehicle = "otter", autopilot = "ros2" }
stop = "120 s"
[real_time]
factor = 1
[[criteria]]
name = "nothing is refused"
check = "autopilot.ros2.refused < 1"
[[criteria]]
name = "something is refused"
check = "eventually autopilot.ros2.refused > 0"
[[criteria]]
name = "it flies at once"
check = "within 100 ms vehicle.motion.position.z < -1 m"
[[criteria]]
name = "it stays low"
check = "vehicle.motion.position.z > -1 m after 1 s"
[[criteria]]
name = "few are refused"
check = "autopilot.ros2.refused < 2"
ends = true
"""


@dataclass
class KeyValue(IdlStruct, typename=f"{PACKAGE}::KeyValue_"):
    key: str
    value: str


@dataclass
class Status(IdlStruct, typename=f"{PACKAGE}::DiagnosticStatus_"):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclass
class Diagnostics(IdlStruct, typename=f"{PACKAGE}::DiagnosticArray_"):
    header: peer.Header
    status: sequence[Status]


@pytest.mark.slow
def test_criteria_are_told_as_they_are_decided(domain, monkeypatch, write, tmp_path):
    monkeypatch.setenv("CYCLONEDDS_URI", peer.LOOPBACK)
    node = peer.Node(domain)
    told = node.reader("/diagnostics", Diagnostics)
    velocity = node.writer("/otter/cmd_vel", peer.Twist)
    wrong = peer.Twist(peer.Vector3(x=math.nan), peer.Vector3())

    def awaited(said):
        until = time.monotonic() + 60.0
        while time.monotonic() < until:
            for found in peer.taken(told):
                trial = [each for each in found.status if each.name.startswith("trial: ")]
                if {each.name[7:]: (each.message, each.level) for each in trial} == said:
                    return
            time.sleep(0.01)
        raise AssertionError(f"never told: {said}")

    command = ["run", write("trial.toml", TRIAL), "--set", f"autopilot.ros2.domain={domain}"]
    with subprocess.Popen(
        [SEATRIAL, *map(str, command)], cwd=tmp_path, stdout=subprocess.PIPE, text=True
    ) as process:
        begun = {
            "nothing is refused": ("holds until now", 0),
            "something is refused": ("not met yet", 0),
            "it flies at once": ("not met in time", 2),
            "it stays low": ("evaluated at the end", 0),
            "few are refused": ("holds until now", 0),
        }
        awaited(begun)
        velocity.write(wrong)
        decided = {"nothing is refused": ("broken", 2), "something is refused": ("met", 0)}
        awaited(begun | decided)
        velocity.write(wrong)
        awaited(begun | decided | {"few are refused": ("broken", 2)})
        said, _ = process.communicate(timeout=60.0)
    assert process.returncode == 1, said
    node.participant.__del__()
