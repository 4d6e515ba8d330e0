"""The shipped trials of the tether."""

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from tests.trials.test_shipped_trials import TRIALS

pytestmark = pytest.mark.interop

TETHER = [name for name in TRIALS if name.startswith("tether-")]


@pytest.mark.parametrize("name", TETHER)
def test_every_criterion_holds(name, tmp_path):
    found = load_run(run_trial(load_trial(name), tmp_path / "run", engine="direct").folder)
    assert found.verdicts
    assert [v["name"] for v in found.verdicts if not v["passed"]] == []
