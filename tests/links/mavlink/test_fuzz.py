"""Whatever comes over a link: no crash, and with signatures no command from a stranger."""

import hashlib
import os

from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.mavlink.codec import Codec
from seatrial.links.mavlink.radio import Sender
from seatrial.links.mavlink.signing import EPOCH, UNIT_S, Signing
from seatrial.links.mavlink.state_file import StateFile

from .bench import Bench

CASES = 1000 if os.environ.get("CI") else 200
NOW = 1.7e9
KEY = hashlib.sha256(b"correct horse").digest()

# What a vehicle listens to is tried more often than the rest of the dialect.
HEARD = [
    mavlink.mavlink_map[number]
    for number in (0, 4, 11, 66, 69, 70, 75, 76, 82, 84, 86, 111, 243, 48, 256)
]
ALL = [m for number, m in sorted(mavlink.mavlink_map.items()) if number >= 0]
COMMANDS = [16, 20, 176, 179, 192, 246, 300, 400, 401, 410, 510, 511, 512, 520]

LIMITS = {
    **{f"uint{n}_t": (0, 2**n - 1) for n in (8, 16, 32, 64)},
    **{f"int{n}_t": (-(2 ** (n - 1)), 2 ** (n - 1) - 1) for n in (8, 16, 32, 64)},
}


def values(kind):
    if kind in ("float", "double"):
        special = st.sampled_from([0.0, 1.0, float("nan"), float("inf"), -float("inf"), 3.4e38])
        return special | st.floats(width=32)
    low, high = LIMITS[kind]
    return st.sampled_from([0, 1, 3, 4, 7, 15, low, high]) | st.integers(low, high)


@st.composite
def messages(draw):
    """Draw any message with any content; commands often have a number that means something."""
    cls = draw(st.sampled_from(HEARD) | st.sampled_from(ALL))
    fields = []
    # Lengths are given in the order of the frame.
    lengths = dict(zip(cls.ordered_fieldnames, cls.array_lengths, strict=True))
    for name, kind in zip(cls.fieldnames, cls.fieldtypes, strict=True):
        length = lengths[name]
        if kind == "char":
            fields.append(draw(st.binary(max_size=length or 1)) if length else b"x")
        elif length:
            fields.append(draw(st.lists(values(kind), min_size=length, max_size=length)))
        elif name in ("target_system", "target"):
            fields.append(draw(st.sampled_from([7, 7, 7, 0, 8])))
        elif name == "target_component":
            fields.append(draw(st.sampled_from([1, 1, 1, 0, 2])))
        elif name == "command" and cls.id in (75, 76):
            fields.append(draw(st.sampled_from(COMMANDS) | values(kind)))
        else:
            fields.append(draw(values(kind)))
    return cls(*fields)


def peer(key=None):
    mav = mavlink.MAVLink(None, 255, 190)
    if key is not None:
        mav.signing.secret_key, mav.signing.sign_outgoing = key, True
        mav.signing.timestamp = round((NOW - EPOCH) / UNIT_S)
    return mav


def deliver(bench, codec, data):
    for message in codec.decode(data):
        sender = Sender(message.get_srcSystem(), message.get_srcComponent(), 0)
        bench.node.receive(message, sender, bench.now)
    bench.tick()


def what_was_told(bench):
    """Return all that somebody may change in a vehicle."""
    v = bench.vehicle
    return v.mode.name, v.armed, v.sticks, v.target, v.home_n, list(v.channels)


@settings(max_examples=CASES, deadline=None)
@given(st.lists(st.binary(max_size=300), max_size=10))
def test_random_bytes(pieces):
    bench, codec = Bench(), Codec(7, 1)
    before = what_was_told(bench)
    for piece in pieces:
        deliver(bench, codec, piece)
    assert what_was_told(bench) == before


@settings(max_examples=CASES, deadline=None)
@given(st.lists(messages(), max_size=15), st.booleans(), st.sampled_from(["ardupilotmega", "px4"]))
def test_random_messages(said, submerged, autopilot):
    bench, codec, sender = Bench(submerged=submerged, autopilot=autopilot), Codec(7, 1), peer()
    for message in said:
        deliver(bench, codec, message.pack(sender))
    bench.wait(0.5)
    v = bench.vehicle
    assert v.flavour.mode(v.mode.name) is v.mode
    assert all(-1.0 <= stick <= 1.0 for stick in v.sticks)
    assert v.target is None or all(abs(x) <= 1e6 for x in v.target.position)


@settings(max_examples=CASES, deadline=None)
@given(st.lists(messages(), min_size=1, max_size=15), st.randoms(use_true_random=False))
def test_frames_with_broken_bytes(said, random):
    bench, codec, sender = Bench(), Codec(7, 1), peer()
    for message in said:
        frame = bytearray(message.pack(sender))
        frame[random.randrange(len(frame))] ^= 1 << random.randrange(8)
        deliver(bench, codec, bytes(frame))


@settings(max_examples=CASES, deadline=None)
@given(
    st.lists(messages(), max_size=15),
    st.sampled_from([None, hashlib.sha256(b"battery staple").digest()]),
)
def test_with_signatures_a_stranger_changes_nothing(said, key):
    signing = Signing(KEY, StateFile(None), lambda: NOW)
    bench, codec, stranger = Bench(station_timeout=120.0), Codec(7, 1, 0, signing), peer(key)
    before = what_was_told(bench)
    for message in said:
        deliver(bench, codec, message.pack(stranger))
    assert what_was_told(bench) == before
    assert bench.air.take("COMMAND_ACK") == []


@settings(max_examples=CASES, deadline=None)
@given(st.lists(messages(), max_size=15))
def test_what_is_meant_for_another_vehicle_changes_nothing(said):
    bench, codec, sender = Bench(), Codec(7, 1), peer()
    before = what_was_told(bench)
    for message in said:
        for name in ("target_system", "target"):
            if hasattr(message, name):
                setattr(message, name, 8)
                deliver(bench, codec, message.pack(sender))
    assert what_was_told(bench) == before
    assert bench.air.take("COMMAND_ACK") == []
