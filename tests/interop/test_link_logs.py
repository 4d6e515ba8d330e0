"""A run's telemetry log and MCAP file, read by other people's tools, against its record."""

from __future__ import annotations

import csv
import io
import json
import math
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pymap3d
import pytest
from mcap.reader import make_reader
from pymavlink import mavutil

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import Run, load_run
from seatrial.trial.running.run import run_trial
from tests.command import SEATRIAL

from .running import free_port

# Set off by a current and heeled by a load, so that all of its coordinates move.
TRIAL = """
rig  = "sil"
choices = {{ autopilot = "mavlink" }}
stop = "10 s"
[set]
"vehicle.hull.current" = ["0.4 m/s", "-0.3 m/s", "0 m/s"]
"autopilot.mavlink.links" = "udpout:127.0.0.1:{port}"
[[events]]
at = "3 s"
set = {{ "vehicle.hull.moment_2.x" = "20 N.m" }}
[record]
signals = ["vehicle.hull.*", "vehicle.gnss.*"]
"""
CENTIMETRE = 0.0112
"""1e-7 degrees of latitude, m."""
SINGLE = 2.0**-23
"""Relative resolution of a number of 32 bits."""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("logs")
    (folder / "drift.toml").write_text(TRIAL.format(port=free_port()))
    result = run_trial(load_trial(str(folder / "drift.toml")), folder / "run", engine="direct")
    assert result.status == "complete"
    return load_run(result.folder)


@pytest.fixture(scope="module")
def origin(run: Run) -> tuple[float, float, float]:
    """Return latitude and longitude, degrees, and altitude of the run's origin."""
    given = run.manifest["components"]["autopilot.mavlink"]["parameters"]
    latitude, longitude = (given[n]["value"] for n in ("latitude", "longitude"))
    return math.degrees(latitude), math.degrees(longitude), given["altitude"]["value"]


def at(run: Run, name: str, seconds: float) -> float:
    """Return a recorded value at an instant."""
    row = int(np.searchsorted(run.time, seconds - 1e-6))
    assert run.time[row] == pytest.approx(seconds, abs=1e-6)
    return float(run.signals[name][row])


def tool(name: str, *arguments: str) -> str:
    """Return what one of pymavlink's tools prints."""
    done = subprocess.run(
        [sys.executable, str(Path(sys.executable).with_name(name)), *arguments],
        env={**os.environ, "TZ": "UTC"}, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def north_east(latitude: float, longitude: float, origin: tuple[float, float, float]) -> np.ndarray:
    east, north, _ = pymap3d.geodetic2enu(latitude, longitude, origin[2], *origin)
    return np.array([north, east])


def compare(run: Run, m: dict[str, float], now: float, origin: tuple[float, float, float]) -> None:
    """Compare a SIM_STATE, the truth, with the record."""
    position = [at(run, f"vehicle.hull.position.{axis}", now) for axis in "xyz"]
    found = north_east(m["lat_int"] * 1e-7, m["lon_int"] * 1e-7, origin)
    assert found == pytest.approx(position[:2], abs=CENTIMETRE)
    assert m["alt"] == pytest.approx(origin[2] - position[2], abs=1e-6)
    for field, axis in (("roll", "phi"), ("pitch", "theta"), ("yaw", "psi")):
        truth = at(run, f"vehicle.hull.attitude.{axis}", now)
        assert m[field] == pytest.approx(truth, rel=SINGLE, abs=1e-12)
    for field, axis in (("xgyro", "p"), ("ygyro", "q"), ("zgyro", "r")):
        assert m[field] == pytest.approx(
            at(run, f"vehicle.hull.rates.{axis}", now), rel=SINGLE, abs=1e-12
        )


def test_it_moves(run: Run) -> None:
    for name in ("vehicle.hull.position.x", "vehicle.hull.position.y", "vehicle.hull.attitude.phi"):
        assert np.ptp(run.signals[name]) > 0.1


def test_pymavlink_reads_the_trajectory(run: Run, origin: tuple[float, float, float]) -> None:
    reader = mavutil.mavlink_connection(str(run.folder / "autopilot.mavlink.tlog"), dialect="all")
    begun, kinds, truths, estimates = None, set(), 0, 0
    while (m := reader.recv_match()) is not None:
        kinds.add(m.get_type())
        begun = m._timestamp if begun is None else begun
        now = m._timestamp - begun
        if m.get_type() == "SIM_STATE":
            compare(run, m.to_dict(), round(now, 3), origin)
            truths += 1
        elif m.get_type() == "LOCAL_POSITION_NED":
            assert m.time_boot_ms == round(now * 1e3)
            wanted = [
                at(run, f"vehicle.gnss.position_n.{axis}", now)
                for axis in ("north", "east", "down")
            ]
            assert [m.x, m.y, m.z] == pytest.approx(wanted, rel=SINGLE, abs=1e-12)
            estimates += 1
    reader.close()
    assert "BAD_DATA" not in kinds
    assert truths == 40  # each 0.25 s of 10 s
    assert estimates > 40


def test_mavlogdump_reads_the_trajectory(run: Run, origin: tuple[float, float, float]) -> None:
    log = str(run.folder / "autopilot.mavlink.tlog")
    table = tool("mavlogdump.py", "--types", "SIM_STATE", "--format", "csv", log)
    rows = list(csv.DictReader(io.StringIO(table)))
    begun = float(rows[0]["timestamp"])
    assert len(rows) == 40
    for row in rows:
        values = {name.removeprefix("SIM_STATE."): float(cell) for name, cell in row.items()}
        # It writes the numbers of 32 bits with as many digits as they have.
        compare(run, values, round(values["timestamp"] - begun, 3), origin)


def test_mavtogpx_draws_the_track(run: Run, origin: tuple[float, float, float]) -> None:
    log = run.folder / "autopilot.mavlink.tlog"
    tool("mavtogpx.py", "--type", "GLOBAL_POSITION_INT", "--", str(log))
    gpx = ElementTree.parse(f"{log}.gpx").getroot()
    space = {"g": "http://www.topografix.com/GPX/1/0"}
    points = gpx.findall(".//g:trkpt", space)
    Path(f"{log}.gpx").unlink()
    assert len(points) > 40
    drift = [run.signals[f"vehicle.gnss.position_n.{axis}"] for axis in ("north", "east")]
    for point in points:
        place = north_east(float(point.get("lat", "")), float(point.get("lon", "")), origin)
        off = np.hypot(drift[0] - place[0], drift[1] - place[1])
        assert off.min() < 2 * CENTIMETRE


def test_the_mcap_file_has_the_trajectory(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "run.mcap"
    subprocess.run(
        [SEATRIAL, "export", str(run.folder), "--mcap", "--out", str(out)], check=True, timeout=120
    )
    rows = 0
    with out.open("rb") as file:
        for _, _, message in make_reader(file).iter_messages(topics="/vehicle.hull"):
            now, got = message.log_time / 1e9, json.loads(message.data)
            assert [got["position"][axis] for axis in "xyz"] == [
                at(run, f"vehicle.hull.position.{axis}", now) for axis in "xyz"
            ]
            rows += 1
    assert rows == len(run.time) == 1001
