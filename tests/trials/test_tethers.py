"""Tethers in reports."""

from __future__ import annotations

import numpy as np
import pytest

from seatrial.trial.reports.report import write_report
from seatrial.trial.reports.tethers import shape_figure
from tests.trials.conftest import figure_below

TIME = np.array([0.0, 1.0, 2.0])


def test_from_the_side_is_the_plane_of_the_ends_at_the_end() -> None:
    """Ends 3 north, 4 east apart: a station half way is 2.5 m along, whatever lies across."""
    north = np.array([[1.0, 1.0, 1.0], [9.0, 9.0, 2.5], [9.0, 9.0, 4.0]])
    east = np.array([[1.0, 1.0, 1.0], [9.0, 9.0, 3.0], [9.0, 9.0, 5.0]])
    down = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    figure = shape_figure(TIME, north, east, down)
    side, above = (
        [t for t in figure.data if t["name"] == "2 s" and t["xaxis"] == axis]
        for axis in ("x", "x2")
    )
    assert side[0]["x"] == pytest.approx([0.0, 2.5, 5.0])
    assert side[0]["y"] == pytest.approx([0.0, 3.0, 6.0])
    assert (list(above[0]["x"]), list(above[0]["y"])) == ([1.0, 3.0, 5.0], [1.0, 2.5, 4.0])
    assert figure.layout["yaxis"]["autorange"] == "reversed"
    assert [t["name"] for t in figure.data if t["xaxis"] == "x"] == ["0 s", "1 s", "2 s"]


def test_a_tether_that_hangs_straight_down_is_drawn() -> None:
    still = np.zeros((3, 3))
    figure = shape_figure(TIME, still, still, np.outer([0.0, 1.0, 2.0], np.ones(3)))
    assert all(np.isfinite(np.array(t["x"], dtype=float)).all() for t in figure.data)


@pytest.mark.parametrize("recorded", [True, False])
def test_a_report_shows_it_if_all_of_it_was_recorded(recorded: bool, write_run) -> None:
    ports = ("north", "east", "down") if recorded else ("north", "east")
    names = [f"cable.{port}.s{n}" for port in ports for n in range(3)]
    views = {"line": {"north": "north", "east": "east", "down": "down"}}
    cable = {"fmu": "x.fmu", "sha256": "4" * 64, "step": 0.01, "parameters": {}, "views": views}
    folder = write_run(
        changes={
            "components": {"cable": cable},
            "connections": [],
            "signals": {name: {"unit": "m", "description": ""} for name in names},
            "criteria": [],
        }
    )
    values = ",".join(str(float(n % 3)) for n in range(len(names)))
    (folder / "signals.csv").write_text(f"time,{','.join(names)}\n0,{values}\n1,{values}\n")
    (folder / "verdicts.json").write_text("[]")
    page = write_report(folder).read_text("utf-8")
    assert ("Shape of cable" in page) is recorded
    if recorded:
        assert {t["name"] for t in figure_below(page, "Shape of cable")["data"]} == {"0 s", "1 s"}
