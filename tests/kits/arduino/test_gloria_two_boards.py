"""Gloria by her two boards and under a lookout, to the end: criteria, both back ends, both engines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import Run, load_run
from seatrial.trial.running.run import run_trial
from tests.kits.arduino.bench import need

WHOLE = (
    "gloria-lookout",
    "gloria-two-boards",
    "gloria-two-boards-network",
    "gloria-two-boards-battery",
)
SIMAVR = {f"autopilot.{board}.backend": "simavr" for board in ("mega", "uno")}


def done(name: str, folder: Path, **changes: str) -> Run:
    """Run a trial with changes in process."""
    trial = load_trial(name).changed(changes, "test")
    return load_run(run_trial(trial, folder / "run", engine="direct").folder)


@pytest.mark.long
@pytest.mark.parametrize("name", WHOLE)
def test_it_does_what_its_criteria_say(name: str, tmp_path: Path) -> None:
    need("host")
    assert done(name, tmp_path).passed


@pytest.mark.interop
def test_a_motor_with_too_small_a_gear_loses_steps(tmp_path: Path) -> None:
    assert done("gloria-stepper-stall", tmp_path).passed


@pytest.mark.long
@pytest.mark.interop
@pytest.mark.parametrize("backend", ["host", "simavr"])
def test_the_boat_gets_its_marks_and_sails(backend: str, tmp_path: Path) -> None:
    """As far as the first minute: from power to a connection, marks, and reports."""
    need(backend)
    changes = SIMAVR if backend == "simavr" else {}
    run = done("gloria-two-boards", tmp_path, stop="40 s", **changes)
    signals = run.signals
    assert signals["shore.held"][-1] == 2
    assert signals["shore.reports"][-1] >= 5
    assert signals["shore.bad"][-1] == 0
    assert signals["vehicle.boat.nu.u"][-1] > 0.8
    # What the motor was sent is where the sail is, but for a step's way at 45 deg/s and its lag.
    counted = np.pi / 2 + signals["autopilot.mega.steps.m1"] * 2 * np.pi / (400 * 20)
    assert (
        np.abs(counted - signals["vehicle.servos.sail.angle"]).max() < np.radians(45) * 0.02 + 1e-3
    )


@pytest.mark.interop
def test_a_pack_loses_what_its_loads_draw(tmp_path: Path) -> None:
    """Charge taken from the pack is the time integral of what its loads draw."""
    need("host")
    run = done("gloria-two-boards", tmp_path, stop="20 s")
    for pack in ("sailing_pack", "talking_pack"):
        current = run.signals[f"{pack}.current"]
        taken = (run.signals[f"{pack}.charge"][0] - run.signals[f"{pack}.charge"][-1]) * 5 * 3600
        assert taken == pytest.approx(np.trapezoid(current, run.time), rel=0.05)


@pytest.mark.long
def test_both_back_ends_sail_alike(tmp_path: Path) -> None:
    need("simavr")
    assert done("gloria-two-boards", tmp_path, **SIMAVR).passed
