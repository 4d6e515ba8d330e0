"""Loops closed over the bus, against the same loops without one."""

import csv
import math
import sys

import numpy as np
import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(sys.platform == "win32", reason="the gateway's tests are POSIX's"),
]

TRIAL = """
rig  = "{rig}"
stop = "{stop} s"

[record]
signals = ["ship.*", "machine.angle", "pilot.bus_heading", "pilot.bus_rudder", "can.load"]
every   = "500 ms"

[[events]]
at  = "{at} s"
set = {{ "{port}" = "{command}" }}
"""


def run(folder, name, text):
    (folder / f"{name}.toml").write_text(text, "utf-8")
    result = run_trial(load_trial(str(folder / f"{name}.toml")), folder / name, engine="direct")
    assert result.status == "complete", result.error
    with (result.folder / "signals.csv").open() as file:
        rows = list(csv.reader(file))
    columns = np.array([[float(x) for x in row] for row in rows[1:]]).T
    return dict(zip(rows[0], columns, strict=True))


def compared(folder, stop, at):
    """Return runs of the Mariner with and without a bus, on the same course change."""
    with_bus = TRIAL.format(
        rig="mariner-nmea2000", port="plotter.heading_to_steer", stop=stop, at=at, command="60 deg"
    )
    without = TRIAL.format(
        rig="mariner", port="reference.target", stop=stop, at=at, command="60 deg"
    ).replace(', "pilot.bus_heading", "pilot.bus_rudder", "can.load"', "")
    return run(folder, "with", with_bus), run(folder, "without", without)


LATEST_S = 0.25 + 0.15 + 0.1 + 0.15 + 0.1 + 0.15
"""Command, heading and rudder order each wait for an interval of theirs, and three steps on the way."""


def check(one, other):
    """The ship does what it does without a bus, later: by at most the delays of the messages."""
    for name, tolerance in (("ship.attitude.psi", math.radians(0.1)), ("ship.rates.r", 3e-4)):
        rate = np.max(np.abs(np.gradient(other[name], other["time"])))
        difference = np.max(np.abs(one[name] - other[name]))
        assert difference <= LATEST_S * rate + tolerance, name
    assert np.max(np.abs(one["ship.attitude.psi"])) > 0.01
    assert np.all(one["can.load"][4:] < 0.2)


def test_a_chart_plotter_turns_the_ship_as_without_a_bus(tmp_path):
    one, other = compared(tmp_path, 40, 5)
    check(one, other)
    # What the pilot receives is what the plant does, an interval and three steps before.
    late = np.interp(one["time"] - 0.15, one["time"], one["ship.attitude.psi"])
    received = np.remainder(one["pilot.bus_heading"] + math.pi, math.tau) - math.pi
    assert np.max(np.abs(received[4:] - late[4:])) < 1e-4 + 0.15 * np.max(
        np.abs(one["ship.rates.r"])
    )
    rudder = np.interp(one["time"] - 0.15, one["time"], one["machine.angle"])
    assert np.max(np.abs(one["pilot.bus_rudder"] - rudder)[4:]) < 1e-4 + 0.15 * 0.0873


@pytest.mark.long
def test_the_whole_change_of_course_as_without_a_bus(tmp_path):
    check(*compared(tmp_path, 600, 100))


@pytest.mark.long
@pytest.mark.parametrize("name", ["mariner-chart-plotter", "hydrone-nmea2000-square"])
def test_shipped_trials_hold(name, tmp_path):
    result = run_trial(load_trial(name), tmp_path / "run", engine="direct")
    assert result.status == "complete", result.error
    assert [name for name, _, verdict in result.verdicts if not verdict.passed] == []


def test_the_catamaran_goes_by_what_it_receives(tmp_path):
    """As long as its bus works; guidance stops without a heading."""
    trial = load_trial("hydrone-nmea2000-square").changed(
        {"stop": "9 s", "autopilot.network.heading_sensor.silent": True}, "test"
    )
    silent = run_trial(trial, tmp_path / "silent", engine="direct")
    trial = load_trial("hydrone-nmea2000-square").changed({"stop": "9 s"}, "test")
    result = run_trial(trial, tmp_path / "run", engine="direct")
    distances = []
    for each in (silent, result):
        assert each.status == "complete", each.error
        with (each.folder / "signals.csv").open() as file:
            rows = list(csv.DictReader(file))
        distances.append(float(rows[-1]["vehicle.hull.position.x"]))
        assert 3.49 < float(rows[-1]["autopilot.network.plotter.bus_depth"]) < 3.51
    assert abs(distances[0]) < 0.1
    assert distances[1] > 2.0
    assert float(rows[-1]["autopilot.network.plotter.bus_engine_speed.e1"]) > 50.0
    assert abs(float(rows[-1]["autopilot.network.node.bus_position_n.north"]) - distances[1]) < 1.0
