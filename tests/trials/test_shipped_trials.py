"""Every shipped trial: as FMUs and in process it leaves the same bytes."""

from pathlib import Path

import pytest

from seatrial.cosim.files import available
from seatrial.shipped import shipped_folder
from seatrial.trials.run import run_trial
from seatrial.trials.trial import load_trial

TRIALS = sorted(path.stem for path in (shipped_folder("harness") / "trials").glob("*.toml"))


def test_every_shipped_trial_can_be_named() -> None:
    assert set(TRIALS) <= set(available("harness/trials"))


def test_no_campaign_hides_behind_a_trial() -> None:
    campaigns = {path.stem for path in (shipped_folder("harness") / "campaigns").glob("*.toml")}
    assert campaigns
    assert campaigns.isdisjoint(TRIALS)


@pytest.mark.parametrize("name", TRIALS)
def test_fmus_and_components_in_process_leave_the_same_bytes(name: str, tmp_path: Path) -> None:
    signals = []
    for engine in ("fmu", "direct"):
        result = run_trial(load_trial(name), tmp_path / engine, engine=engine)
        assert result.status == "complete", result.error
        signals.append((result.folder / "signals.csv").read_bytes())
    assert signals[0] == signals[1]
