"""Run folders: whole ones, cut ones, and what is no run folder."""

from __future__ import annotations

import json

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.trial.records import run_folder
from seatrial.trial.records.run_folder import load_run

from .conftest import COLUMNS, reference


def edit_manifest(folder, **changes):
    path = folder / "manifest.json"
    manifest = json.loads(path.read_text("utf-8")) | changes
    path.write_text(json.dumps(manifest), "utf-8")


def test_a_run_reads_back_exactly(write_run):
    run = load_run(write_run())
    expected = reference("landing", "transversal")
    np.testing.assert_array_equal(run.time, expected.pop("time"))
    assert list(run.signals) == list(COLUMNS)
    for name, column in expected.items():
        np.testing.assert_array_equal(run.signals[name], column)
    assert run.units["hull.attitude.phi"] == "rad"
    assert (run.name, run.truncated, run.notes) == ("hydrone-landing", False, ())
    assert run.timing["steps"] == 2000
    assert [verdict["passed"] for verdict in run.verdicts] == [False, True, True]


@pytest.mark.parametrize(
    ("scenario", "changes", "passed"),
    [
        ("nominal", {}, True),
        ("transversal", {}, False),
        ("nominal", {"status": "stopped"}, None),
        ("nominal", {"criteria": []}, None),
    ],
)
def test_whether_a_run_passed(write_run, scenario, changes, passed):
    assert load_run(write_run(scenario=scenario, changes=changes)).passed is passed


def test_text_columns_stay_text(write_run):
    texts = [f'{i}:"$GPGGA",{i}\r\nnext' if i else "" for i in range(201)]
    run = load_run(write_run(extra={"gps.nmea": ("1", texts)}))
    assert run.signals["gps.nmea"] == texts
    assert run.signals["hull.position.x"].dtype == float


def test_a_run_that_failed_at_its_start_has_no_record(write_run):
    folder = write_run(changes={"status": "failed", "error": "hull: no start"})
    for name in ("signals.csv", "verdicts.json"):
        (folder / name).unlink()
    run = load_run(folder)
    assert (len(run.time), run.signals, run.passed) == (0, {}, False)
    assert run.notes == ("signals.csv is missing", "verdicts.json is missing")


def test_a_column_is_text_if_any_cell_is(write_run, monkeypatch):
    monkeypatch.setattr(run_folder, "_CHUNK_ROWS", 10)
    texts = [str(i) for i in range(150)] + ["word"] * 51
    assert load_run(write_run(extra={"a.b": ("1", texts)})).signals["a.b"] == texts


def test_long_records_are_read_in_chunks(write_run, monkeypatch):
    whole = load_run(write_run("a"))
    monkeypatch.setattr(run_folder, "_CHUNK_ROWS", 7)
    chunked = load_run(write_run("b"))
    np.testing.assert_array_equal(whole.signals["hull.rates.p"], chunked.signals["hull.rates.p"])


@pytest.mark.parametrize("kept", [-1, -5, -60])
def test_a_cut_last_line_is_dropped(write_run, kept):
    folder = write_run()
    path = folder / "signals.csv"
    path.write_bytes(path.read_bytes()[:kept])
    run = load_run(folder)
    assert run.truncated
    assert len(run.time) == 200
    assert all(len(column) == 200 for column in run.signals.values())
    assert run.notes == ("the last line of signals.csv is cut and was dropped",)


def test_a_cut_text_is_dropped(write_run):
    folder = write_run(extra={"gps.nmea": ("1", ['say "a", \n then b'] * 201)})
    path = folder / "signals.csv"
    path.write_bytes(path.read_bytes().rpartition(b"then")[0])
    run = load_run(folder)
    assert run.truncated
    assert len(run.time) == len(run.signals["gps.nmea"]) == 200


def test_a_killed_run_has_no_verdicts_and_timing(write_run):
    folder = write_run(changes={"status": "running"})
    (folder / "verdicts.json").unlink()
    (folder / "timing.json").unlink()
    run = load_run(folder)
    assert (run.verdicts, run.timing, run.passed) == ([], {}, False)
    assert run.notes == ("verdicts.json is missing", "timing.json is missing")


def test_an_empty_record(write_run):
    folder = write_run()
    path = folder / "signals.csv"
    path.write_text(path.read_text().splitlines()[0] + "\n")
    run = load_run(folder)
    assert len(run.time) == 0
    assert not run.truncated


def test_not_a_run(tmp_path, write_run):
    with pytest.raises(InputError, match=r"not a run folder: it has no manifest\.json"):
        load_run(tmp_path)
    folder = write_run()
    (folder / "signals.csv").unlink()
    with pytest.raises(InputError, match=r"has no signals\.csv"):
        load_run(folder)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"format": 2}, "format: Input should be 1, found 2"),
        ({"signals": {}}, "which manifest.json does not know"),
    ],
)
def test_a_manifest_that_does_not_fit(write_run, changes, message):
    with pytest.raises(InputError, match=message):
        load_run(write_run(changes=changes))


@pytest.mark.parametrize("text", ["{", "[]", "\udcff"])
def test_a_manifest_that_cannot_be_read(write_run, text):
    folder = write_run()
    (folder / "manifest.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(InputError, match=r"manifest\.json"):
        load_run(folder)


def test_a_manifest_that_lacks_something(write_run):
    folder = write_run()
    manifest = json.loads((folder / "manifest.json").read_text())
    del manifest["components"]
    (folder / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(InputError, match="components: this key is missing"):
        load_run(folder)


@pytest.mark.parametrize(
    ("header", "body", "message"),
    [
        ("t,a.b", "0.0,1.0\n", "the first column is not 'time'"),
        ("time,a.b,a.b", "0.0,1.0,1.0\n", "a column occurs twice"),
        ("time,a.b", "0.0\n0.1,1.0\n", "line 2: 1 values, the header has 2"),
        ("time,a.b", "zero,1.0\n", "a time is not a number"),
        ("time,a.b", '0.0,"x"y\n0.1,1\n', "line 2"),
    ],
)
def test_a_damaged_record(write_run, header, body, message):
    folder = write_run(changes={"signals": {"a.b": {"unit": "1", "description": ""}}})
    (folder / "signals.csv").write_text(f"{header}\n{body}")
    with pytest.raises(InputError, match=message):
        load_run(folder)
