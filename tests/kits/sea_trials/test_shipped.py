"""Shipped manoeuvres of shipped vehicles."""

import math

import pytest

from seatrial.shipped import shipped_folder
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.sea_trials.evaluation import figures_of
from seatrial_kits.sea_trials.orders import KINDS
from seatrial_kits.sea_trials.run_record import done_in

from .references import FIGURES

FOLDER = shipped_folder("harness") / "kits/sea_trials/trials"
TRIALS = sorted(path.stem for path in FOLDER.glob("*.toml"))


@pytest.mark.parametrize("vehicle", ["hydrone", "mariner", "otter", "videoray", "bluerov2"])
def test_the_approach_begins_with_every_pilot(vehicle, tmp_path):
    mode = "depth-hold" if vehicle in ("videoray", "bluerov2") else "stabilize"
    changes = {"choices.vehicle": vehicle, "stop": "0.5 s"}
    trial = load_trial("turning-circle", changes=changes, origin="test")
    run = load_run(run_trial(trial, tmp_path / "run", engine="direct").folder)
    assert set(run.signals["autopilot.manoeuvre.mode"]) == {mode}
    assert run.signals["autopilot.manoeuvre.speed_order"][-1] == 1.0


@pytest.mark.parametrize("trial", TRIALS)
def test_a_trial_is_the_manoeuvre_of_its_name(trial):
    kind = load_trial(trial).file.choices["manoeuvre"]
    assert trial.startswith(kind)
    assert kind in KINDS


@pytest.mark.long
@pytest.mark.interop
def test_the_mariner_turns_as_computed_elsewhere(tmp_path):
    changes = {
        "choices.vehicle": "mariner",
        "autopilot.manoeuvre.helm": "15 deg",
        "autopilot.manoeuvre.side": "port",
        "autopilot.manoeuvre.window": "20 s",
    }
    trial = load_trial("turning-circle", changes=changes, origin="test")
    folder = run_trial(trial, tmp_path / "run", engine="direct").folder
    found = figures_of(done_in(load_run(folder)))
    # The radius and the speed of the trial mariner-turning-circle.
    assert found["steady_diameter"] == pytest.approx(2.0 * 711.2, abs=0.2)
    assert found["steady_speed"] == pytest.approx(6.629, abs=1e-3)
    assert found["steady_rate"] < 0.0


@pytest.mark.long
@pytest.mark.interop
def test_the_kvlcc2_under_her_pilot_turns_as_the_reference(tmp_path):
    changes = {"choices.vehicle": "kvlcc2", "variant": "model"}
    trial = load_trial("turning-circle", changes=changes, origin="test")
    folder = run_trial(trial, tmp_path / "run", engine="direct").folder
    found = figures_of(done_in(load_run(folder)))
    expected = FIGURES["kvlcc2_l7_turn_p35"]["figures"]
    # The steering gear has a lag that the reference has not; the approach is steady to 1 %.
    for name in ("advance", "transfer", "tactical_diameter", "steady_diameter"):
        assert found[name] / 7.0 == pytest.approx(expected[name], rel=2e-3), name
    drift = math.degrees(found["steady_drift"])
    assert drift == pytest.approx(expected["steady_drift_deg"], abs=0.01)
