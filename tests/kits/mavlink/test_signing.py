"""Signatures, against pymavlink's own at the other end."""

import hashlib

import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError
from seatrial_kits.mavlink.codec import Codec
from seatrial_kits.mavlink.signing import EPOCH, UNIT_S, Signing, read_key
from seatrial_kits.mavlink.state_file import StateFile

KEY = hashlib.sha256(b"correct horse").digest()
OTHER_KEY = hashlib.sha256(b"battery staple").digest()
NOW = 1.7e9  # Unix time, s
HEARTBEAT = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
ARM = mavlink.MAVLink_command_long_message(7, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)


def stamp(unix):
    return round((unix - EPOCH) / UNIT_S)


def station(key=KEY, at=NOW, link=3):
    """Return a ground station that signs, as pymavlink makes one."""
    mav = mavlink.MAVLink(None, 255, 190)
    mav.signing.secret_key, mav.signing.sign_outgoing = key, key is not None
    mav.signing.timestamp, mav.signing.link_id = stamp(at), link
    return mav


def signing(path=None, clock=lambda: NOW):
    return Signing(KEY, StateFile(path), clock)


@pytest.fixture
def guarded():
    return Codec(7, 1, 0, signing())


def test_what_we_sign_a_ground_station_accepts(guarded):
    reader = station()
    for _ in range(3):
        (message,) = reader.parse_buffer(guarded.encode(HEARTBEAT))
        assert message._signed
    assert reader.signing.badsig_count == 0
    assert reader.signing.goodsig_count == 3


def test_a_ground_station_with_another_key_does_not(guarded):
    with pytest.raises(mavlink.MAVError, match="Invalid signature"):
        station(OTHER_KEY).parse_buffer(guarded.encode(HEARTBEAT))


def test_all_links_sign_with_their_own_number_and_rising_timestamps():
    shared = signing()
    links = [Codec(7, 1, number, shared) for number in (0, 1, 257)]
    reader = station()
    frames = [codec.encode(HEARTBEAT) for codec in links * 3]
    stamps = [int.from_bytes(f[-12:-6], "little") for f in frames]
    assert stamps == sorted(set(stamps))
    assert [f[-13] for f in frames[:3]] == [0, 1, 1]
    assert all(reader.parse_buffer(f)[0]._signed for f in frames)


def test_signed_commands_are_received(guarded):
    sender = station()
    assert [m.command for m in guarded.decode(ARM.pack(sender) + ARM.pack(sender))] == [400, 400]


def test_unsigned_commands_are_not(guarded):
    assert guarded.decode(ARM.pack(station(None))) == []
    assert guarded.decode(ARM.pack(station(None), force_mavlink1=True)) == []
    assert guarded.refused == 2


def test_commands_with_a_wrong_signature_are_not(guarded):
    assert guarded.decode(ARM.pack(station(OTHER_KEY))) == []
    assert guarded.refused == 1


def test_a_frame_is_received_once(guarded):
    frame = ARM.pack(station())
    assert len(guarded.decode(frame)) == 1
    assert guarded.decode(frame) == []
    assert guarded.refused == 1


def test_a_frame_received_over_one_link_is_not_received_over_another():
    shared = signing()
    frame = ARM.pack(station())
    assert len(Codec(7, 1, 0, shared).decode(frame)) == 1
    assert Codec(7, 1, 1, shared).decode(frame) == []


def test_radio_status_alone_needs_no_signature(guarded):
    radio = mavlink.MAVLink_radio_status_message(1, 1, 1, 1, 1, 1, 1)
    frames = [m.pack(station(None)) for m in (HEARTBEAT, radio)]
    assert [m.get_type() for m in guarded.decode(b"".join(frames))] == ["RADIO_STATUS"]


def test_presence_with_a_wrong_or_old_signature_is_refused(guarded):
    frame = HEARTBEAT.pack(station())
    guarded.decode(frame)
    assert guarded.decode(frame) == []
    assert guarded.decode(HEARTBEAT.pack(station(OTHER_KEY))) == []


def test_a_new_peer_may_be_a_minute_behind_and_no_more():
    late, too_late = station(at=NOW - 59), station(at=NOW - 61, link=4)
    guarded = Codec(7, 1, 0, signing())
    assert len(guarded.decode(ARM.pack(late))) == 1
    assert guarded.decode(ARM.pack(too_late)) == []


def test_a_forger_cannot_lock_the_owner_out(guarded):
    forger, owner = station(OTHER_KEY, at=NOW + 1e6), station()
    guarded.decode(ARM.pack(forger))
    assert len(guarded.decode(ARM.pack(owner))) == 1


def test_frames_of_an_earlier_run_are_refused(tmp_path):
    path = tmp_path / "state.json"
    sender = station()
    first = signing(path)
    frame = ARM.pack(sender)
    assert len(Codec(7, 1, 0, first).decode(frame)) == 1
    first.save()
    # The clock has not moved: only by the file is this frame old.
    again = Codec(7, 1, 0, signing(path))
    assert again.decode(frame) == []
    # The owner receives our frames, takes our time and is received again.
    sender.parse_buffer(again.encode(HEARTBEAT))
    assert len(again.decode(ARM.pack(sender))) == 1


def test_our_timestamps_never_run_backwards_when_the_clock_does(tmp_path):
    path = tmp_path / "state.json"
    frame = Codec(7, 1, 0, signing(path)).encode(HEARTBEAT)
    earlier = Codec(7, 1, 0, signing(path, lambda: NOW - 86400)).encode(HEARTBEAT)
    stamps = [int.from_bytes(f[-12:-6], "little") for f in (frame, earlier)]
    assert stamps[0] == stamp(NOW)
    assert stamps[1] > stamps[0]


def test_the_timestamp_is_kept_while_the_run_goes_on(tmp_path):
    path, clock = tmp_path / "state.json", [NOW]
    codec = Codec(7, 1, 0, signing(path, lambda: clock[0]))
    for clock[0] in (NOW + 9, NOW + 11):
        codec.encode(HEARTBEAT)
    assert StateFile(path).get("signing_timestamp", 0) == stamp(NOW + 11)


def test_the_key_is_that_of_the_pass_phrase(tmp_path):
    path = tmp_path / "key"
    path.write_bytes(b"correct horse\r\nand a note\n")
    assert read_key(path) == KEY


@pytest.mark.parametrize(
    ("content", "expected"),
    [(None, "No such file"), (b"\nx", "is empty"), (b"\xff\xfe", "not UTF-8")],
)
def test_a_bad_key_file_is_refused(tmp_path, content, expected):
    path = tmp_path / "key"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=f"signing key file {path}.*{expected}"):
        read_key(path)


@pytest.mark.parametrize(("content", "expected"), [("{", "not JSON"), ("[]", "a JSON object")])
def test_a_bad_state_file_is_refused(tmp_path, content, expected):
    path = tmp_path / "state.json"
    path.write_text(content)
    with pytest.raises(InputError, match=f"state file {path}: {expected}"):
        StateFile(path)


def test_the_state_file_keeps_what_others_put_there(tmp_path):
    path = tmp_path / "state.json"
    StateFile(path).put("parameters", {"A": 1})
    StateFile(path).put("signing_timestamp", 5)
    kept = StateFile(path)
    assert (kept.get("parameters", None), kept.get("signing_timestamp", 0)) == ({"A": 1}, 5)
    assert [p.name for p in tmp_path.iterdir()] == ["state.json"]


def test_a_state_file_that_cannot_be_written_is_named(tmp_path):
    path = tmp_path / "no such folder" / "state.json"
    with pytest.raises(InputError, match=f"state file {path}: No such file"):
        StateFile(path).put("x", 1)
