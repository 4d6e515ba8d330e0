"""Trials measured in one program that starts anew: verdicts and figures of single runs."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import Any

import pytest

from seatrial.trial.files.trial import Trial, load_trial
from seatrial.trial.running.hooks import Hooks, StoppedError
from seatrial.trial.running.measuring import Measured, measure_trial
from seatrial_kits.batch import measuring

from .test_batch import RIG, TRIAL

pytestmark = [
    pytest.mark.slow,  # the compiler takes seconds
    pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux"),
]

CRITERIA = """
[[criteria]]
name = "near"
check = "abs(cork.x - 0.5 m) < 0.2 m after 400 ms"
[[criteria]]
name = "slow"
check = "cork.v < 0.2 m/s"
ends = true
[[criteria]]
name = "comes by"
check = "eventually[0 s, 1 s] cork.x > 0.35 m"
ends = true
[[criteria]]
name = "at rest"
check = "cork.x settles within 900 ms"
expect = "fail"
why = "a second is not enough"
"""


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Trial:
    folder = tmp_path_factory.mktemp("measuring")
    (folder / "cork.toml").write_text(RIG, "utf-8")
    path = folder / "trial.toml"
    path.write_text(TRIAL + CRITERIA, "utf-8")
    return replace(load_trial(str(path)), figures=("cork.x", "pilot.force"))


@pytest.fixture(autouse=True)
def programs(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Let the first trial have its program, and forget it in the end."""
    monkeypatch.setattr(measuring, "_WORTH", 0)
    yield measuring._PROGRAMS
    for program in measuring._PROGRAMS.values():
        if program is not None:
            program.batch.close()
    measuring._PROGRAMS.clear()
    measuring._SEEN.clear()


def singly(trial: Trial, monkeypatch: pytest.MonkeyPatch) -> Measured:
    with monkeypatch.context() as patch:
        patch.setattr(measuring, "_WORTH", 10**9)
        return measure_trial(trial, engine="native")


def alone(trial: Trial, hooks: Hooks | None = None) -> Measured | None:
    [found] = measuring.measured([trial], hooks or Hooks())
    return found


def same(a: Measured, b: Measured) -> bool:
    return {**asdict(a), "wall": 0.0} == {**asdict(b), "wall": 0.0}


def test_verdicts_and_figures_are_those_of_single_runs(
    base: Trial, monkeypatch: pytest.MonkeyPatch, programs: Any
) -> None:
    cases = [
        {"cork.mass": 3.0, "seed": 4},
        {"cork.mass": 500.0, "seed": 4},
        {"cork.mass": "1 kg", "seed": 4},
        {"cork.mass": 2.0, "seed": 11, "cork.drag": "0 N.s/m"},
        {"cork.mass": 2.0, "seed": 11, "cork.drag": 4},
        {"cork.mass": 5.0, "cork.form": "square"},
        {"cork.mass": 5.0, "cork.form": "linear"},
        {"cork.mass": 0.2, "cork.current_speed": 1.0},
    ]
    statuses = set()
    for case in cases:
        trial = base.changed(case, "test")
        expected = singly(trial, monkeypatch)
        found = alone(trial)
        assert found is not None
        assert same(found, expected), case
        statuses.add(found.status)
    assert statuses == {"complete", "ended"}
    assert len(programs) == 4  # by the names of numbers, and by texts
    again = alone(base.changed(cases[0], "test"))
    assert again is not None
    assert same(again, singly(base.changed(cases[0], "test"), monkeypatch))


def test_cases_measured_at_once_are_those_of_single_runs(
    base: Trial, monkeypatch: pytest.MonkeyPatch
) -> None:
    cases = [
        {"cork.mass": 0.3 + 0.1 * i, "seed": i, "cork.drag": f"{i % 3} N.s/m"} for i in range(35)
    ]
    cases[4] |= {"cork.mass": 500.0}
    cases[7] |= {"cork.mass": 0.0}  # a mistake
    cases[9] |= {"cork.form": "square"}  # of another program
    cases[20] |= {"pilot.reach": 0.01}  # fails in the run
    trials = [base.changed({"pilot.reach": 1e9, **case}, "test") for case in cases]
    found = measuring.measured(trials, Hooks())
    assert [i for i, each in enumerate(found) if each is None] == [7, 20]
    for trial, each in zip(trials, found, strict=True):
        assert each is None or same(each, singly(trial, monkeypatch))
    assert {each.status for each in found if each} == {"complete", "ended"}


def test_each_case_has_its_own_sea(monkeypatch: pytest.MonkeyPatch, programs: Any) -> None:
    trial = load_trial("hydrone-landing-waves", changes={"stop": "3 s"}, origin="test")
    for height, seed in ((0.1, 1), ("20 cm", 1), (0.2, 5)):
        case = trial.changed({"sea.height": height, "seed": seed}, "test")
        found = alone(case)
        assert found is not None
        assert same(found, singly(case, monkeypatch))
    assert len(programs) == 1


def test_a_signal_may_have_the_name_that_a_rig_inside_shows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    trial = load_trial("hydrone-landing-waves", changes={"stop": "1 s"}, origin="test")
    case = replace(trial, figures=("vehicle.motion.position.x",))
    found = alone(case)
    assert found is not None
    assert same(found, singly(case, monkeypatch))


@pytest.mark.parametrize(
    "changes",
    [
        {"cork.mass": 0.0},  # a mistake
        {"cork.mas": 1.0},
        {"pilot.reach": 0.01},  # fails in the run
    ],
)
def test_what_goes_wrong_is_left_to_a_single_run(base: Trial, changes: dict[str, Any]) -> None:
    assert alone(base.changed(changes, "test")) is None


def test_a_bias_is_left_to_a_single_run(base: Trial) -> None:
    fault = {"what": "bias", "where": "cork.x", "value": 0.1, "at": "100 ms"}
    assert alone(base.failing([fault], "test")) is None


def test_a_stop_ends_it(base: Trial) -> None:
    with pytest.raises(StoppedError):
        alone(base, Hooks(stop_requested=lambda: 1))
    orders = iter([0, 1])
    stopped = alone(base, Hooks(stop_requested=lambda: next(orders)))
    assert stopped is not None
    assert stopped.status == "stopped"
