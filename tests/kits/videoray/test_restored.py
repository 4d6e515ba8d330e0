"""Restored states: every value of components, nodes, parsers and lines as it was saved."""

import json

import pytest

from seatrial_kits.videoray.frame import VRCSR, Frame, encode
from seatrial_kits.videoray.m5_thrusters import M5Thrusters
from seatrial_kits.videoray.rov import Pro4Rov
from seatrial_kits.videoray.station import Commands
from seatrial_kits.videoray.topside import Pro4Topside
from seatrial_kits.videoray.vrcsr import propulsion_request
from tests.snapshot import changed, snapshot

from .bench import PACKETS, Line

OWN = frozenset({"name", "_log"})


def rov():
    """A vehicle under way, in the middle of a request, with a broken one behind it."""
    line = Line(Pro4Rov)
    line.component.set("depth", 1.3)
    commands = Commands(thrust=(0.2, 0.1, 0.0), auto_depth=1200.0, auto_heading=30.0)
    line.send(encode(Frame(False, 1, 5, 0, commands.block())))
    line.step(40)
    line.send(b"\xfa\xaf\x01" + PACKETS[6] + PACKETS[6][:9])
    line.step()
    return line


def topside():
    """A station that has found its vehicle and drives it."""
    line = Line(Pro4Topside)
    for answer in PACKETS[1], PACKETS[3], PACKETS[5], PACKETS[7]:
        line.step(20)
        line.send(answer)
    line.step(10)
    line.send(PACKETS[7][:9])
    line.step()
    return line


def thrusters():
    """Thrusters that turn, one of them asked for its health."""
    line = Line(M5Thrusters)
    data = encode(propulsion_request([0.5, 0.2, -1.0], 1), VRCSR)
    for _ in range(5):
        line.send(data)
        line.step(5)
    line.send(data[:9])
    line.step()
    return line


def disturb(line):
    """Go on with other inputs, other requests and noise, until nothing is as it was."""
    component = line.component
    for name, port in component.ports.items():
        if port.kind == "input" and port.type is float:
            component.set(name, [0.3] * port.size if port.axes else 0.3)
    line.send(bytes(range(256)))
    line.step(20)
    commit = Frame(False, 1, 0, 0xEE, b"\1\0")
    for request in (Frame(False, 1, 5, 0, Commands(lights=0.5).block()), commit):
        line.send(encode(request))
        line.step(20)
    line.send(encode(propulsion_request([-0.5, 0.7, 0.1], 2), VRCSR) + PACKETS[7] + PACKETS[6][:12])
    line.step(3)


@pytest.mark.parametrize("made", [rov, topside, thrusters])
def test_every_value_is_as_it_was_saved(made):
    line = made()
    state, saved = line.component.get_state(), snapshot(line.component, OWN)
    json.dumps(state["parts"])  # plain data
    disturb(line)
    assert len(changed(saved, snapshot(line.component, OWN))) > 5
    line.component.set_state(state)
    assert changed(saved, snapshot(line.component, OWN)) == set()
    other = type(line.component)("other")
    other.set_state(state)
    assert changed(saved, snapshot(other, OWN)) == set()
