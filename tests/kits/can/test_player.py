"""Recordings of buses: read as their writers meant them, and played at their times.

Texts of gateways and of canboat are lines of the formats as their makers describe them (Yacht
Devices: RAW protocol; canboat: PLAIN and FAST; Actisense: N2K ASCII); the messages in them are put
together again by the package nmea2000, which others wrote.
"""

from __future__ import annotations

import base64
from collections import Counter

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nmea2000 import NMEA2000Decoder

from seatrial.errors import InputError
from seatrial.links.text import Inbox
from seatrial_kits.can.frame import FD_LENGTHS, Frame
from seatrial_kits.can.messages import message
from seatrial_kits.can.operations import Transmit, decode
from seatrial_kits.can.player import CanPlayer
from seatrial_kits.can.recorded import is_recording, pgn_of, recorded_frames
from tests.command import seatrial

HEADING = Frame(0x09F11223, bytes.fromhex("FF103BFF7FCEF5FC"), extended=True)
LINES = {
    "candump -L": "(1436509052.249713) can0 09F11223#FF103BFF7FCEF5FC",
    "candump -ta": " (1436509052.249713)  can0  09F11223   [8]  FF 10 3B FF 7F CE F5 FC",
    "candump -x": " (1436509052.249713)  can0  RX - -  09F11223   [8]  FF 10 3B FF 7F CE F5 FC",
    "Yacht Devices": "06:17:32.249 R 09F11223 FF 10 3B FF 7F CE F5 FC",
    "canboat": "2015-07-10T06:17:32.249Z,2,127250,35,255,8,ff,10,3b,ff,7f,ce,f5,fc",
    "canboat of before": "2015-07-10-06:17:32.249,2,127250,35,255,8,ff,10,3b,ff,7f,ce,f5,fc",
    "canboat's analyzer": "2015-07-10T06:17:32.249 2 035 255 127250 : ff 10 3b ff 7f ce f5 fc",
    "Actisense": "A061732.249 23FF2 1F112 FF103BFF7FCEF5FC",
    "iKonvert": "!PDGY,127250,2,35,255,22652.249,"
    + base64.b64encode(bytes.fromhex("FF103BFF7FCEF5FC")).decode(),
    "Garmin": "7,22652249,127250,Vessel Heading,Garmin,35,255,2,1,8,0xFF103BFF7FCEF5FC",
    "Garmin, with the date": "7,6_21_2015_16_11_14_22652249,127250,Processed,Vessel Heading,"
    "Unknown Manufacturer,35,255,2,1,8,0xFF103BFF7FCEF5FC",
}
TIMELESS = {
    "candump": "  can0  09F11223   [8]  FF 10 3B FF 7F CE F5 FC",
    "candump of before": "<0x09f11223> [8] ff 10 3b ff 7f ce f5 fc",
}


@pytest.fixture
def read(tmp_path):
    def reader(text, name="bus.log"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        skipped = Counter()
        return list(recorded_frames(path, skipped)), skipped

    return reader


@pytest.mark.parametrize("name", [*LINES, *TIMELESS])
def test_the_same_frame_in_each_text(read, tmp_path, name):
    line = {**LINES, **TIMELESS}[name]
    found, skipped = read(f"# a comment\n{line}\nnonsense\n")
    assert [each.frame for each in found] == [HEADING]
    assert skipped == {"lines that are no frame are skipped": 1}
    assert is_recording(tmp_path / "bus.log", line.encode())
    if name in LINES:
        assert found[0].time % 60.0 == pytest.approx(32.249, abs=1e-3)
    else:
        assert found[0].time is None


@pytest.mark.parametrize("name", [*LINES, *TIMELESS])
def test_a_text_of_windows(read, tmp_path, name):
    """A byte order mark, and lines that end in CR LF: no frame is lost."""
    line = {**LINES, **TIMELESS}[name]
    text = f"\ufeff{line}\r\n{line}\r\n"
    found, skipped = read(text)
    assert [each.frame for each in found] == [HEADING, HEADING]
    assert not skipped
    assert is_recording(tmp_path / "bus.log", text.encode())


@pytest.mark.parametrize("suffix", [".asc", ".trc", ".blf"])
def test_a_log_of_python_can_that_is_cut(tmp_path, suffix):
    path = tmp_path / f"bus{suffix}"
    with can.Logger(str(path)) as writer:
        for k in range(50_000 if suffix == ".blf" else 500):  # objects of .blf go by 128 KiB
            writer.on_message_received(message(HEADING, 1.7e9 + k / 100, 0))
    whole = path.read_bytes()
    skipped = Counter()
    count = len(list(recorded_frames(path, skipped)))
    assert not skipped
    path.write_bytes(whole[: len(whole) * 6 // 10])
    found = [each.frame for each in recorded_frames(path, skipped)]
    assert 0 < len(found) < count
    assert set(found) == {HEADING}
    (said,) = skipped
    assert "cut" in said


def test_the_source_in_pcdin(read):
    found, _ = read("$PCDIN,01F112,0000C72A,23,FF103BFF7FCEF5FC*00\n")
    assert found[0].frame.data == HEADING.data
    assert (pgn_of(found[0].frame.identifier), found[0].frame.identifier & 0xFF) == (127250, 0x23)


FRAMES = st.one_of(
    st.builds(Frame, st.integers(0, 0x7FF), st.binary(max_size=8)),
    st.builds(Frame, st.integers(0, 0x1FFFFFFF), st.binary(max_size=8), extended=st.just(True)),
    st.builds(
        lambda i, data, switch: Frame(i, data, True, fd=True, bit_rate_switch=switch),
        st.integers(0, 0x1FFFFFFF),
        st.sampled_from(FD_LENGTHS).flatmap(lambda n: st.binary(min_size=n, max_size=n)),
        st.booleans(),
    ),
    st.builds(
        lambda i, n: Frame(i, b"", remote=True, requested=n),
        st.integers(0, 0x7FF),
        st.integers(0, 8),
    ),
)


@pytest.mark.parametrize("suffix", [".log", ".blf", ".asc"])
@given(frames=st.lists(st.tuples(FRAMES, st.integers(0, 10**6)), min_size=1, max_size=12))
def test_what_python_can_writes(tmp_path_factory, suffix, frames):
    """Frames of CAN and CAN FD, remote ones, by the writers of python-can."""
    path = tmp_path_factory.mktemp("bus") / f"bus{suffix}"
    times, time = [], 1_700_000_000.0
    with can.Logger(str(path)) as writer:
        for frame, later in frames:
            time += later / 1e6
            times.append(time)
            writer.on_message_received(message(frame, time, "can0"))
    found = list(recorded_frames(path, Counter()))
    # python-can's text leaves out how much a remote frame requests.
    assert [each.frame for each in found] == [
        Frame(frame.identifier, remote=True) if frame.remote and suffix == ".log" else frame
        for frame, _ in frames
    ]
    for each, expected in zip(found, times, strict=True):
        assert each.time - found[0].time == pytest.approx(expected - times[0], abs=2e-6)


@given(data=st.binary(min_size=1, max_size=223), pgn=st.sampled_from([129029, 126996, 130820]))
def test_a_whole_message_is_a_fast_packet_again(tmp_path_factory, data, pgn):
    """The package nmea2000 puts together what was one line of canboat's text."""
    path = tmp_path_factory.mktemp("bus") / "bus.raw"
    listed = ",".join(f"{byte:02x}" for byte in data)
    path.write_text(f"# format=FAST\n2020-01-01T00:00:00.000Z,3,{pgn},5,255,{len(data)},{listed}\n")
    frames = [each.frame for each in recorded_frames(path, Counter(), NMEA2000Decoder.is_fast_pgn)]
    assert len(frames) == 1 + max(0, -(-(len(data) - 6) // 7))
    assert all(len(frame.data) == 8 and pgn_of(frame.identifier) == pgn for frame in frames)
    joined = frames[0].data[2:] + b"".join(frame.data[1:] for frame in frames[1:])
    assert (frames[0].data[1], joined[: len(data)]) == (len(data), data)
    assert [frame.data[0] & 0x1F for frame in frames] == list(range(len(frames)))


def test_frames_of_fast_packets_stay_as_they_are(read):
    """Canboat's text of frames: 8 bytes each, of a PGN that goes as fast packets."""
    found, _ = read(
        "2024-11-17-17:41:46.906,3,130823,27,255,8,00,df,13,99,ff,00,0f,01\n"
        "2024-11-17-17:41:46.907,3,130823,27,255,8,01,00,04,00,00,1c,42,04\n"
    )
    assert [each.frame.data[0] for each in found] == [0, 1]


def test_over_midnight_and_cut_lines(read):
    found, skipped = read(
        "23:59:59.900 R 09F11223 01\n00:00:00.100 R 09F11223 02\n"
        "2015-07-10T06:17:32.249Z,2,127250,35,255,8,ff,10\n(1436509052.2) can0 20000080#00\n"
    )
    assert found[1].time - found[0].time == pytest.approx(0.2)
    assert sum(skipped.values()) == 2


def played(path, *, steps=200, h=0.01, **parameters):
    """Return (time in s, frame) of what a player sends, and the player."""
    player = CanPlayer("boat")
    for name, value in {"file": str(path), **parameters}.items():
        player.set(name, value)
    player.setup(0.0)
    player.initialise()
    player.begin()
    inbox, sent = {}, []
    for number in range(steps):
        player.advance(number * h, h)
        for when, data in Inbox(inbox).take(player.get("tx")):
            sent += [(when / 1e9, o.frame) for o in decode(data) if isinstance(o, Transmit)]
    return sent, player


@pytest.fixture
def ten(tmp_path):
    path = tmp_path / "ten.log"
    path.write_text(
        "".join(f"({1e9 + k / 10:.6f}) can{k % 2} {k:03X}#{k:02X}\n" for k in range(10))
    )
    return path


def test_at_the_recorded_times(ten):
    sent, player = played(ten)
    assert [frame.identifier for _, frame in sent] == list(range(10))
    assert [when for when, _ in sent] == pytest.approx([k / 10 for k in range(10)], abs=1e-6)
    assert (player.get("played"), player.get("skipped")) == (10, 0)


def test_a_window_at_another_speed_of_one_bus(ten):
    sent, _ = played(ten, begin_time=0.2, end_time=0.7, speed=2.0, bus="can0", leave_out="0x004")
    assert [(when, frame.identifier) for when, frame in sent] == [
        (pytest.approx(0.0), 2), (pytest.approx(0.2), 6)
    ]  # fmt: skip


def test_again_and_again(ten):
    sent, _ = played(ten, repeat="on", steps=250)
    assert [when for when, _ in sent] == pytest.approx([k / 10 for k in range(25)], abs=1e-6)
    assert [frame.identifier for _, frame in sent] == [k % 10 for k in range(25)]


def test_a_state_goes_on_where_it_was(ten):
    def parts(steps, state=None):
        player = CanPlayer("boat")
        player.set("file", str(ten))
        player.setup(0.0)
        player.initialise()
        player.begin()
        if state is not None:
            player.set_state(state)
        for number in steps:
            player.advance(number * 0.01, 0.01)
        return player

    half = parts(range(45))
    whole, rest = parts(range(90)), parts(range(45, 90), half.get_state())
    assert rest.get("tx") == whole.get("tx")
    assert rest.get("played") == whole.get("played") == 9


@pytest.mark.parametrize(
    ("text", "parameters", "said"),
    [
        ("nothing\n", {}, "has no entry that can be played"),
        ("  can0  123   [1]  00\n", {}, "has no times: set interval"),
        ("(1.0) can0 123#00\n", {"bus": "can1"}, "has no bus 'can1', but can0"),
        ("(1.0) can0 123#00\n", {"begin_time": 5.0}, "no entry from begin_time, 5 s"),
        ("(1.0) can0 123#00\n", {"leave_out": "wind"}, "'wind' is neither an identifier"),
        (None, {}, "No such file"),
    ],
)
def test_refused_with_its_reason(tmp_path, text, parameters, said):
    path = tmp_path / "bus.log"
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError, match=said):
        played(path, **parameters)


@pytest.mark.interop
def test_a_recorded_bus_beside_a_simulated_node(tmp_path):
    """The bus that a run leaves has the recorded frames again, when they were recorded."""
    lines = "".join(
        f"2024-01-01T00:00:{k / 10:06.3f}Z,2,127250,77,255,8,ff,{k:02x},3b,ff,7f,ce,f5,fc\n"
        for k in range(100)
    )
    (tmp_path / "boat.raw").write_text(lines)
    (tmp_path / "rig.toml").write_text(
        'step = "10 ms"\n[components]\ncan = { fmu = "canbus", set = { nodes = "boat plotter" } }\n'
        'boat = { fmu = "can-player", set = { file = "boat.raw" } }\n'
        'plotter = { fmu = "nmea2000-node" }\n'
        '[connections]\n"can.n1" = "boat.bus"\n"can.n2" = "plotter.bus"\n'
    )
    (tmp_path / "trial.toml").write_text('rig = "rig.toml"\nstop = "11 s"\n')
    done = seatrial("run", "trial.toml", "--engine", "direct", "-o", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    own = [
        each
        for each in recorded_frames(tmp_path / "run/can.log", Counter())
        if each.frame.identifier & 0xFF == 77
    ]
    assert [each.frame.data[1] for each in own] == list(range(100))
    assert [each.time for each in own] == pytest.approx([k / 10 for k in range(100)], abs=2e-3)
