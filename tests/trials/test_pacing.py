"""Runs in real time, and the wall time in timing.json and the report."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.trial.files.trial import Trial, load_trial
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.run import Result, run_trial

BOAT = '''
"""Boats, one of which takes its time."""
import time

from seatrial.model.component import Component, Output, Parameter


class Pace(Component):
    """Wants another pace from 0.1 s on, and then stands still for a while."""

    later = Parameter(4.0, "1", "factor from then on")
    stands = Parameter(0.0, "s", "wall time for which it stands still in the step at 0.1 s")
    speedup = Output("1", "factor", start=1.0)
    paused = Output("s", "wall time that it stood still")
    text = Output("1", "no number", type=str)

    def start(self, t):
        self.stood = 0.0

    def step(self, t, h):
        if self.stands and abs(t - 0.1) < 1e-9:
            begun = time.monotonic()
            time.sleep(self.stands)
            self.stood = time.monotonic() - begun

    def outputs(self, t):
        self.speedup = self.later if t > 0.0999 else 1.0
        self.paused = self.stood


class Quick(Component):
    """y = t."""

    y = Output("s", "time")

    def outputs(self, t):
        self.y = t


class Slow(Component):
    """Sleeps in one step, or in all."""

    takes = Parameter(0.0, "s", "wall time of a step")
    only = Parameter(-1.0, "s", "of the step that starts then; of all if negative")
    y = Output("s", "time")

    def step(self, t, h):
        if self.takes and (self.only < 0 or abs(t - self.only) < 1e-9):
            time.sleep(self.takes)

    def outputs(self, t):
        self.y = t
'''
RIG = """
step = "10 ms"
[components]
quick = { fmu = "boat.py:Quick", step = "20 ms" }
slow  = { fmu = "boat.py:Slow" }
pace  = { fmu = "boat.py:Pace" }
"""
TRIAL = 'rig = "rig.toml"\nstop = "0.2 s"\n'


@pytest.fixture
def bench(write):
    write("boat.py", BOAT)
    write("rig.toml", RIG)

    def bench(more: str = "", **settings: float) -> Trial:
        trial = load_trial(str(write("trial.toml", TRIAL + more)))
        return trial.changed({f"slow.{key}": value for key, value in settings.items()}, "test")

    return bench


def run(trial: Trial, out: Path) -> tuple[Result, dict]:
    result = run_trial(trial, out, engine="direct")
    return result, json.loads((out / "timing.json").read_text("utf-8"))


@pytest.mark.parametrize("factor", [0.5, 1.0, 4.0])
def test_a_paced_run_lasts_as_long_and_records_the_same(factor, bench, tmp_path: Path) -> None:
    run(bench(), tmp_path / "free")
    result, timing = run(bench(f"real_time = {{ factor = {factor} }}\n"), tmp_path / "paced")
    assert timing["wall_s"]["run"] >= 0.2 / factor
    assert timing["real_time_factor"] <= factor
    pacing = timing["pacing"]
    assert (pacing["factor"], pacing["overrun"], pacing["lost_s"]) == (factor, "catch-up", 0.0)
    assert pacing["overruns"]["steps"] + pacing["slack"]["steps"] == 20
    assert any("deadline" in note for note in result.notes)
    free, paced = ((tmp_path / name / "signals.csv").read_bytes() for name in ("free", "paced"))
    assert paced == free
    assert "real_time" not in (tmp_path / "paced" / "manifest.json").read_text()


@pytest.mark.slow
def test_the_clock_starts_after_the_start(bench, write, tmp_path: Path) -> None:
    write("boat.py", BOAT + "\n    def start(self, t):\n        time.sleep(0.5)\n")
    _, timing = run(bench("real_time = { overrun = 'slip' }\n"), tmp_path / "run")
    assert timing["wall_s"]["initialise"] >= 0.5
    first = timing["pacing"]["overruns"]["longest_at_s"]
    assert first is None or timing["pacing"]["overruns"]["longest_s"] < 0.5


def test_a_hiccup_is_caught_up(bench, tmp_path: Path) -> None:
    trial = bench("real_time = {}\n", takes=0.05, only=0.02)
    result, timing = run(trial, tmp_path / "run")
    overruns = timing["pacing"]["overruns"]
    assert result.status == "complete"
    assert overruns["steps"] >= 4  # 40 ms late, 10 ms less each step
    assert overruns["longest_s"] >= 0.04
    assert timing["pacing"]["lost_s"] == 0.0
    assert any("steps ended after their deadline" in note for note in result.notes)


def test_a_hiccup_slips(bench, tmp_path: Path) -> None:
    trial = bench('real_time = { overrun = "slip" }\n', takes=0.05, only=0.02)
    result, timing = run(trial, tmp_path / "run")
    assert timing["pacing"]["lost_s"] >= 0.04
    assert timing["pacing"]["drift_s"] >= timing["pacing"]["lost_s"]
    assert timing["wall_s"]["run"] >= 0.24
    assert any(note.endswith("s lost") for note in result.notes)


@pytest.mark.slow
def test_an_overrun_aborts(bench, tmp_path: Path) -> None:
    trial = bench('real_time = { factor = 0.05, overrun = "abort" }\n', takes=0.8, only=0.02)
    result, timing = run(trial, tmp_path / "run")
    assert result.status == "failed"
    assert result.error.startswith("at t = 0.03 s the step ended ")
    assert "slow took longest" in result.error
    assert timing["steps"] == 3
    rows = (tmp_path / "run" / "signals.csv").read_text().splitlines()
    assert [row.partition(",")[0] for row in rows[1:]] == ["0.0", "0.01", "0.02"]
    assert "slow took longest" in write_report(tmp_path / "run").read_text("utf-8")


FOLLOWING = '[real_time]\nfactor = "pace.speedup"\npaused = "pace.paused"\n'


@pytest.mark.slow
def test_the_factor_may_be_a_signal(bench, tmp_path: Path) -> None:
    result, timing = run(bench(FOLLOWING), tmp_path / "run")
    assert result.status == "complete"
    assert timing["wall_s"]["run"] >= 0.1 + 0.1 / 4
    assert timing["pacing"]["factor"] == 4.0
    slow = bench(FOLLOWING).changed({"pace.later": 0.1}, "test")
    _, timing = run(slow, tmp_path / "slow")
    assert timing["wall_s"]["run"] >= 0.1 + 0.1 / 0.1


@pytest.mark.interop
def test_a_pause_is_no_overrun(bench, tmp_path: Path) -> None:
    trial = bench(FOLLOWING.replace("[real_time]", "[real_time]\noverrun = 'abort'"))
    trial = trial.changed({"pace.stands": 2.0, "pace.later": 0.05}, "test")
    result, timing = run(trial, tmp_path / "run")
    assert result.status == "complete", result.error
    assert timing["pacing"]["paused_s"] >= 2.0
    assert timing["pacing"]["overruns"]["longest_s"] < 2.0
    assert timing["wall_s"]["run"] >= 2.0 + 0.1 + 0.1 / 0.05


def test_a_signal_that_is_no_factor_ends_the_run(bench, tmp_path: Path) -> None:
    trial = bench(FOLLOWING).changed({"pace.later": 0.0}, "test")
    result, timing = run(trial, tmp_path / "run")
    assert result.status == "failed"
    assert result.error.startswith("real_time.factor: pace.speedup is 0.0 at t = 0.1 s, at least")
    assert timing["steps"] == 10


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ('factor = "pace.speed"', r"real_time.factor: .*did you mean 'pace.speedup'"),
        ('factor = "pace.text"', "real_time.factor: pace.text is a text, a number is needed"),
        (
            'factor = "pace.paused"',
            "real_time.factor: pace.paused is in s, a signal in 1 is needed",
        ),
        ('paused = "pace.speedup"', "real_time.paused: pace.speedup is in 1, a signal in s"),
        ('paused = "gone.paused"', r"real_time.paused: unknown signal 'gone.paused'"),
    ],
)
def test_a_signal_that_does_not_fit_is_named(written, message, bench, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message) as error:
        run(bench(f"real_time = {{ {written} }}\n"), tmp_path / "run")
    assert "trial.toml" in str(error.value)
    assert not (tmp_path / "run").exists()


def test_steps_are_timed_by_component(bench, tmp_path: Path) -> None:
    _, timing = run(bench(takes=0.004), tmp_path / "run")
    quick, slow = (timing["step_times"][name] for name in ("quick", "slow"))
    assert (quick["steps"], slow["steps"]) == (10, 20)
    assert sum(slow["bins"]) == 20
    assert slow["total_s"] >= 0.08
    assert not any(slow["bins"][:22])  # bin 22 begins at 2.1 ms
    assert slow["longest_s"] >= slow["p99_at_most_s"] >= slow["p50_at_most_s"] >= 0.004
    assert "pacing" not in timing


def test_the_report_shows_wall_time_and_pace(bench, tmp_path: Path) -> None:
    run(bench(), tmp_path / "free")
    run(bench("real_time = {}\n"), tmp_path / "paced")
    free, paced = (write_report(tmp_path / name).read_text("utf-8") for name in ("free", "paced"))
    assert "<h2>Wall time</h2>" in free
    assert "<h3>Real time</h3>" not in free
    assert "<h3>Real time</h3>" in paced
    assert "steps that ended after their deadline" in paced


def test_the_command_line_goes_before_the_file(bench) -> None:
    trial = bench('real_time = { factor = 3, overrun = "slip" }\n')
    faster = trial.in_real_time({"factor": 2.0}, "test").file.real_time
    assert (faster.factor, faster.overrun) == (2.0, "slip")
    fresh = bench().in_real_time({"factor": 2.0}, "test").file.real_time
    assert (fresh.factor, fresh.overrun) == (2.0, "catch-up")


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("real_time = { factor = 0 }", r"real_time.factor: .*greater than"),
        ("real_time = { factor = 1e-320 }", r"real_time.factor: .*greater than or equal to 0"),
        ("real_time = { factor = inf }", r"real_time.factor: .*finite"),
        ('real_time = { factor = "1" }', r"real_time.factor: .*number"),
        ('real_time = { overrun = "wait" }', "real_time.overrun: .*'catch-up', 'slip' or 'abort'"),
        ('real_time = { factor = "speedup" }', "real_time.factor: .*component.port"),
        ("real_time = { paused = 1 }", "real_time.paused: .*string"),
        ("real_time = { facto = 1 }", "did you mean 'factor'"),
        ("real_time = 2", "real_time: "),
    ],
)
def test_mistakes_are_named(written: str, message: str, bench) -> None:
    with pytest.raises(InputError, match=message) as error:
        bench(written)
    assert "trial.toml" in str(error.value)
