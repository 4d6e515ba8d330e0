"""Frames on a DroneCAN bus: transfers of the kinds that nodes take."""

from __future__ import annotations

from dronecan import uavcan

from seatrial.links.text import Outbox
from seatrial_kits.can.dronecan.autopilot import DroneCanAutopilot
from seatrial_kits.can.dronecan.codec import MOST_FRAMES
from seatrial_kits.can.dronecan.peripheral import DroneCanPeripheral
from seatrial_kits.can.dronecan.transfers import Transfers
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit, encode

from .can_frames import frames_of, receive

assert uavcan  # the data types, loaded by the package
WANTED = frozenset([(1034, False), (341, False), (1, True), (1, False), (11, True), (1030, False)])
_NODE = 5


def one(data: bytes) -> None:
    """Receive the frames, alone and as nodes; a session keeps no more than a transfer can have."""
    memory: dict[str, object] = {}
    transfers, outbox = Transfers(memory, CanNode({})), Outbox({})
    sent = frames_of(data)
    for frame in sent:
        outbox.put(0, encode(Transmit(frame)))
    found = list(transfers.receive(outbox.flush(), WANTED, _NODE))
    assert len(found) + transfers.malformed <= len(sent)
    sessions = memory["sessions"]
    assert isinstance(sessions, dict)
    assert all(len(session[2]) <= MOST_FRAMES for session in sessions.values())
    for kind in (DroneCanAutopilot, DroneCanPeripheral):
        node = kind("node")
        node.set("node_id", float(_NODE))
        receive(node, sent)
