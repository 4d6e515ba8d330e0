"""Every shipped trial runs, and as FMUs and in process leaves the same bytes."""

import itertools
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from seatrial.model.component import NS
from seatrial.shipped import provided_folders
from seatrial.system.files import available
from seatrial.trial.files.trial import Trial, load_trial
from seatrial.trial.running.run import Hooks, run_trial
from tests.kit import needs_kits

FILES = {
    path.stem: tomllib.loads(path.read_text("utf-8"))
    for folder in provided_folders("harness/trials")
    for path in sorted(folder.glob("*.toml"))
}
NAMES = list(FILES)
PACED = [name for name, file in FILES.items() if "real_time" in file]
"""Trials in real time, for whoever connects."""
TRIALS = [name for name in NAMES if name not in PACED]
OUTSIDE = ("ardupilot", "px4")
"""Components whose time stands still until a program outside connects."""
COMPARED_S = 1
"""How a trial begins shows how it goes on; to the end they run in their vehicles' tests, or here."""


def has_sketch(name: str) -> bool:
    """Return whether a compiler makes a program of a sketch for this trial."""
    return "sketch" in FILES[name].get("choices", {}).get("autopilot", "")


def one_per_rig(names: list[str]) -> list[Any]:
    """Return trials as parameters: the first of each rig and vehicle at once, others later."""
    rigs, parameters = set(), []
    for name in names:
        rig = FILES[name]["rig"], FILES[name].get("choices", {}).get("vehicle")
        later = rig in rigs or has_sketch(name)
        parameters.append(pytest.param(name, marks=pytest.mark.interop if later else ()))
        rigs.add(rig)
    return parameters


def test_every_shipped_trial_can_be_named() -> None:
    assert set(NAMES) <= set(available("harness/trials"))
    assert TRIALS


def test_no_campaign_hides_behind_a_trial() -> None:
    folders = provided_folders("harness/campaigns")
    campaigns = {path.stem for folder in folders for path in folder.glob("*.toml")}
    assert campaigns
    assert campaigns.isdisjoint(NAMES)


def to_run(name: str) -> Trial:
    """Return a trial, unless it waits for a program outside."""
    trial = load_trial(name)
    if any(placed.entry.fmu in OUTSIDE for placed in trial.rig.components.values()):
        pytest.skip("its time stands still until a program outside connects")
    return trial


def begun(name: str, engine: str, folder: Path) -> list[bytes]:
    """Return the rows of a trial's record until it ends or `COMPARED_S` have passed."""
    trial, polls = to_run(name), itertools.count()
    if has_sketch(name):
        from tests.kits.arduino.bench import need  # not of the core: there may be no such kit

        need("host")
    # It asks while it makes the components, too.
    enough = len(trial.rig.components) + COMPARED_S * NS // trial.rig.step_ns
    hooks = Hooks(stop_requested=lambda: next(polls) > enough)
    result = run_trial(trial, folder, engine=engine, hooks=hooks)
    assert result.status in ("complete", "stopped"), result.error
    return (result.folder / "signals.csv").read_bytes().splitlines()


@pytest.mark.slow
@pytest.mark.parametrize("name", one_per_rig(TRIALS))
def test_fmus_and_components_in_process_leave_the_same_bytes(name: str, tmp_path: Path) -> None:
    rows = begun(name, "fmu", tmp_path / "fmu")
    assert len(rows) > 2
    assert begun(name, "direct", tmp_path / "direct") == rows


@pytest.mark.long
@pytest.mark.parametrize("name", TRIALS)
def test_whole_trials_as_fmus(name: str, tmp_path: Path) -> None:
    result = run_trial(to_run(name), tmp_path / "fmu")
    assert result.status == "complete", result.error


@pytest.mark.slow
@needs_kits("mavlink")
@pytest.mark.parametrize("name", one_per_rig(PACED))
def test_with_nobody_connected_they_leave_the_same_bytes_too(name: str, tmp_path: Path) -> None:
    trial = load_trial(name)
    linked = ("mavlink", "nmea0183", "serial-gateway")
    links = [c for c, placed in trial.rig.components.items() if placed.entry.fmu in linked]
    trial = trial.changed({"stop": f"{COMPARED_S} s", **{f"{c}.links": "" for c in links}}, "test")
    trial = replace(trial, file=trial.file.model_copy(update={"real_time": None}))
    signals = []
    for engine in ("fmu", "direct"):
        result = run_trial(trial, tmp_path / engine, engine=engine)
        assert result.status == "complete", result.error
        signals.append((result.folder / "signals.csv").read_bytes())
    assert signals[0] == signals[1]
