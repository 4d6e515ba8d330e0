"""Every shipped trial runs, and as FMUs and in process leaves the same bytes."""

import itertools
from dataclasses import replace
from pathlib import Path

import pytest

from seatrial.component import NS
from seatrial.cosim.files import available
from seatrial.shipped import shipped_folder
from seatrial.trials.run import Hooks, run_trial
from seatrial.trials.trial import load_trial

NAMES = sorted(path.stem for path in (shipped_folder("harness") / "trials").glob("*.toml"))
PACED = [name for name in NAMES if load_trial(name).file.real_time]
"""Trials in real time, for whoever connects."""
TRIALS = [name for name in NAMES if name not in PACED]
COMPARED_S = 60
"""Whole trials are run once; what is done again in process begins them."""


def test_every_shipped_trial_can_be_named() -> None:
    assert set(NAMES) <= set(available("harness/trials"))
    assert PACED


def test_no_campaign_hides_behind_a_trial() -> None:
    campaigns = {path.stem for path in (shipped_folder("harness") / "campaigns").glob("*.toml")}
    assert campaigns
    assert campaigns.isdisjoint(NAMES)


@pytest.mark.parametrize("name", TRIALS)
def test_fmus_and_components_in_process_leave_the_same_bytes(name: str, tmp_path: Path) -> None:
    whole = run_trial(load_trial(name), tmp_path / "fmu")
    assert whole.status == "complete", whole.error
    trial, polls = load_trial(name), itertools.count()
    enough = COMPARED_S * NS // trial.rig.step_ns
    hooks = Hooks(stop_requested=lambda: next(polls) > enough)
    begun = run_trial(trial, tmp_path / "direct", engine="direct", hooks=hooks)
    assert begun.status in ("complete", "stopped"), begun.error
    rows = (begun.folder / "signals.csv").read_bytes().splitlines()
    if begun.status == "stopped":
        rows.pop()  # where it stopped, which need not be a time to record
    assert len(rows) > 2
    assert (whole.folder / "signals.csv").read_bytes().splitlines()[: len(rows)] == rows


@pytest.mark.parametrize("name", PACED)
def test_with_nobody_connected_they_leave_the_same_bytes_too(name: str, tmp_path: Path) -> None:
    trial = load_trial(name)
    links = [c for c, entry in trial.rig.file.components.items() if entry.fmu == "mavlink"]
    trial = trial.changed({"stop": "2 s", **{f"{c}.links": "" for c in links}}, "test")
    trial = replace(trial, file=trial.file.model_copy(update={"real_time": None}))
    signals = []
    for engine in ("fmu", "direct"):
        result = run_trial(trial, tmp_path / engine, engine=engine)
        assert result.status == "complete", result.error
        signals.append((result.folder / "signals.csv").read_bytes())
    assert signals[0] == signals[1]
