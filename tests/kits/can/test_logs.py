"""Logs and statistics, read back with python-can."""

import json
from statistics import fmean

import can
import pytest

from seatrial.errors import SimulationError
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.messages import frame_of
from seatrial_kits.can.operations import Error
from seatrial_kits.can.run_log import BusLog

from .scripted import MS, Scripted, bus

FRAMES = [
    Frame(0x7FF, b"\x01\x02\x03"),
    Frame(0x1FFFFFFF, bytes(range(8)), extended=True),
    Frame(0),
    Frame(0x321, remote=True, requested=5),
    Frame(0x18EAFFFE, extended=True, remote=True),
    Frame(0x123, bytes(range(12)), fd=True),
    Frame(0x123, bytes(range(64)), True, fd=True, bit_rate_switch=True),
    Frame(0x124, b"", fd=True, bit_rate_switch=True, error_state=True),
]
TIMES = [
    1,
    999,
    131_000,
    1_000_000_007,
    86_400_000_000_123,
    10**15 + 1,
    10**15 + 2,
    10**15 + 131_003,
]
"""ns; the last ones after eleven days."""


def read(path):
    with can.LogReader(str(path)) as reader:
        return list(reader)


@pytest.fixture
def written(tmp_path):
    log = BusLog(tmp_path, "can")
    for time, frame in zip(TIMES, FRAMES, strict=True):
        log.frame(time, frame)
    log.error(TIMES[-1] + 7, Error.ACK)
    log.close()
    return tmp_path


def test_the_binary_log_comes_back_whole(written):
    *found, error = read(written / "can.blf")
    assert [frame_of(each) for each in found] == FRAMES
    assert [round(each.timestamp * 1e9) for each in found[:5]] == TIMES[:5]
    # A double of seconds tells nanoseconds apart up to 2^53 / 2 of them.
    assert [each.timestamp for each in found] == pytest.approx([t / 1e9 for t in TIMES], rel=2e-16)
    assert error.is_error_frame
    assert error.arbitration_id == 0xA0  # linux/can/error.h: no acknowledgement, bus error
    assert bytes(error.data) == bytes((0, 0, 0, 0x19, 0, 0, 0, 0))


def test_what_the_text_log_keeps_and_loses(written):
    """As candump -L has them, the class of errors too; times to the microsecond."""
    lines = (written / "can.log").read_text().splitlines()
    assert lines[:5] == [
        "(0.000000) can 7FF#010203",
        "(0.000001) can 1FFFFFFF#0001020304050607",
        "(0.000131) can 000#",
        "(1.000000) can 321#R5",
        "(86400.000000) can 18EAFFFE#R",
    ]
    assert lines[-2:] == [
        "(1000000.000131) can 124##3",
        "(1000000.000131) can 200000A0#0000001900000000",
    ]
    *found, error = read(written / "can.log")
    assert [frame_of(each) for each in found] == FRAMES
    assert [each.timestamp for each in found] == pytest.approx([t / 1e9 for t in TIMES], abs=6e-7)
    assert error.is_error_frame
    assert {each.channel for each in found} == {"can"}


def test_files_that_are_there_stay(tmp_path):
    (tmp_path / "can.log").write_text("mine")
    with pytest.raises(SimulationError, match=r"can\.log: File exists"):
        BusLog(tmp_path, "can")
    assert (tmp_path / "can.log").read_text() == "mine"


def run(folder, seed=1.0):
    folder.mkdir()
    made = bus(bit_error_rate=1e-3, seed=seed, watched="0x100")
    made.set("run_folder", str(folder))
    requested = [(n * 700_000, n % 3, Frame(0x100 + n % 2, bytes([n % 256]))) for n in range(400)]
    scripted = Scripted(made, requested)
    scripted.run(300 * MS, 10 * MS)
    made.close()
    made.close()  # harmless
    return made, scripted


def test_a_run_leaves_the_same_bytes_for_the_same_seed(tmp_path):
    made, _ = run(tmp_path / "one")
    run(tmp_path / "again")
    run(tmp_path / "other", seed=2.0)
    for name in ("can.blf", "can.log", "can.json"):
        one, again, other = (
            (tmp_path / folder / name).read_bytes() for folder in ("one", "again", "other")
        )
        assert one == again
        assert one != other
    found = read(tmp_path / "one" / "can.blf")
    assert sum(not each.is_error_frame for each in found) == made.get("frames") == 400
    assert sum(each.is_error_frame for each in found) == made.get("error_frames") > 10


def test_statistics_are_those_of_the_log(tmp_path):
    """Latencies: from the request of the frame to the log's time, rounded up to us."""
    made, _ = run(tmp_path / "one")
    found = json.loads((tmp_path / "one" / "can.json").read_text())
    entries = [each for each in read(tmp_path / "one" / "can.blf") if not each.is_error_frame]
    assert found["frames"] == 400
    assert sum(found["error_frames"].values()) == made.get("error_frames")
    assert found["duration_s"] == 0.29  # the bus has lived until the beginning of the last step
    busy = made._bus.busy_ps / 1e12
    assert found["load"] == pytest.approx(busy / 0.29, abs=1e-9)
    for row in found["identifiers"]:
        number = int(row["identifier"], 16)
        ended = [each.timestamp for each in entries if each.arbitration_id == number]
        requested = [n * 0.7e-3 for n in range(400) if 0x100 + n % 2 == number]
        late = sorted(end - begin for end, begin in zip(ended, requested, strict=True))
        assert row["frames"] == len(late)
        assert row["rate_hz"] == pytest.approx(len(late) / 0.29, rel=1e-6)
        latency = row["latency_s"]
        assert latency["max"] == pytest.approx(late[-1], abs=1.1e-6)
        assert latency["mean"] == pytest.approx(fmean(late), abs=1.1e-6)
        for percent in (50, 95, 99):
            rank = late[-(-percent * len(late) // 100) - 1]
            assert latency[f"p{percent}"] == pytest.approx(rank, abs=1.1e-6)
    assert [node["name"] for node in found["nodes"]] == ["a", "b", "c"]
    assert [node["sent"] for node in found["nodes"]] == list(made.get("sent")[:3])


def test_without_a_folder_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = bus()
    Scripted(made, [(0, 0, Frame(0))]).run(5 * MS, MS)
    made.close()
    assert list(tmp_path.iterdir()) == []
