"""Trials and campaigns from Python, against the command line and other readers."""

from __future__ import annotations

import copy
import json
import pickle
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas
import pytest

import seatrial
from seatrial import InputError, SimulationError
from tests.command import seatrial as command
from tests.kit import needs_kits

NEEDS = needs_kits("campaigns")


@pytest.mark.slow
def test_a_run_is_that_of_the_command(trial: str, tmp_path: Path) -> None:
    sets = ["--set", "stop=2.5 s", "--set", "source.level=1.5"]
    done = command("run", trial, "--engine", "direct", "--out", "a", *sets, cwd=tmp_path)
    calls: list[tuple[float, float]] = []
    result = seatrial.run_trial(
        trial,
        set={"stop": 2.5, "source.level": np.float64(1.5)},
        out=tmp_path / "b",
        progress=lambda passed, whole: calls.append((passed, whole)),
    )
    a, b = tmp_path / "a", tmp_path / "b"
    for name in ("signals.csv", "verdicts.json"):
        assert (a / name).read_bytes() == (b / name).read_bytes()
    assert result.manifest == json.loads((b / "manifest.json").read_text("utf-8"))
    assert (result.passed, done.returncode, result.status) == (False, 1, "complete")
    assert calls[-1] == (2.5, 2.5)
    assert not (b / "report.html").exists()
    assert result.report() == b / "report.html"
    assert "the lag stays low" in (b / "report.html").read_text("utf-8")


def test_signals_are_those_of_the_record(trial: str, tmp_path: Path) -> None:
    signals = seatrial.run_trial(trial, out=tmp_path / "run").signals
    table = pandas.read_csv(tmp_path / "run" / "signals.csv")
    assert signals.t.tolist() == table.pop("time").tolist()
    assert list(signals) == list(table)
    for name in signals:
        assert signals[name].tolist() == table[name].tolist(), name
    assert {name: signals[name].dtype for name in ("types.flag", "types.count", "types.text")} == {
        "types.flag": np.bool_, "types.count": np.int64, "types.text": np.object_
    }  # fmt: skip
    assert (
        signals["types.echo"].tolist() == table[["types.echo." + a for a in "xyz"]].values.tolist()
    )
    assert (signals["types.echo"].unit, signals["types.turn"].unit) == ("m", "rad")
    assert signals["types.turn"].description == "an angle"
    assert signals.units["spring.force"] == "N"


def test_pandas_and_xarray_get_everything(trial: str, tmp_path: Path) -> None:
    signals = seatrial.run_trial(trial, out=tmp_path / "run").signals
    table, dataset = signals.to_pandas(), signals.to_xarray()
    assert list(table) == list(signals) == list(dataset)
    assert table.loc[1.5, "lag.y"] == signals["lag.y"][15] == dataset["lag.y"].sel(time=1.5)
    assert type(table["lag.y"].to_numpy()) is type(dataset["lag.y"].values) is np.ndarray
    assert table.attrs["units"]["body.v"] == "m/s"
    assert dataset["body.v"].attrs == {"units": "m/s", "long_name": "velocity"}
    assert dataset["time"].attrs["units"] == "s"
    assert table.index.name == "time"


@pytest.mark.parametrize("library", ["pandas", "xarray"])
def test_a_library_that_is_missing_is_named(
    library: str, trial: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = seatrial.run_trial(trial, out=tmp_path / "run")
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(InputError, match=f"to_{library} needs {library}: pip install {library}"):
        getattr(result.signals, f"to_{library}")()


def test_arrays_keep_their_unit_as_long_as_it_is_theirs(trial: str, tmp_path: Path) -> None:
    signals = seatrial.run_trial(trial, out=tmp_path / "run").signals
    x = signals["body.x"]
    for same in (x[3:], x[::2], x.copy(), pickle.loads(pickle.dumps(x)), copy.deepcopy(x)):
        assert (same.unit, same.description) == ("m", "position")
    whole = signals["types.echo"]
    assert whole[:, 1].unit == "m"
    computed = [x * x, np.sin(x), x + 1.0, np.gradient(x), np.concatenate([x, x]), np.dot(x, x)]
    assert not any(hasattr(array, "unit") for array in [*computed, *np.split(x[:30], 2)])
    with pytest.raises(ValueError, match="read-only"):
        x[0] = 1.0
    target = x.copy()
    np.multiply(x, 2.0, out=target)
    assert target.tolist() == (2.0 * x).tolist()


def test_a_mapping_of_signals_keeps_to_its_contract(trial: str, tmp_path: Path) -> None:
    signals = seatrial.run_trial(trial, out=tmp_path / "run").signals
    assert "lag.y" in signals
    assert "lag.yy" not in signals
    assert signals.get("lag.yy") is None
    assert "types.echo" in signals
    assert len(signals) == len(list(signals)) == 12
    with pytest.raises(InputError, match=r"did you mean 'types\.echo'"):
        signals["types.ecko"]
    with pytest.raises(InputError, match="unknown signal 'types'"):
        signals["types"]


def test_verdicts_say_what_the_trial_asked(trial: str, tmp_path: Path) -> None:
    low, near = seatrial.run_trial(trial, out=tmp_path / "run").verdicts
    assert (low.name, low.check, low.passed) == ("the lag stays low", "lag.y < 3 V", False)
    # One second of 5 V from y(1 s), on T = 0.5 s: closed form of the lag.
    start = 1.0 - np.exp(-1.0)
    begun = 2.0 + (start - 2.0) * np.exp(-1.0)
    assert low.worst == pytest.approx(5.0 + (begun - 5.0) * np.exp(-2.0), rel=1e-12)
    assert (low.unit, low.time) == ("V", 2.0)
    assert (near.passed, near.unit) == (True, "cm")


def test_a_folder_is_read_again(trial: str, tmp_path: Path) -> None:
    result = seatrial.run_trial(trial, out=tmp_path / "run")
    again = seatrial.load_result(str(tmp_path / "run"))
    assert again.verdicts == result.verdicts
    assert again.signals["lag.y"].tolist() == result.signals["lag.y"].tolist()
    assert repr(again) == (f"<trial: complete, 1 of 2 criteria do not hold; {tmp_path / 'run'}>")
    assert any("spring.rest" in note for note in result.notes)
    with pytest.raises(InputError, match="is not a run folder"):
        seatrial.load_result(tmp_path)


@pytest.mark.slow
def test_a_run_without_a_folder_makes_a_new_one(
    trial: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    first, second = seatrial.run_trial(trial), seatrial.run_trial(trial, engine="fmu")
    assert first.folder != second.folder
    assert first.folder.parent == second.folder.parent == Path("runs")
    assert (first.folder / "signals.csv").read_bytes() == (
        second.folder / "signals.csv"
    ).read_bytes()


def test_a_run_that_cannot_go_on_raises_and_leaves_its_record(trial: str, tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match="the boat has sunk") as caught:
        seatrial.run_trial(trial, set={"types.fails": "1 s"}, out=tmp_path / "run")
    assert str(tmp_path / "run") in str(caught.value)
    result = seatrial.load_result(tmp_path / "run")
    assert (result.status, result.passed, result.verdicts) == ("failed", False, [])
    assert result.signals.t[-1] == 1.0


def test_an_interrupted_run_raises_and_is_whole(
    trial: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sweep must not go on with its next trial."""

    def interrupt(_passed: float, _whole: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        seatrial.run_trial(trial, set={"stop": "2000 s"}, out=tmp_path / "run", progress=interrupt)
    assert seatrial.load_result(tmp_path / "run").status == "stopped"


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda t: seatrial.run_trial("hydrone-landin"), "did you mean 'hydrone-landing'"),
        (lambda t: seatrial.run_trial("hydrone-pads"), "is a campaign: run_campaign runs it"),
        (lambda t: seatrial.run_trial(t, engine="x"), "unknown engine 'x'"),
        (lambda t: seatrial.run_trial(t, set={"lag.uu": 1}), "unknown port 'uu'"),
        (lambda t: seatrial.run_trial(t, set={"stp": 1}), "did you mean 'stop' or 'step'"),
        (lambda t: seatrial.run_trial(t, set={"stop": True}), "stop: "),
        pytest.param(
            lambda t: seatrial.run_campaign("hydrone-pad"),
            "did you mean 'hydrone-pads'",
            marks=NEEDS,
        ),
        pytest.param(
            lambda t: seatrial.load_campaign_result(t), "is not a campaign folder", marks=NEEDS
        ),
    ],
)
def test_mistakes_are_named_and_leave_nothing(
    call: Callable[[str], object],
    said: str,
    trial: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as caught:
        call(trial)
    assert said in str(caught.value)
    assert not (tmp_path / "runs").exists()


# ---------------------------------------------------------------------- campaigns

CAMPAIGN = """
trials = ["trial.toml"]

[grid]
"source.level" = [0.5, "2 V"]
"types.fails" = ["1 s", "9 s"]
"""


@pytest.fixture
def campaign(trial: str, tmp_path: Path) -> str:
    path = tmp_path / "campaign.toml"
    path.write_text(CAMPAIGN, "utf-8")
    return str(path)


@needs_kits("campaigns")
@pytest.mark.interop
def test_a_campaign_is_that_of_the_command(campaign: str, tmp_path: Path) -> None:
    command("run", campaign, "--engine", "direct", "--out", "a", cwd=tmp_path)
    calls: list[tuple[int, int]] = []
    result = seatrial.run_campaign(
        campaign, out=tmp_path / "b", progress=lambda done, count: calls.append((done, count))
    )
    a, b = tmp_path / "a", tmp_path / "b"
    assert (a / "campaign.json").read_bytes() == (b / "campaign.json").read_bytes()
    assert calls == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert [(c.status, c.passed) for c in result.cases] == [
        ("failed", False),
        ("complete", False),
    ] * 2
    assert result.cases[1].set == {"source.level": 0.5, "types.fails": "9 s"}
    for case in result.cases:
        there = a / case.folder.name / "signals.csv"
        assert (case.folder / "signals.csv").read_bytes() == there.read_bytes()
    assert not result.passed
    assert repr(result) == f"<campaign: 0 of 4 cases pass; {b}>"
    assert result.report() == b / "report.html"
    assert (result.cases[1].folder / "report.html").is_file()


@needs_kits("campaigns")
@pytest.mark.interop
def test_a_campaign_is_a_table(campaign: str, tmp_path: Path) -> None:
    seatrial.run_campaign(campaign, out=tmp_path / "run")
    result = seatrial.load_campaign_result(tmp_path / "run")
    table = result.to_pandas()
    assert table["types.fails"].tolist() == ["1 s", "9 s"] * 2
    assert table["status"].tolist() == ["failed", "complete"] * 2
    complete = table[table["status"] == "complete"]
    worst = [case.result.verdicts[0].worst for case in result.cases[1::2]]
    assert complete["the lag stays low [V]"].tolist() == worst
    assert complete["the body stays near"].tolist() == [True, True]
    assert table.index.name == "case"
