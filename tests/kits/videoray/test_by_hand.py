"""Ten minutes of keys in seatrial drive, replayed."""

from pathlib import Path

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial


@pytest.mark.long
def test_a_vehicle_driven_by_keys_meets_its_bars(tmp_path: Path) -> None:
    result = run_trial(load_trial("videoray-by-hand"), tmp_path / "run", engine="direct")
    assert [name for name, _, verdict in result.verdicts if not verdict.as_expected] == []
    assert len(result.verdicts) == 6
