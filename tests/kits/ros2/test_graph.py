"""Node names, read by a program with rmw_dds_common's types typed by hand."""

import time
from dataclasses import dataclass

import pytest
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, bounded_str, sequence, uint8

from seatrial import Simulation

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


def _bytes(gid):
    written = bytes(gid.data)
    assert written[16:] == bytes(8)
    return written[:16]
