"""Logs report how far they have been read, and a channel takes few bytes an entry."""

from __future__ import annotations

import tracemalloc

import pytest

from seatrial.trial.logs.channels import Samples
from seatrial.trial.logs.formats import read_log
from seatrial.trial.logs.reading_progress import told
from seatrial_kits.logs.reading import reading
from tests.kit import needs_kits
from tests.kits.logs import circle
from tests.kits.logs.test_mutated_logs import TIME, WRITERS


def shares_of(path, format_name):
    shares = []
    with told(shares.append):
        read_log(path, format_name, TIME.get(format_name))
    return shares


@pytest.mark.slow
@needs_kits("logs", "mavlink", "nmea")
@pytest.mark.parametrize("name", ["csv", "nmea0183", "nmea2000", "tlog", "mcap", "rosbag2"])
def test_a_log_says_how_far_it_is_read(tmp_path, monkeypatch, name):
    monkeypatch.setattr(circle, "END_S", 400.0)
    monkeypatch.setattr("seatrial.trial.logs.reading_progress._BLOCK", 1024)
    monkeypatch.setattr("seatrial_kits.mavlink.logs.tlog_format._TOLD_EVERY", 100)
    path = tmp_path / "log"
    WRITERS[name](path)
    shares = shares_of(path, name)
    assert len(shares) > 3
    assert shares == sorted(shares)
    assert 0.0 < shares[0] < 0.5
    assert 0.9 < shares[-1] <= 1.0


def test_the_share_is_shown(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("seatrial.cli.watch.PERIOD", 0.0)
    monkeypatch.setattr("seatrial.trial.logs.reading_progress._BLOCK", 1024)
    path = tmp_path / "boat.csv"
    path.write_text("time,x\n" + "".join(f"{k},{k}\n" for k in range(1000)))
    with reading(path):
        read_log(path, "csv")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith("reading boat.csv: ")
    assert lines[-1] == "reading boat.csv: 100 %, read"


def test_an_entry_of_a_channel_takes_24_bytes():
    count, samples = 100_000, Samples()
    tracemalloc.start()
    for k in range(count):
        samples.add("x", "m", k / 7.0, k / 3.0, k)
    held, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # Arrays grow by an eighth at a time (CPython's list and array).
    assert held < 24 * count * 1.125 + 10_000
