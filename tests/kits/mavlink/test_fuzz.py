"""Fuzzing of a link: no crash, and with signatures no command from a stranger."""

import hashlib
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.codec import Codec
from seatrial_kits.mavlink.signing import EPOCH, UNIT_S, Signing
from seatrial_kits.mavlink.state_file import StateFile
from seatrial_kits.mavlink.transport import Sender

from .bench import Bench
from .ground import FENCE, MISSION, RALLY, content, download
from .noise import OTHER, SYSTEM, message, sized

NOW = 1.7e9
KEY = hashlib.sha256(b"correct horse").digest()
OTHER_KEY = hashlib.sha256(b"battery staple").digest()
MOST_MESSAGES = 15


def peer(key=None):
    mav = mavlink.MAVLink(None, 255, 190)
    if key is not None:
        mav.signing.secret_key, mav.signing.sign_outgoing = key, True
        mav.signing.timestamp = round((NOW - EPOCH) / UNIT_S)
    return mav


def codec(key=None):
    signing = None if key is None else Signing(key, StateFile(None), lambda: NOW)
    return Codec(SYSTEM, 1, 0, signing)


def some_bench(random):
    return Bench(
        submerged=random.random() < 0.5,
        autopilot=random.choice(["ardupilotmega", "px4"]),
        valid=random.random() < 0.8,
        station_timeout=120.0,
    )


def deliver(bench, codec, data):
    for received in codec.decode(data):
        sender = Sender(received.get_srcSystem(), received.get_srcComponent(), 0)
        bench.node.receive(received, sender, bench.now)
    bench.tick()


def reported_state(bench):
    """Return all that a station may change in a vehicle."""
    v, table = bench.vehicle, bench.parameters
    plans = [[content(m) for m in download(bench, kind)] for kind in (MISSION, FENCE, RALLY)]
    values = [table[name] for name in table.names]
    return v.mode.name, v.armed, v.manual, v.target, v.home_n, list(v.channels), plans, values


def is_sane(bench):
    v = bench.vehicle
    assert v.dialect.mode(v.mode.name) is v.mode
    assert all(-1.0 <= axis <= 1.0 for axis in v.manual)
    assert all(abs(x) <= 1e6 for x in v.home_n)
    assert v.target is None or all(abs(x) <= 1e6 for x in v.target.position)


# ---------------------------------------------------------------------- cases, each of a Random


def bytes_change_nothing(random):
    bench, received = some_bench(random), codec()
    before = reported_state(bench)
    for _ in range(random.randint(1, 10)):
        deliver(bench, received, random.randbytes(random.randint(0, 300)))
    assert reported_state(bench) == before


def messages_leave_it_sane(random):
    bench, received, sender = some_bench(random), codec(), peer()
    for _ in range(random.randint(1, MOST_MESSAGES)):
        deliver(bench, received, message(random).pack(sender))
    bench.wait(0.05)
    is_sane(bench)


def signed_messages_leave_it_sane(random):
    bench, received, sender = some_bench(random), codec(KEY), peer(KEY)
    for _ in range(random.randint(1, MOST_MESSAGES)):
        deliver(bench, received, message(random).pack(sender))
    assert received.refused == 0
    is_sane(bench)


def lengths_leave_it_sane(random):
    bench, received, sender = some_bench(random), codec(), peer()
    for _ in range(random.randint(1, MOST_MESSAGES)):
        frame = bytearray(sized(random, sender))
        if random.random() < 0.3:  # another length, or other flags
            frame[random.randrange(3)] ^= 1 << random.randrange(8)
        deliver(bench, received, bytes(frame))
    is_sane(bench)


def broken_frames_change_nothing(random):
    bench, received, sender = some_bench(random), codec(), peer()
    before = reported_state(bench)
    for _ in range(random.randint(1, MOST_MESSAGES)):
        frame = bytearray(message(random).pack(sender))
        # A checksum finds each single error, but for those in the length and the flags: they make
        # it another frame.
        frame[random.randrange(3, len(frame))] ^= 1 << random.randrange(8)
        deliver(bench, received, bytes(frame))
    assert reported_state(bench) == before


def a_stranger_changes_nothing(random):
    bench, received = some_bench(random), codec(KEY)
    strangers = [peer(), peer(OTHER_KEY)]
    before = reported_state(bench)
    for _ in range(random.randint(1, MOST_MESSAGES)):
        stranger = random.choice(strangers)
        data = message(random).pack(stranger) if random.random() < 0.8 else sized(random, stranger)
        deliver(bench, received, data)
    assert bench.transport.take("COMMAND_ACK") == []
    assert reported_state(bench) == before


def what_is_replayed_changes_nothing(random):
    bench, received, owner = some_bench(random), codec(KEY), peer(KEY)
    frames = [message(random).pack(owner) for _ in range(random.randint(1, MOST_MESSAGES))]
    for frame in frames:
        received.decode(frame)
    before = reported_state(bench)
    for frame in frames:
        deliver(bench, received, frame)
    assert received.refused == len(frames)
    assert reported_state(bench) == before


def what_is_for_another_changes_nothing(random):
    key = random.choice([None, KEY])
    bench, received, sender = some_bench(random), codec(key), peer(key)
    before = reported_state(bench)
    for _ in range(random.randint(1, MOST_MESSAGES)):
        sent = message(random, system=OTHER)
        if hasattr(sent, "target_system") or hasattr(sent, "target"):
            deliver(bench, received, sent.pack(sender))
    assert bench.transport.take("COMMAND_ACK") == []
    assert reported_state(bench) == before


CASES = [
    bytes_change_nothing,
    messages_leave_it_sane,
    signed_messages_leave_it_sane,
    lengths_leave_it_sane,
    broken_frames_change_nothing,
    a_stranger_changes_nothing,
    what_is_replayed_changes_nothing,
    what_is_for_another_changes_nothing,
]


@pytest.mark.parametrize("total", [400, pytest.param(100_000, marks=pytest.mark.long)])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.__name__)
def test_whatever_comes(case, total):
    # One number per example: fields drawn one by one take fifty times as long.
    @settings(max_examples=total // len(CASES), deadline=None, derandomize=True)
    @given(st.integers(0, 2**64 - 1))
    def tried(seed):
        case(random.Random(seed))

    tried()


def test_the_cases_reach_what_they_are_about():
    """Of unsigned messages to a vehicle without a key many are obeyed: the cases can fail."""
    obeyed = 0
    for seed in range(60):
        drawn = random.Random(seed)
        bench, received, sender = some_bench(drawn), codec(), peer()
        before = reported_state(bench)
        for _ in range(MOST_MESSAGES):
            deliver(bench, received, message(drawn).pack(sender))
        obeyed += reported_state(bench) != before
    assert obeyed > 15
