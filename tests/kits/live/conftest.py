"""Runs to look at: short ones of shipped trials, made once."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial


def run_for(name: str, seconds: str, folder: Path, **changes: str) -> Path:
    """Return the folder of a shipped trial's first seconds, every output recorded."""
    trial = load_trial(name, changes={"stop": seconds, **changes}, origin="test")
    run_trial(trial.recording("all", "test"), folder, engine="direct")
    return folder


@pytest.fixture(scope="session")
def hydrone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run_for("hydrone-landing", "2 s", tmp_path_factory.mktemp("live") / "hydrone")


@pytest.fixture(scope="session")
def gloria(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run_for("gloria-pid-90", "4 s", tmp_path_factory.mktemp("live") / "gloria")
