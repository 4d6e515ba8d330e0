"""A node and components on a bench: what the tests of the protocol share."""

import json
from pathlib import Path

from seatrial.links.text import Inbox, Outbox
from seatrial_kits.videoray import registers as csr
from seatrial_kits.videoray.frame import PRO4, Frame, encode
from seatrial_kits.videoray.identity import make_identity
from seatrial_kits.videoray.node import RovNode
from seatrial_kits.videoray.parser import Parser

REFERENCE = Path(__file__).parents[2] / "reference"
PACKETS = [
    bytes.fromhex(text)
    for text in json.loads((REFERENCE / "videoray_pro4_packets.json").read_text())
]
"""VideoRay's captured packets: request, response, request, ..."""
BOARDS = (
    "Pro4CPU20 Pro4Power16C Pro4Pressure04 Pro4CamIO02 Pro4Cam01 Pro4LEDMain03 ThrustBL01 "
    "ThrustBLG01"
)
TIMEOUT_NS = 50_000_000
STEP = 0.01


def frames(data, dialect=PRO4):
    return [frame for _, frame in Parser(TIMEOUT_NS, (dialect,)).feed(data, 0)]


def make_node(memory=None, **options):
    return RovNode(
        make_identity("J14461", BOARDS, "2.6.6"), memory or csr.factory_memory(), **options
    )


def request(node=1, flags=0, address=0, payload=b""):
    return Frame(False, node, flags, address, payload)


def exchange(node, **fields):
    """Return the payload of the answer after the type of device; None if there is none."""
    answer = node.handle(request(**fields))
    if answer is None:
        return None
    assert answer.is_response
    assert answer.payload[0] == 1
    return answer.payload[1:]


class Line:
    """A component on a line: bytes in, bytes out, in simulated time."""

    def __init__(self, cls, **parameters):
        self.component = cls(cls.__name__)
        for name, value in parameters.items():
            self.component.set(name, value)
        self.component.setup(0.0)
        self.component.initialise()
        self.component.begin()
        self._out, self._in = {}, {}
        self.steps = 0

    @property
    def now(self):
        return self.steps * 10_000_000

    def send(self, data, at_ns=None):
        Outbox(self._out).put(self.now if at_ns is None else at_ns, data)

    def step(self, count=1):
        """Step and return (time ns, bytes) of what was sent."""
        received = []
        for _ in range(count):
            self.component.set("rx", Outbox(self._out).flush())
            self.component.advance(self.now / 1e9, STEP)
            self.steps += 1
            received += Inbox(self._in).take(self.component.get("tx"))
        return received

    def exchange(self, frame, steps=5, dialect=PRO4):
        """Send a request and return the frames that come back."""
        self.send(encode(frame, dialect))
        return [f for _, data in self.step(steps) for f in frames(data, dialect)]

    def __getitem__(self, name):
        return self.component.get(name)
