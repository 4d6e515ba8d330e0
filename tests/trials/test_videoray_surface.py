"""The shipped trials of the VideoRay's control: verdicts, campaigns, figures of its page."""

import json

import numpy as np
import pytest

from seatrial.trials.campaign import load_campaign, run_campaign
from seatrial.trials.run import run_trial
from seatrial.trials.run_folder import load_run
from seatrial.trials.trial import load_trial
from tests.control.vessel_loop import table

from .test_shipped_trials import TRIALS

pytestmark = pytest.mark.interop

# Without integral action, and with the source's law, a load is not rejected: that they show.
FAILING = {"videoray-surface-step-p", "videoray-surface-step-flat"}
HOLDING = [n for n in TRIALS if n.startswith(("videoray-surface", "videoray-hold"))]


def run(name, folder, **settings):
    trial = load_trial(name).changed(settings, "test")
    return load_run(run_trial(trial, folder, engine="direct").folder)


@pytest.mark.parametrize("name", HOLDING)
def test_every_criterion_holds(name, tmp_path):
    found = run(name, tmp_path / "run")
    assert found.verdicts
    assert all(v["passed"] for v in found.verdicts) == (name not in FAILING)


@pytest.mark.parametrize("variant", ["physical", "table75"])
@pytest.mark.parametrize("case", [1, 2])
def test_the_coupled_rig_follows_the_reference(case, variant, tmp_path):
    expected = table(f"pi_case{case}_{variant.replace('table75', 'tab7.5')}")
    found = run(
        f"videoray-surface-case-{case}",
        tmp_path / "run",
        variant=variant,
        stop="240 s",
        **{"vessel.nu_start": [float(expected[x][0]) for x in "uvr"]},
    )
    signals = {x: f"vessel.nu.{x}" for x in "uvr"} | {
        f"tau{i}": f"law.command.t{i}" for i in (1, 2)
    }
    for column, signal in signals.items():
        error = np.abs(found.signals[signal][::10] - expected[column]).max()
        # Start values have 8 digits in the reference.
        assert error < 1e-6 * np.abs(expected[column]).max(), signal


@pytest.mark.parametrize(
    ("campaign", "passing"),
    [
        ("rejection", 3),
        pytest.param("rejection-table75", 3, marks=pytest.mark.long),
        pytest.param("rejection-table81", 4, marks=pytest.mark.long),
    ],
)
def test_campaigns_cover_the_table_of_rejections(campaign, passing, tmp_path):
    run_campaign(load_campaign(f"videoray-surface-{campaign}"), tmp_path / "out", engine="direct")
    cases = json.loads((tmp_path / "out/campaign.json").read_text())["cases"]
    assert [case["trial"] for case in cases[12:]] == 6 * ["videoray-surface-step"]
    runs = [load_run(tmp_path / "out" / case["folder"]) for case in cases[12:]]
    assert sum(all(v["passed"] for v in found.verdicts) for found in runs) == passing


@pytest.mark.long
def test_heading_is_held_up_to_the_munk_limit(tmp_path):
    """What docs/vehicles/videoray-control.md says of it."""
    found = run("videoray-hold-pull", tmp_path / "run")
    late = (found.time > 80) & (found.time < 110)  # under way, before the tether pulls
    off = found.signals["vehicle.hull.attitude.psi"][late] + np.radians(170)
    assert found.signals["vehicle.hull.velocity.u"][late].mean() == pytest.approx(0.30, abs=0.01)
    assert np.degrees(np.abs(off).max()) < 0.5
