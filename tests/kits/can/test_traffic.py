"""The node that loads a bus: periods, jitter, offered load, states."""

import json

import pytest

from seatrial.errors import InputError
from seatrial_kits.can.bits import INTERMISSION, length
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit
from seatrial_kits.can.traffic import CanTraffic


def node(**values):
    made = CanTraffic("node")
    for name, value in values.items():
        made.set(name, value)
    made.initialise()
    made.begin()
    return made


def requested(made, until_ms, step_ms=1, begin_ms=0, memory=None):
    """Return (time in ns, frame) of what it requests."""
    memory, found = memory if memory is not None else {}, []
    for k in range(begin_ms, until_ms, step_ms):
        made.advance(k / 1e3, step_ms / 1e3)
        received = CanNode(memory).receive(made.get("tx"))
        found += [(when, each.frame) for when, each in received if isinstance(each, Transmit)]
    return found


def test_frames_come_at_their_periods():
    made = node(messages="0x123 0.01 8; 0x09F10D01 0.02 3 0.0025")
    found = requested(made, 100)
    assert [when for when, f in found if f.identifier == 0x123] == [k * 10**7 for k in range(10)]
    assert [when for when, f in found if f.extended] == [
        k * 2 * 10**7 + 2_500_000 for k in range(5)
    ]
    assert [int.from_bytes(f.data[:4], "little") for _, f in found if not f.extended] == [
        *range(10)
    ]
    assert {len(f.data) for _, f in found if f.extended} == {3}
    assert made.get("asked") == 15


def test_a_period_need_not_fit_the_step():
    found = requested(node(messages="0x123 0.0003 0"), 9, 3)
    assert [when for when, _ in found] == [k * 300_000 for k in range(30)]


def test_jitter_delays_up_to_its_share_evenly():
    found = requested(node(messages="0x123 0.01 0", jitter=0.5, seed=3.0), 10_000, 100)
    late = [when - k * 10**7 for k, (when, _) in enumerate(found)]
    assert len(late) >= 999
    assert 0 <= min(late) < 10**5
    assert 0 <= 5 * 10**6 - max(late) < 10**5
    assert sum(late) / len(late) == pytest.approx(2.5e6, rel=0.08)


@pytest.mark.parametrize("form", ["classic", "fd", "fd-switch"])
def test_the_background_takes_its_share_of_the_bus(form):
    made = node(load=0.37, background="0x700 0x18FF0000", format=form, size=8.0)
    found = requested(made, 2000, 10)
    time = sum(
        (bits.nominal + INTERMISSION) / 250e3 + bits.data / 2e6
        for bits in (length(frame) for _, frame in found)
    )
    assert time / 2.0 == pytest.approx(0.37, abs=1e-3)
    assert [frame.extended for _, frame in found[:4]] == [False, True, False, True]
    assert {frame.fd for _, frame in found} == {form != "classic"}


def test_the_step_and_a_saved_state_change_nothing():
    values = {"messages": "0x1 0.004 8; 0x2 0.007 2", "jitter": 0.3, "load": 0.2}
    whole = requested(node(**values), 600, 10)
    assert requested(node(**values), 600, 1) == whole
    made, memory = node(**values), {}
    first = requested(made, 300, 10, memory=memory)
    state = json.loads(json.dumps(made.get_state()))
    other = node(**values)
    other.set_state(state)
    assert first + requested(other, 600, 10, 300, memory) == whole


def test_silence_and_a_load_that_changes():
    made, memory = node(messages="0x1 0.01 0", load=0.1), {}
    assert len(requested(made, 100, memory=memory)) > 10
    made.set("silent", True)
    assert requested(made, 200, begin_ms=100, memory=memory) == []
    made.set("silent", False)
    made.set("load", 0.0)
    found = requested(made, 300, begin_ms=200, memory=memory)
    assert [when for when, _ in found] == [k * 10**7 for k in range(20, 30)]


@pytest.mark.parametrize(
    ("values", "what"),
    [
        ({"messages": "0x123 10ms 8"}, "'0x123 10ms 8' is not IDENTIFIER PERIOD BYTES"),
        ({"messages": "0x123 0 8"}, "the period is above 0"),
        ({"messages": "0x123 0.1 9"}, "bytes are one of"),
        ({"messages": "0x123 0.1 12"}, "12 bytes in a CAN frame"),
        ({"messages": "0xFFF 0.1 8"}, "allowed 0 to 0x7FF"),
        ({"background": "x"}, "background: 'x' is no identifier"),
        ({"background": ""}, "names no identifier"),
        ({"size": 9.0}, "9 bytes"),
        ({"size": 7.5}, "whole number"),
        ({"format": "xl"}, "unknown value of format 'xl'"),
    ],
)
def test_mistakes_are_named(values, what):
    with pytest.raises(InputError, match=what):
        node(**values)
