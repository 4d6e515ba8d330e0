"""Transfers out of frames: what is repeated, lost, out of order or malformed."""

import pytest
from dronecan import uavcan
from dronecan.transport import Transfer
from hypothesis import given
from hypothesis import strategies as st

from seatrial.links.text import Outbox
from seatrial_kits.can.dronecan.transfers import TIMEOUT_NS, Transfers
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit, encode

WANTED = frozenset([(1034, False), (341, False), (1, True), (1, False)])


def packages_frames(payload, **fields) -> list[Frame]:
    fields = {"source_node_id": 10, "transfer_id": 3, **fields}
    made = Transfer(payload=payload, **fields).to_frames()
    return [Frame(each.message_id, bytes(each.bytes), True) for each in made]


class Receiver:
    """Frames in, transfers out, with the memory of all before."""

    def __init__(self) -> None:
        self.transfers = Transfers({}, CanNode({}))
        self.bus: dict = {}

    def receive(self, *frames: Frame, at: int = 0, node: int = 5) -> list[Transfer]:
        outbox = Outbox(self.bus)
        for frame in frames:
            outbox.put(at, encode(Transmit(frame)))
        text = outbox.flush()
        return [found for _, found in self.transfers.receive(text, WANTED, node)]


def status(**fields) -> object:
    return uavcan.equipment.esc.Status(voltage=16.0, current=2.0, rpm=-500, esc_index=4, **fields)


@pytest.fixture
def receiver() -> Receiver:
    return Receiver()


def test_a_transfer_of_three_frames(receiver):
    first, second, third = packages_frames(status())
    assert receiver.receive(first, second) == []
    (found,) = receiver.receive(third)
    assert (found.payload.voltage, found.payload.rpm, found.source_node_id) == (16.0, -500, 10)


@pytest.mark.parametrize("order", [(0, 0, 1, 2), (0, 1, 1, 2), (0, 1, 2, 2)])
def test_a_frame_that_came_twice_is_passed_over(receiver, order):
    frames = packages_frames(status())
    assert len(receiver.receive(*(frames[place] for place in order))) == 1


@pytest.mark.parametrize("order", [(0, 2), (1, 2), (0, 2, 1), (2, 1, 0)])
def test_what_is_lost_or_out_of_order_is_no_transfer(receiver, order):
    frames = packages_frames(status())
    assert receiver.receive(*(frames[place] for place in order)) == []
    assert len(receiver.receive(*packages_frames(status(), transfer_id=4))) == 1


def test_a_transfer_that_came_twice_is_one(receiver):
    frames = packages_frames(uavcan.protocol.NodeStatus(uptime_sec=7))
    assert len(receiver.receive(*frames, *frames)) == 1
    assert len(receiver.receive(*frames, at=TIMEOUT_NS)) == 0
    assert len(receiver.receive(*frames, at=TIMEOUT_NS + 1)) == 1  # the node began anew


def test_an_unfinished_transfer_is_given_up(receiver):
    frames = packages_frames(status())
    assert receiver.receive(*frames[:2]) == []
    assert receiver.receive(frames[2], at=TIMEOUT_NS + 1) == []


def test_transfers_of_two_nodes_are_put_together_apart(receiver):
    one, other = packages_frames(status()), packages_frames(status(), source_node_id=11)
    mixed = [frame for pair in zip(one, other, strict=True) for frame in pair]
    assert [found.source_node_id for found in receiver.receive(*mixed)] == [10, 11]


def test_a_wrong_checksum_is_malformed(receiver):
    first, second, third = packages_frames(status())
    wrong = Frame(second.identifier, bytes([second.data[0] ^ 1]) + second.data[1:], True)
    assert receiver.receive(first, wrong, third) == []
    assert receiver.transfers.malformed == 1


def test_services_of_others_are_not_received(receiver):
    # GetNodeInfo, a request without data, from 9 to 5.
    frame = Frame((20 << 24) | (1 << 16) | 0x8000 | (5 << 8) | 0x80 | 9, b"\xc0", True)
    assert len(receiver.receive(frame)) == 1
    assert receiver.receive(Frame(frame.identifier, b"\xc1", True), node=6) == []


def test_a_request_of_nobody_is_not_received(receiver):
    # GetNodeInfo to 5 from the source 0, which only a message may have.
    frame = Frame((20 << 24) | (1 << 16) | 0x8000 | (5 << 8) | 0x80, b"\xc0", True)
    assert receiver.receive(frame) == []


def test_frames_that_are_not_dronecans_are_passed_over(receiver):
    (frame,) = packages_frames(uavcan.protocol.NodeStatus())
    assert receiver.receive(Frame(0x123, bytes(8)), Frame(frame.identifier, b"", True)) == []
    assert receiver.receive(Frame(frame.identifier, frame.data, True, fd=True)) == []
    # DroneCAN begins with toggle 0, its successor with 1.
    successor = frame.data[:-1] + bytes([frame.data[-1] | 0x20])
    assert receiver.receive(Frame(frame.identifier, successor, True)) == []
    assert receiver.transfers.malformed == 0


@given(st.lists(st.tuples(st.sampled_from([1034, 341, 1]), st.binary(max_size=8)), max_size=20))
def test_no_bytes_stop_it(content):
    receiver = Receiver()
    frames = [
        Frame(number << 8 | source, data, True) for number, data in content for source in (0, 9)
    ]
    frames += [Frame(0x18018585 | number << 8 & 0x8000, data, True) for number, data in content]
    receiver.receive(*frames)


def test_a_long_flood_of_middles_is_given_up(receiver):
    first, second, _ = packages_frames(status())
    tails = [second.data[:-1] + bytes([0x03 | 0x20 * (n % 2)]) for n in range(1, 1000)]
    assert receiver.receive(first, *(Frame(first.identifier, data, True) for data in tails)) == []
    assert len(receiver.receive(*packages_frames(status(), transfer_id=4))) == 1
