"""MAVSDK as a reference tool: a dive of the VideoRay with each kind of autopilot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from .mavsdk_dive import COURSE
from .mavsdk_process import flown


@pytest.mark.parametrize("dialect", ["ardupilotmega", "px4"])
def test_a_dive(dialect: str, tmp_path: Path, subtests: pytest.Subtests) -> None:
    run, received = flown("mavsdk_dive", "videoray-mission", dialect, tmp_path)
    x, y, z = (run.signals[f"vehicle.hull.position.{axis}"] for axis in "xyz")

    def stage(name: str, tail_s: float = np.inf) -> slice:
        began, ended = received["marks"][name]
        first, last = np.searchsorted(run.time, [max(began, ended - tail_s), ended])
        return slice(int(first), int(last))

    with subtests.test("mission"):
        rows = stage("mission")
        for north, east, down in COURSE:
            away = np.hypot(x[rows] - north, y[rows] - east)
            assert away.min() <= 0.6
            assert z[rows][away.argmin()] == pytest.approx(down, abs=0.5)
    with subtests.test("surface"):
        assert set(run.signals["autopilot.mavlink.mode"][stage("surface")][3:-1]) == {"surface"}
        assert z[stage("surface")][-1] < 0.5
    if dialect == "px4":
        with subtests.test("goto"):
            assert z[stage("goto")][-1] == pytest.approx(1.0, abs=0.15)
            assert np.hypot(x[stage("goto")][-1] - 2.0, y[stage("goto")][-1] - 2.0) < 0.6
        with subtests.test("turn"):
            turn = stage("turn", 5.0)
            assert np.degrees(run.signals["vehicle.hull.rates.r"][turn]).mean() == pytest.approx(
                5, abs=1
            )
            assert run.signals["vehicle.hull.velocity.u"][turn].mean() == pytest.approx(
                0.2, abs=0.05
            )
            sinking = np.polyfit(run.time[turn], z[turn], 1)[0]
            assert sinking == pytest.approx(0.05, abs=0.02)
