"""Gloria with her feed: what plotters read is where she is, and she goes where one commands."""

import csv
import math
from dataclasses import replace

import pymap3d
import pynmea2
import pytest

from seatrial.links.text import decode
from seatrial.system.files import find_file
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

pytestmark = pytest.mark.interop

PLOTTER = '''
import pynmea2

from seatrial.model.component import NS, Component, Output
from seatrial.links.text import Outbox


class Plotter(Component):
    """Commands a heading of 60 degrees every second, as text on a port."""

    discrete = True
    tx = Output("1", "bytes", type=str)

    def start(self, t):
        self._out = {}

    def step(self, t, h):
        if self.now_ns % NS == 0:
            command = pynmea2.HSC("II", "HSC", ("60.0", "T", "", "M"))
            Outbox(self._out).put(self.now_ns, f"{command}\\r\\n".encode())
        Outbox(self._out).flush()

    def outputs(self, t):
        self.tx = Outbox(self._out).text
'''
RIG = """
step = "20 ms"

[components]
vehicle   = { rig = "vehicles/gloria" }
autopilot = { rig = "feed.toml", choices = { vehicle = "gloria" } }

[connections]
"vehicle.sensors"     = "autopilot.sensors"
"autopilot.actuators" = "vehicle.actuators"
"""
TRIAL = """
rig = "rig.toml"
stop = "30 s"

[set]
"vehicle.boat.eta_start" = ["0 m", "0 m", "0 deg", "100 deg"]
"autopilot.pilot.guidance.mode" = "guided"
"autopilot.instruments.links" = ""

[record]
signals = ["vehicle.boat.position.*", "vehicle.boat.attitude.psi", "autopilot.instruments.tx"]
every = "20 ms"
"""


@pytest.mark.long
def test_what_plotters_read_and_send(tmp_path):
    feed = find_file("harness/rigs", "autopilots/nmea0183").read_text("utf-8")
    feed = feed.replace("[components]", '[components]\nplotter = { fmu = "plotter.py:Plotter" }')
    feed = feed.replace("[connections]", '[connections]\n"plotter.tx" = "instruments.rx"')
    (tmp_path / "feed.toml").write_text(feed, "utf-8")
    (tmp_path / "rig.toml").write_text(RIG, "utf-8")
    (tmp_path / "plotter.py").write_text(PLOTTER, "utf-8")
    (tmp_path / "trial.toml").write_text(TRIAL, "utf-8")
    result = run_trial(load_trial(str(tmp_path / "trial.toml")), tmp_path / "run", engine="direct")
    assert result.status == "complete", result.error

    with (result.folder / "signals.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert math.degrees(float(rows[-1]["vehicle.boat.attitude.psi"])) == pytest.approx(
        60.0, abs=5.0
    )
    counts = {"RMC": 0, "HDT": 0}
    seen = 0
    for row in rows:
        number, chunks = decode(row["autopilot.instruments.tx"])
        if number == seen:
            continue
        seen = number
        for _, data in chunks:
            sentence = pynmea2.parse(data.decode("ascii"), check=True)
            if sentence.sentence_type == "HDT" and sentence.heading is not None:
                counts["HDT"] += 1
                away = float(sentence.heading) - math.degrees(
                    float(row["vehicle.boat.attitude.psi"])
                )
                assert abs((away + 180.0) % 360.0 - 180.0) < 6.0  # the compass's own errors
            if sentence.sentence_type == "RMC" and sentence.is_valid:
                counts["RMC"] += 1
                north, east, _ = pymap3d.geodetic2ned(
                    sentence.latitude, sentence.longitude, 0.0, -22.862, -43.223, 0.0
                )
                assert abs(north - float(row["vehicle.boat.position.x"])) < 10.0
                assert abs(east - float(row["vehicle.boat.position.y"])) < 10.0
    assert counts["RMC"] >= 28
    assert counts["HDT"] >= 145


def test_the_shipped_trial_begins(tmp_path):
    trial = load_trial("gloria-nmea0183")
    trial = trial.changed(
        {"stop": "5 s", "autopilot.instruments.links": "tcpin:127.0.0.1:0"}, "test"
    )
    trial = replace(trial, file=trial.file.model_copy(update={"real_time": None}))
    result = run_trial(trial, tmp_path / "run", engine="direct")
    assert result.status == "complete", result.error
    assert [name for name, _, verdict in result.verdicts if not verdict.passed] == []
