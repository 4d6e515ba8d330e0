"""Logs imported as run folders: what other commands make of them, what is refused."""

import csv
import json
import math

import numpy as np
import pytest

from seatrial.trial.records.run_folder import load_run
from tests.command import seatrial
from tests.kits.logs import circle, writers

COLUMNS = "latitude=Lat,longitude=Lon,heading=HDG,helm=RUD,time=UTC"


@pytest.fixture
def turn(tmp_path):
    writers.write_csv(tmp_path / "turn.csv")
    return tmp_path


def imported(folder, *options, log="turn.csv", columns=COLUMNS):
    named = ("--columns", columns) if columns else ()
    return seatrial("import", log, "--out", "run", *named, *options, cwd=folder)


def test_a_log_of_a_ship_is_a_run(turn):
    done = imported(turn, "--vehicle", "otter", "--check", "log.HDG < 400 deg")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "PASS  log.HDG < 400 deg" in done.stdout
    run = load_run(turn / "run")
    motion = circle.circle()
    np.testing.assert_allclose(run.time, motion.time, atol=1e-3)
    np.testing.assert_allclose(run.signals["log.position.y"], motion.east, atol=0.01)
    np.testing.assert_allclose(
        np.unwrap(run.signals["log.attitude.psi"]), np.unwrap(motion.heading), atol=1e-6
    )
    assert run.units["log.RUD"] == "deg"
    assert run.manifest["components"]["log"]["outline"]["length"] > 1.0
    assert (turn / "run/report.html").stat().st_size > 10_000
    for command in (("report", "run"), ("export", "run", "--parquet"), ("export", "run", "--mcap")):
        assert seatrial(*command, cwd=turn).returncode == 0


def test_figures_of_the_import_are_those_of_the_log(turn):
    assert imported(turn).returncode == 0
    how = ("--manoeuvre", "turning-circle", "--json")
    of_log = seatrial("trials", "figures", "turn.csv", "--columns", COLUMNS, *how, cwd=turn)
    of_run = seatrial("trials", "figures", "run", *how, cwd=turn)
    one, other = (json.loads(done.stdout)["result"]["figures"] for done in (of_log, of_run))
    for name, figure in one.items():
        assert figure["value"] == pytest.approx(other[name]["value"], rel=1e-3), name


def test_a_criterion_that_fails_is_the_status(turn):
    done = imported(turn, "--check", "log.HDG > -100 deg")
    assert done.returncode == 1
    assert json.loads((turn / "run/verdicts.json").read_text())[0]["passed"] is False


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--check", "log.HDG < 1 m"), "log.HDG"),
        (("--check", "log.HDC < 1 deg"), "unknown signal 'log.HDC'"),
        (("--channels", "XYZ*"), "no column matches 'XYZ*'"),
        (("--from", "9000 s"), "no row from 9000 s"),
        (("--from", "5 m"), "--from"),
        (("--every", "0 s"), "--every: a time above 0 is needed"),
        (("--vehicle", "oter"), "oter"),
    ],
)
def test_mistakes_leave_no_folder(turn, options, said):
    done = imported(turn, *options)
    assert done.returncode == 2
    assert said in done.stderr
    assert not (turn / "run").exists()


def test_a_wrong_unit_is_named(turn):
    done = imported(turn, columns=COLUMNS.replace("heading=HDG", "heading=HDG:m"))
    assert done.returncode == 2
    assert "HDG" in done.stderr
    assert "deg, not m" in done.stderr


def test_a_log_that_is_cut_in_a_line_is_read_up_to_there(turn):
    text = (turn / "turn.csv").read_text()
    (turn / "turn.csv").write_text(text[: len(text) // 2].rsplit(";", 1)[0])
    done = imported(turn)
    assert done.returncode == 0, done.stderr
    assert "is cut, and left out" in done.stdout


def test_what_is_not_known_is_held_and_said(tmp_path):
    """Channels of different spans, one with a gap: rows at the rate of the fastest."""
    entries = [(t / 10.0, "HDT", f"{t % 360:.1f},T") for t in range(400)]
    entries += [(float(t), "DPT", f"{t:.1f},0.0") for t in (*range(5), *range(30, 36))]
    lines = [f"{1e9 + t:.3f} {checked(f'HE{kind},{rest}')}" for t, kind, rest in sorted(entries)]
    (tmp_path / "boat.nmea").write_text("\n".join(lines))
    done = imported(tmp_path, log="boat.nmea", columns="")
    assert done.returncode == 0, done.stderr
    run = load_run(tmp_path / "run")
    known = np.asarray(run.signals["log.known.DPT.depth"], bool)
    at = {round(time, 3): row for row, time in enumerate(run.time)}
    assert known[at[2.5]]
    assert not known[at[20.0]]
    assert not known[at[39.0]]
    assert run.signals["log.DPT.depth"][at[20.0]] == 4.0
    assert run.signals["log.DPT.depth"][at[2.5]] == pytest.approx(2.5, abs=1e-5)
    assert "not known, with the nearest earlier value: DPT.depth in 7" in done.stdout


def checked(body):
    value = 0
    for character in body:
        value ^= ord(character)
    return f"${body}*{value:02X}"


def test_a_clock_that_was_set_is_said(tmp_path):
    rows = [(t if t < 50 else t - 3000.0, math.sin(t / 10.0)) for t in range(100)]
    with (tmp_path / "boat.csv").open("w", newline="") as file:
        csv.writer(file).writerows([("time", "heading"), *rows])
    done = imported(tmp_path, log="boat.csv", columns="heading=heading:rad")
    assert done.returncode == 0, done.stderr
    assert "the clock was set once, the first before line 52, by -3000 s" in done.stdout
    assert load_run(tmp_path / "run").time.tolist() == [float(t) for t in range(100)]


@pytest.mark.parametrize("other", ["turn.csv", "run"])
def test_a_run_compared_with_its_log(turn, other):
    assert imported(turn).returncode == 0
    columns = ("--columns", COLUMNS) if other == "turn.csv" else ("--match", "log.HDG=log.HDG")
    done = seatrial("compare", "run", other, *columns, "--json", cwd=turn)
    assert done.returncode == 0, done.stderr
    signals = json.loads(done.stdout)["result"]["signals"]
    assert signals
    assert all(abs(each["worst"]) < 1e-6 for each in signals)


def test_nothing_in_common_is_said(turn, tmp_path):
    assert imported(turn).returncode == 0
    (tmp_path / "other.csv").write_text("time,x\n0,1\n1,2\n")
    done = seatrial("compare", "run", "other.csv", cwd=turn)
    assert done.returncode == 2
    assert "name pairs: --match SIGNAL=CHANNEL:UNIT" in done.stderr
    done = seatrial("compare", "run", "other.csv", "--match", "log.HDG=x:m", cwd=turn)
    assert done.returncode == 2
    assert "unit 'm' cannot be converted to 'deg'" in done.stderr


def test_what_is_not_known_is_not_compared(tmp_path):
    """Fixes from 0.4 s on, a gap of 20 s in them, rows each half second: the log is the run."""
    writers.write_candump(tmp_path / "all.log")
    lines = (tmp_path / "all.log").read_text().splitlines()
    begun = float(lines[0].split()[0].strip("()"))
    fixes = [line for line in lines if "#" in line and " 09F801" in line]
    gone = {line for line in fixes if 100.0 < float(line.split()[0].strip("()")) - begun < 120.0}
    (tmp_path / "boat.log").write_text("".join(f"{each}\n" for each in lines if each not in gone))
    done = seatrial("import", "boat.log", "--out", "boat", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = seatrial("compare", "boat", "boat.log", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = {each["signal"]: each for each in json.loads(done.stdout)["result"]["signals"]}
    for axis in "xy":
        assert found[f"log.position.{axis}"]["rms"] < 0.02
    done = seatrial("trials", "figures", "boat", "--manoeuvre", "turning-circle", cwd=tmp_path)
    assert done.returncode == 2
    assert "a gap from" in done.stderr


def test_a_heading_in_degrees_that_is_said_to_be_in_radians(tmp_path):
    rows = "".join(f"{k / 10},0,0,{k * 5 % 360}\n" for k in range(100))
    (tmp_path / "boat.csv").write_text(f"time,north [m],east [m],heading [rad]\n{rows}")
    done = seatrial("import", "boat.csv", cwd=tmp_path)
    assert done.returncode == 2
    assert "line 74, column 'heading': heading goes from 355 rad to 0 rad" in done.stderr
    assert "is it in degrees?" in done.stderr


def test_columns_of_several_rates_in_one_table(tmp_path):
    """Fixes each second and headings each 0.2 s, with empty cells between the fixes."""
    rows = [(k / 5, f"{k / 5:g}" if k % 5 == 0 else "", 2 * k) for k in range(101)]
    text = "".join(f"{t},{north},{north and 0},{psi}\n" for t, north, psi in rows)
    (tmp_path / "boat.csv").write_text(f"time,north [m],east [m],heading [deg]\n{text}")
    done = seatrial("import", "boat.csv", "-o", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    run = load_run(tmp_path / "run")
    np.testing.assert_allclose(run.signals["log.position.x"], run.time, atol=1e-9)
