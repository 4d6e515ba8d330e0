import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.codec import Codec

HEARTBEAT = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


def frame(message, sequence, system=255, component=190, **options):
    """Return a message as a peer of pymavlink sends it."""
    sender = mavlink.MAVLink(None, system, component)
    sender.seq = sequence % 256
    return message.pack(sender, **options)


def text(words):
    return mavlink.MAVLink_statustext_message(6, words.encode())


def test_frames_are_numbered_per_codec():
    one, other = Codec(7, 1), Codec(7, 1)
    reader = mavlink.MAVLink(None)
    numbers = [
        reader.parse_buffer(codec.encode(HEARTBEAT))[0].get_seq()
        for codec in (one, one, other, one)
    ]
    assert numbers == [0, 1, 0, 2]
    assert [reader.parse_buffer(one.encode(HEARTBEAT))[0].get_seq() for _ in range(300)] == [
        k % 256 for k in range(3, 303)
    ]


def test_sender_and_version():
    (message,) = mavlink.MAVLink(None).parse_buffer(Codec(7, 9).encode(HEARTBEAT))
    assert (message.get_srcSystem(), message.get_srcComponent()) == (7, 9)
    assert Codec(7, 9).encode(HEARTBEAT)[0] == 0xFD  # MAVLink 2


@pytest.mark.parametrize("size", [1, 2, 7, 1000])
def test_messages_come_out_however_bytes_arrive(size):
    data = b"".join(frame(text(f"number {k}"), k) for k in range(50))
    codec = Codec(7, 1)
    found = [
        message.text
        for start in range(0, len(data), size)
        for message in codec.decode(data[start : start + size])
    ]
    assert found == [f"number {k}" for k in range(50)]
    assert (codec.bad, codec.lost, codec.duplicated, codec.refused) == (0, 0, 0, 0)


def test_mavlink_1_is_understood():
    (message,) = Codec(7, 1).decode(frame(HEARTBEAT, 0, force_mavlink1=True))
    assert message.type == 6


def test_garbage_between_frames_is_counted_and_passed_over():
    codec = Codec(7, 1)
    broken = bytearray(frame(text("broken"), 1))
    broken[15] ^= 0x40
    data = b"noise" + frame(text("a"), 0) + bytes(broken) + frame(text("b"), 2) + b"more"
    assert [m.text for m in codec.decode(data)] == ["a", "b"]
    assert codec.bad == 3
    assert codec.lost == 1  # the broken one


def test_lost_and_duplicated_frames_are_counted_per_sender():
    codec = Codec(7, 1)
    for sequence in (253, 254, 255, 0, 3, 3, 4):  # 1 and 2 are missing, 3 comes twice
        codec.decode(frame(HEARTBEAT, sequence))
    assert (codec.lost, codec.duplicated) == (2, 1)
    codec.decode(frame(HEARTBEAT, 77, system=250))
    codec.decode(frame(HEARTBEAT, 78, system=250))
    assert (codec.lost, codec.duplicated) == (2, 1)
    codec.decode(frame(HEARTBEAT, 0))  # the sender began anew
    assert (codec.lost, codec.duplicated) == (2, 1)


def test_unknown_messages_are_left_out():
    reader = Codec(7, 1)
    stranger = bytearray(frame(text("x"), 0))
    stranger[7:10] = (0xFE, 0xFF, 0x7F)  # a number that no dialect has
    assert reader.decode(bytes(stranger)) == []
    assert [m.text for m in reader.decode(frame(text("y"), 1))] == ["y"]


def test_a_stream_without_pause_takes_no_more_memory():
    codec, data = Codec(7, 1), frame(text("on and on"), 0) * 2000
    for start in range(0, len(data), 37):  # never at the end of a frame
        codec.decode(data[start : start + 37])
    assert len(codec._mav.buf) < 20_000
