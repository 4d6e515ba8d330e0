"""Restored states: every value of components, nodes, parsers and lines as it was saved."""

import json

import pytest

from seatrial.links.videoray.frame import VRCSR, Frame, encode
from seatrial.links.videoray.m5_thrusters import M5Thrusters
from seatrial.links.videoray.rov import Pro4Rov
from seatrial.links.videoray.station import Orders
from seatrial.links.videoray.topside import Pro4Topside
from seatrial.links.videoray.vrcsr import propulsion_request
from tests.snapshot import changed, snapshot

from .bench import PACKETS, Wired

OWN = frozenset({"name", "_log"})


def rov():
    """A vehicle under way, in the middle of a request, with a broken one behind it."""
    wired = Wired(Pro4Rov)
    wired.component.set("depth", 1.3)
    orders = Orders(thrust=(0.2, 0.1, 0.0), auto_depth=1200.0, auto_heading=30.0)
    wired.say(encode(Frame(False, 1, 5, 0, orders.block())))
    wired.step(40)
    wired.say(b"\xfa\xaf\x01" + PACKETS[6] + PACKETS[6][:9])
    wired.step()
    return wired


def topside():
    """A station that has found its vehicle and drives it."""
    wired = Wired(Pro4Topside)
    for answer in PACKETS[1], PACKETS[3], PACKETS[5], PACKETS[7]:
        wired.step(20)
        wired.say(answer)
    wired.step(10)
    wired.say(PACKETS[7][:9])
    wired.step()
    return wired


def thrusters():
    """Thrusters that turn, one of them asked for its health."""
    wired = Wired(M5Thrusters)
    data = encode(propulsion_request([0.5, 0.2, -1.0], 1), VRCSR)
    for _ in range(5):
        wired.say(data)
        wired.step(5)
    wired.say(data[:9])
    wired.step()
    return wired


def disturb(wired):
    """Go on with other inputs, other requests and noise, until nothing is as it was."""
    component = wired.component
    for name, port in component.ports.items():
        if port.kind == "input" and port.type is float:
            component.set(name, [0.3] * port.size if port.axes else 0.3)
    wired.say(bytes(range(256)))
    wired.step(20)
    commit = Frame(False, 1, 0, 0xEE, b"\1\0")
    for request in (Frame(False, 1, 5, 0, Orders(lights=0.5).block()), commit):
        wired.say(encode(request))
        wired.step(20)
    wired.say(encode(propulsion_request([-0.5, 0.7, 0.1], 2), VRCSR) + PACKETS[7] + PACKETS[6][:12])
    wired.step(3)


@pytest.mark.parametrize("made", [rov, topside, thrusters])
def test_every_value_is_as_it_was_saved(made):
    wired = made()
    state, saved = wired.component.get_state(), snapshot(wired.component, OWN)
    json.dumps(state["parts"])  # plain data
    disturb(wired)
    assert len(changed(saved, snapshot(wired.component, OWN))) > 5
    wired.component.set_state(state)
    assert changed(saved, snapshot(wired.component, OWN)) == set()
    other = type(wired.component)("other")
    other.set_state(state)
    assert changed(saved, snapshot(other, OWN)) == set()
