"""Recorded streams: read, decoded, refused."""

import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray.command_decode import describe, describe_stream
from seatrial_kits.videoray.frame import Frame, encode
from seatrial_kits.videoray.player import StreamPlayer
from seatrial_kits.videoray.stream_file import HEAD, Piece, StreamLog, read_stream

from .bench import PACKETS, Line

PIECES = [Piece(n * 50_000_000, "<" if n % 2 else ">", data) for n, data in enumerate(PACKETS)]


@pytest.fixture
def recorded(tmp_path):
    log = StreamLog()
    log.write(0, ">", b"too early")
    log.open(str(tmp_path), "some")
    for piece in PIECES:
        log.write(*piece)
        log.write(*piece)  # a repeated step
    log.close()
    return tmp_path / "some.stream"


def test_what_was_written_is_read_again(recorded):
    assert list(read_stream(recorded)) == PIECES


def test_decoded_as_text(recorded):
    lines = list(describe_stream(read_stream(recorded)))
    assert lines[0] == "0.000000 > to node 1: reply 1"
    assert lines[1] == (
        "0.050000 < from node 1: reply 1: heading=49.4deg pitch=3.7deg roll=-3deg pressure=0mbar"
    )
    assert lines[2].endswith("> to node 1: read all from 0xF7")
    assert "serial number J14461, cpu=Pro4CPU20" in lines[3]
    assert "auto_depth_target=off" in lines[6]
    assert "vertical_target=0.99" in lines[6]
    assert "humidity=0.48 water_temperature=11.1degC total_power=1" in lines[7]
    assert len(lines) == 10


@pytest.mark.parametrize(
    ("frame", "text"),
    [
        (Frame(False, 0xFF, 0, 0xFE, b"\xde\xad"), "to all: write 0xFE: DE AD"),
        (Frame(False, 0x81, 0, 6, b"\x32"), "to group 1: write lights=0.5"),
        (Frame(False, 1, 0x85, 0x66), "to node 1: read 5 bytes from 0x66"),
        (Frame(True, 1, 9, 0, b"\1\2"), "from node 1: flags 0x09 from 0x00: 02"),
        (
            Frame(False, 0x42, 0, 0xF0, b"\x35\x49\0\0\0\0\3\0"),
            "to manipulator: manipulator open",
        ),
    ],
)
def test_some_frames_as_text(frame, text):
    assert describe(frame) == text


def test_broken_bytes_are_reported():
    pieces = [
        Piece(0, ">", PACKETS[0][:-1] + b"\1"),
        Piece(10**9, ">", encode(Frame(False, 1, 1, 0))),
    ]
    assert list(describe_stream(pieces)) == [
        "0.000000 > ! 1 broken",
        "1.000000 > to node 1: reply 1",
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + "0.1 > FA\n", "some.stream:2: '0.1 > FA' is not a line"),
        ("0.100000000 > FAA\n", "some.stream:1"),
        ("0.100000000 ? FA\n", "some.stream:1"),
    ],
)
def test_what_is_no_stream_is_refused(tmp_path, text, message):
    (tmp_path / "some.stream").write_text(text)
    with pytest.raises(InputError, match=message):
        list(read_stream(tmp_path / "some.stream"))


def test_binary_data_and_missing_files_are_refused(tmp_path):
    (tmp_path / "b").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="binary data"):
        list(read_stream(tmp_path / "b"))
    with pytest.raises(InputError, match="No such file"):
        list(read_stream(tmp_path / "c"))


@pytest.mark.parametrize(("direction", "first"), [("to-device", 0), ("from-device", 1)])
def test_the_player_sends_it_at_the_same_times(recorded, direction, first):
    class Playing(Line):
        def step(self, count=1):
            from seatrial.links.text import Inbox

            received = []
            for _ in range(count):
                self.component.advance(self.now / 1e9, 0.01)
                self.steps += 1
                received += Inbox(self._in).take(self.component.get("tx"))
            return received

    playing = Playing(StreamPlayer, file=str(recorded), direction=direction)
    assert playing.step(60) == [(p.time_ns, p.data) for p in PIECES[first::2]]
    assert playing["played"] == 5


def test_a_player_without_a_file_sends_nothing():
    player = Line(StreamPlayer).component
    player.advance(0.0, 0.01)
    assert (player.get("tx"), player.get("played")) == ("", 0)
