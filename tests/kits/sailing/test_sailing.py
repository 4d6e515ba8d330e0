"""Sailing in reports."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.run import run_trial
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.in_folders import run_campaign
from seatrial_kits.campaigns.results.campaign_report import write_campaign_report
from seatrial_kits.campaigns.results.polar import PolarPoint, polar_figure, polar_point
from tests.trials.conftest import figure_below

Write = Callable[[str, str], Path]


def test_track_has_the_wind_and_the_marks(tmp_path: Path) -> None:
    trial = load_trial("gloria-triangle").changed({"stop": "2 s"}, "test")
    page = write_report(run_trial(trial, tmp_path / "out", engine="direct").folder)
    figure = figure_below(page.read_text("utf-8"), "Track from above")
    marks = {
        t["name"]: (t["y"][0], t["x"][0])
        for t in figure["data"]
        if t["name"].startswith("waypoint")
    }
    assert marks == {
        "waypoint 1": (-34.73, 196.96),
        "waypoint 2": (-69.46, 0.0),
        "waypoint 3": (0.0, 0.0),
    }
    arrow, text = figure["layout"]["annotations"]
    wind = load_run(tmp_path / "out").signals
    north, east = (wind[f"vehicle.wind.velocity.{axis}"].mean() for axis in ("north", "east"))
    # It points where the wind blows to; on paper y goes down and the tail is given.
    assert np.arctan2(-arrow["ax"], arrow["ay"]) == pytest.approx(np.arctan2(east, north))
    assert text["text"] == f"wind {np.hypot(north, east):.2g} m/s"


def campaign(write: Write, directions: list[int]) -> Path:
    listed = ", ".join(f'"{d} deg"' for d in directions)
    text = (
        f'trials = ["gloria-steady"]\n[set]\nstop = "4 s"\n"trimmer.roll_limit" = "on"\n'
        f'[grid]\n"wind.mean_direction" = [{listed}]\n'
    )
    return write("polar.toml", text)


@pytest.mark.slow
def test_campaign_over_the_wind_has_a_polar_diagram(write: Write, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    directions = [0, 30, 60, 90, 110]
    run_campaign(load_campaign(str(campaign(write, directions))), folder, engine="direct")
    figure = figure_below(write_campaign_report(folder).read_text("utf-8"), "Polar diagram")
    (line,) = figure["data"]
    assert line["name"] == "gloria-steady, stop 4 s, trimmer.roll_limit on"
    runs = [load_run(path.parent) for path in sorted(folder.glob("*/signals.csv"))]
    expected = []
    for direction, run in zip(directions, runs, strict=True):
        last = run.time >= 3.0
        speed = np.hypot(*(run.signals[f"boat.velocity.{a}"][last] for a in "uv")).mean()
        psi = np.degrees(run.signals["boat.attitude.psi"][last]).mean()
        expected.append((180.0 - abs(psi - direction), speed))
    found = list(zip(line["theta"], line["r"], strict=True))
    np.testing.assert_allclose(found, sorted(expected), atol=1e-6)


@pytest.mark.slow
def test_few_directions_are_no_polar_diagram(write: Write, tmp_path: Path) -> None:
    run_campaign(load_campaign(str(campaign(write, [0, 60]))), tmp_path / "out", engine="direct")
    assert "Polar diagram" not in write_campaign_report(tmp_path / "out").read_text("utf-8")
    point = PolarPoint("", "", 1.0, 2.0)
    assert polar_figure([point] * 10) is None


def test_runs_without_wind_have_no_point(tmp_path: Path) -> None:
    trial = load_trial("hydrone-open-landing").changed({"stop": "1 s"}, "test")
    run = load_run(run_trial(trial, tmp_path / "out", engine="direct").folder)
    assert polar_point(run, "", "") is None


@pytest.mark.parametrize("spoiled", ["velocity.u", "attitude.psi"])
def test_a_record_with_text_where_numbers_belong_has_no_point(spoiled: str, tmp_path: Path) -> None:
    trial = load_trial("gloria-steady").changed({"stop": "1 s"}, "test")
    run = load_run(run_trial(trial, tmp_path / "out", engine="direct").folder)
    assert polar_point(run, "", "") is not None
    (name, *_) = [name for name in run.signals if spoiled in name]
    run.signals[name] = ["text"] * len(run.time)
    assert polar_point(run, "", "") is None
