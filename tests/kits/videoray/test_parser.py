"""Streams that are broken anywhere: nothing crashes, and the next good frame is found."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial_kits.videoray.frame import PRO4, VRCSR, Frame, encode
from seatrial_kits.videoray.parser import Parser

from .bench import PACKETS, TIMEOUT_NS, frames, make_node

GOOD = Frame(False, 1, 5, 0, bytes(15))
CASES = settings(max_examples=150, deadline=None)
MANY = settings(max_examples=100_000, deadline=None)
dialects = pytest.mark.parametrize("dialect", [PRO4, VRCSR], ids=lambda d: d.name)

some_frames = st.builds(
    Frame,
    st.booleans(),
    *[st.integers(0, 255)] * 3,
    st.binary(max_size=40) | st.integers(250, 300).map(bytes) | st.just(bytes(2000)),
)


@st.composite
def broken_streams(draw):
    """Return pieces of a stream: frames whole, cut, flipped, doubled and mixed, and noise."""
    parts = []
    for frame in draw(st.lists(some_frames, max_size=5)):
        data = bytearray(encode(frame, draw(st.sampled_from([PRO4, VRCSR]))))
        match draw(st.sampled_from(["whole", "cut", "flipped", "doubled", "noise", "mixed"])):
            case "cut":
                del data[draw(st.integers(0, len(data))) :]
            case "flipped":
                data[draw(st.integers(0, len(data) - 1))] ^= 1 << draw(st.integers(0, 7))
            case "doubled":
                data += bytes(data)
            case "noise":
                data += draw(st.binary(max_size=30))
            case "mixed" if parts:
                place = draw(st.integers(0, len(data)))
                data[place:place] = parts.pop()
        parts.append(bytes(data))
    stream = b"".join(parts)
    size = draw(st.integers(1, 60))
    return [stream[i : i + size] for i in range(0, len(stream), size)]


@dialects
@given(frame=some_frames)
@CASES
def test_every_frame_round_trips(dialect, frame):
    assert frames(encode(frame, dialect), dialect) == [frame]


@dialects
@given(frame=some_frames, sizes=st.lists(st.integers(1, 30), min_size=1, max_size=20))
@settings(max_examples=60, deadline=None)
def test_pieces_of_any_size_make_the_same_frame(dialect, frame, sizes):
    parser, data, found, place = Parser(TIMEOUT_NS, (dialect,)), encode(frame, dialect), [], 0
    while place < len(data):
        size = sizes[place % len(sizes)]
        found += parser.feed(data[place : place + size], 0)
        place += size
    assert [f for _, f in found] == [frame]


def survives(pieces):
    parser, node = Parser(TIMEOUT_NS, (PRO4, VRCSR)), make_node()
    now = 0
    for piece in pieces:
        for _, frame in parser.feed(piece, now):
            node.handle(frame)
        now += 1_000_000
    for _, frame in parser.expire(now + 2 * TIMEOUT_NS):
        node.handle(frame)
    requests = node.requests
    (frame,) = [
        f
        for _, f in parser.feed(
            encode(Frame(False, node.node_id, 1, 0)), 10 * now + 10 * TIMEOUT_NS
        )
    ]
    assert node.handle(frame).is_response
    assert node.requests == requests + 1
    assert parser.saved()["buffer"] == ""


@pytest.mark.slow
@given(broken_streams())
@CASES
def test_after_the_time_out_the_next_frame_is_received_whatever_was_before(pieces):
    survives(pieces)


@pytest.mark.long
@given(broken_streams())
@MANY
def test_a_hundred_thousand_broken_streams(pieces):
    survives(pieces)


@dialects
@given(data=st.data())
@CASES
def test_one_flipped_bit_never_gives_a_frame(dialect, data):
    encoded = bytearray(encode(GOOD, dialect))
    encoded[data.draw(st.integers(0, len(encoded) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    parser = Parser(TIMEOUT_NS, (dialect,))
    assert parser.feed(bytes(encoded), 0) + parser.expire(2 * TIMEOUT_NS) == []


@pytest.mark.parametrize("place", [6, 8, 22], ids=["header", "payload", "total"])
def test_a_wrong_checksum_is_counted_once_and_the_next_frame_is_received_at_once(place):
    data = bytearray(encode(GOOD))
    data[place] ^= 0x10
    parser = Parser(TIMEOUT_NS)
    assert [f for _, f in parser.feed(bytes(data) + encode(GOOD), 0)] == [GOOD]
    assert (parser.checksum_errors, parser.broken_off) == (1, 0)


def test_bytes_between_frames_are_no_errors():
    parser = Parser(TIMEOUT_NS)
    assert len(parser.feed(b"noise" + encode(GOOD) + b"\xfa\xfa\xfd" + encode(GOOD), 0)) == 2
    assert (parser.checksum_errors, parser.skipped) == (0, 8)


def test_a_frame_inside_a_cut_one_is_received():
    whole = encode(Frame(False, 1, 0, 0, bytes(60)))
    parser = Parser(TIMEOUT_NS)
    found = parser.feed(whole[:20] + encode(GOOD) * 3, 0)
    assert [f for _, f in found + parser.expire(2 * TIMEOUT_NS)][-1] == GOOD


def test_a_false_length_of_64_kb_swallows_no_more_than_until_the_time_out():
    header = encode(Frame(False, 1, 0, 0, bytes(0xFFFF)))[:10]
    parser, now = Parser(TIMEOUT_NS), 0
    assert parser.feed(header, now) == []
    for _ in range(3):  # without a gap: lost in the payload, and found again
        now += 1_000_000
        assert parser.feed(encode(GOOD), now) == []
    found = parser.expire(now + TIMEOUT_NS + 1)
    assert [f for _, f in found] == [GOOD] * 3
    assert parser.broken_off == 1


@pytest.mark.parametrize(("gap", "received"), [(0.9, 1), (1.1, 0)])
def test_a_gap_longer_than_the_time_out_ends_a_frame(gap, received):
    data, parser = encode(GOOD), Parser(TIMEOUT_NS)
    parser.feed(data[:9], 0)
    found = parser.feed(data[9:], round(gap * TIMEOUT_NS))
    assert len(found) == received
    assert parser.broken_off == 1 - received


def test_times_are_those_of_the_last_byte():
    parser = Parser(TIMEOUT_NS)
    times = [when for when, _ in parser.feed(b"xx" + encode(GOOD) * 2, 1000, 10)]
    assert times == [1000 + 25 * 10, 1000 + 48 * 10]


@pytest.mark.parametrize("length", [0, 1, 253, 254, 255, 256, 292, 65535])
def test_lengths(length):
    data = encode(Frame(True, 1, 0x80, 0, bytes(length)))
    extended = length >= 255
    assert data[5] == (0xFF if extended else length)
    assert len(data) == 7 + 3 * extended + length + 1
    (frame,) = frames(data)
    assert len(frame.payload) == length


def test_extended_requests_are_written():
    node = make_node()
    (frame,) = frames(encode(Frame(False, 1, 0x8F, 0, bytes([7] * 300))))
    assert node.handle(frame).payload[1:] == bytes([7] * 15)


def test_an_extended_length_for_a_short_payload_is_understood():
    payload = b"\1\2\3"
    head = bytes.fromhex("faaf010000ff")
    length = len(payload).to_bytes(2, "little")
    data = b"".join(part + PRO4.check(part) for part in (head, length, payload))
    assert frames(data)[0].payload == payload


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (Frame(False, 256, 0, 0), "id of a PRO4 frame is 256"),
        (Frame(False, 1, -1, 0), "flags"),
        (Frame(False, 1, 0, 0, bytes(65536)), "65536 bytes"),
    ],
)
def test_frames_that_cannot_be_are_refused(frame, message):
    with pytest.raises(InputError, match=message):
        encode(frame)


def test_state_is_saved_in_the_middle_of_a_frame():
    parser, other = Parser(TIMEOUT_NS), Parser(TIMEOUT_NS)
    parser.feed(PACKETS[3][:100], 5)
    other.restore(parser.saved())
    assert other.feed(PACKETS[3][100:], 6) == parser.feed(PACKETS[3][100:], 6) != []
    assert other.saved() == parser.saved()
