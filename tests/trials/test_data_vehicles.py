"""The vehicles that are data alone: every criterion of their trials is as expected."""

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import is_as_expected, load_run
from seatrial.trial.running.run import run_trial

from .test_shipped_trials import TRIALS

pytestmark = pytest.mark.interop


DATA_ALONE = ("otter", "bluerov2", "dive", "glide", "supply-ship", "wam-v")


@pytest.mark.parametrize("name", [n for n in TRIALS if n.startswith(DATA_ALONE)])
def test_every_criterion_is_as_expected(name, tmp_path):
    found = load_run(run_trial(load_trial(name), tmp_path / "run", engine="direct").folder)
    assert found.verdicts
    assert [v["name"] for v in found.verdicts if not is_as_expected(v)] == []
