"""Node names, read by a program with rmw_dds_common's types typed by hand."""

import os
import struct
import subprocess
import sys
import time
from dataclasses import dataclass

import pytest
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, bounded_str, sequence, uint8

from seatrial import Simulation
from seatrial.errors import InputError
from seatrial_kits.ros2.messages.definitions import type_store

from . import peer
from .peer import LATCHED, Node

PACKAGE = "rmw_dds_common::msg::dds_"


@dataclass
class Gid(IdlStruct, typename=f"{PACKAGE}::Gid_"):
    data: array[uint8, 24]  # char of ROS is one


@dataclass
class NodeEntities(IdlStruct, typename=f"{PACKAGE}::NodeEntitiesInfo_"):
    node_namespace: bounded_str[256]
    node_name: bounded_str[256]
    reader_gid_seq: sequence[Gid]
    writer_gid_seq: sequence[Gid]


@dataclass
class Entities(IdlStruct, typename=f"{PACKAGE}::ParticipantEntitiesInfo_"):
    gid: Gid
    node_entities_info_seq: sequence[NodeEntities]


@pytest.mark.slow
def test_the_link_is_a_node_with_its_topics_and_services(domain, monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", peer.LOOPBACK)
    node = Node(domain)
    announced = node.reader("ros_discovery_info", Entities, LATCHED, prefix="")
    odometry = node.reader("/otter/odometry/ground_truth", peer.Odometry)
    with Simulation(
        "sil",
        choices={"vehicle": "otter", "autopilot": "ros2"},
        set={"autopilot.ros2.domain": domain},
    ) as simulation:
        until, found = time.monotonic() + 20.0, []
        while not (found and odometry.get_matched_publications()):
            assert time.monotonic() < until
            simulation.step(1)
            found += announced.take(10)
            time.sleep(0.01)
        (told,) = found[-1].node_entities_info_seq
        assert (told.node_namespace, told.node_name) == ("/", "seatrial")
        identities = [_bytes(each) for each in told.writer_gid_seq]
        written = odometry.get_matched_publications()[0]
        data = odometry.get_matched_publication_data(written)
        assert data.key.bytes in identities
        assert _bytes(found[-1].gid) == data.participant_key.bytes
        assert len({_bytes(each) for each in told.reader_gid_seq}) == len(told.reader_gid_seq) > 10


ANNOUNCED = """
import sys
from seatrial_kits.ros2.messages.packing import packed
from seatrial_kits.ros2.joining import join

participant = join(int(sys.argv[1]), "/seatrial", "dds")
participant.writer("/echo", "sensor_msgs/msg/Range")
participant.announce()
print(packed("sensor_msgs/msg/Range", {"range": 2.0}).hex(), participant.identity.hex(), flush=True)
sys.stdin.read()
"""


@dataclass
class ShortGid(IdlStruct, typename=f"{PACKAGE}::Gid_"):
    data: array[uint8, 16]


@dataclass
class ShortNodeEntities(IdlStruct, typename=f"{PACKAGE}::NodeEntitiesInfo_"):
    node_namespace: bounded_str[256]
    node_name: bounded_str[256]
    reader_gid_seq: sequence[ShortGid]
    writer_gid_seq: sequence[ShortGid]


@dataclass
class ShortEntities(IdlStruct, typename=f"{PACKAGE}::ParticipantEntitiesInfo_"):
    gid: ShortGid
    node_entities_info_seq: sequence[ShortNodeEntities]


@pytest.mark.slow
def test_a_distribution_from_iron_on_has_short_identifiers_and_its_own_range(domain, monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", peer.LOOPBACK)
    announced = Node(domain).reader("ros_discovery_info", ShortEntities, LATCHED, prefix="")
    command = [sys.executable, "-c", ANNOUNCED, str(domain)]
    environment = {**os.environ, "ROS_DISTRO": "jazzy"}
    with subprocess.Popen(
        command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        message, identity = process.stdout.readline().split()
        until, found = time.monotonic() + 20.0, []
        while not found:
            assert time.monotonic() < until
            found = [each for each in announced.take(10) if each.sample_info.valid_data]
            time.sleep(0.01)
        process.stdin.close()
    assert bytes(found[-1].gid.data).hex() == identity
    (told,) = found[-1].node_entities_info_seq
    assert (told.node_name, len(told.writer_gid_seq)) == ("seatrial", 2)
    # Jazzy's Range ends with range and variance, Humble's with range.
    assert struct.unpack("<ff", bytes.fromhex(message)[-8:]) == (2.0, 0.0)


def test_an_unknown_distribution_is_named(monkeypatch):
    monkeypatch.setenv("ROS_DISTRO", "jazzi")
    with pytest.raises(InputError, match=r"ROS_DISTRO: unknown .*'jazzi'.*'jazzy'"):
        type_store.__wrapped__()


def _bytes(gid):
    written = bytes(gid.data)
    assert written[16:] == bytes(8)
    return written[:16]
