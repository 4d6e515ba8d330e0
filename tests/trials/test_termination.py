"""Criteria that end a run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from seatrial.cli.main import app
from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import Result, run_trial

Write = Callable[[str, str], Path]
RIG = """
step = "10 ms"

[components]
servo = { fmu = "angle-servo", set = { period = "10 ms", rate = "1 rad/s" } }
"""
TRIAL = """
rig  = "rig.toml"
stop = "2 s"

[set]
"servo.command" = 1.0

[[criteria]]
name  = "it turns"
check = "eventually[0 s, 1 s] servo.angle > 0.2 rad"

[[criteria]]
name  = "it stays below half a radian"
check = "servo.angle < {limit} rad"
ends  = true
"""


def trial(write: Write, limit: float = 0.5) -> Path:
    write("rig.toml", RIG)
    return write("trial.toml", TRIAL.format(limit=limit))


def ran(write: Write, folder: Path, engine: Any = "direct", limit: float = 0.5) -> Result:
    return run_trial(load_trial(str(trial(write, limit))), folder, engine=engine)


@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_the_run_ends_where_the_criterion_is_broken(
    write: Write, tmp_path: Path, engine: str
) -> None:
    result = ran(write, tmp_path / "out", engine)
    assert (result.status, result.error, result.passed) == ("ended", None, False)
    found = load_run(result.folder)
    # 0.01 rad at 0 s and 0.01 more at each step: 0.5 is reached at 0.49 s.
    assert found.time[-1] == pytest.approx(0.49, abs=0.0101)
    assert found.signals["servo.angle"][-1] >= 0.5 > found.signals["servo.angle"][-2]
    assert found.manifest["status"] == "ended"
    turns, stays = result.verdicts
    assert turns[2].passed
    assert not stays[2].passed
    assert "first broken at 0.4" in stays[2].detail or "first broken at 0.5" in stays[2].detail


def test_a_run_that_keeps_to_it_is_complete(write: Write, tmp_path: Path) -> None:
    result = ran(write, tmp_path / "out", limit=2.0)
    assert (result.status, result.passed) == ("complete", True)


def test_the_last_row_is_recorded_however_seldom_rows_are(write: Write, tmp_path: Path) -> None:
    path = trial(write)
    path.write_text(path.read_text() + '\n[record]\nevery = "0.3 s"\n')
    found = load_run(run_trial(load_trial(str(path)), tmp_path / "out", engine="direct").folder)
    assert found.time[:2].tolist() == [0.0, 0.3]
    assert found.signals["servo.angle"][-1] >= 0.5


def test_the_command_line_says_so_and_fails(write: Write, tmp_path: Path) -> None:
    arguments = ["run", str(trial(write)), "--engine", "direct", "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 1
    assert "ENDED" in result.output
    assert "run ended" in (tmp_path / "out/report.html").read_text("utf-8")


def test_the_run_ends_where_what_is_wanted_within_a_time_is_there(
    write: Write, tmp_path: Path
) -> None:
    path = trial(write, limit=2.0)
    wanted = 'check = "eventually[0 s, 1 s] servo.angle > 0.2 rad"\n'
    path.write_text(path.read_text().replace(wanted, wanted + "ends = true\n"))
    result = run_trial(load_trial(str(path)), tmp_path / "out", engine="direct")
    assert (result.status, result.error, result.passed) == ("complete", None, True)
    # 0.01 rad at 0 s and 0.01 more at each step: more than 0.2 at 0.2 s.
    assert load_run(result.folder).time[-1] == pytest.approx(0.2, abs=0.0101)


@pytest.mark.parametrize(
    "check",
    [
        "finally servo.angle < 0.5 rad",
        "eventually[1 s, 2 s] servo.angle > 0.2 rad",
        "servo.angle settles within 1 s",
        "always[1 s, end] servo.angle < 0.5 rad",
        "always[0 s, 1 s] servo.angle < 0.5 rad",
    ],
)
def test_only_a_plain_condition_can_end_a_run(write: Write, check: str) -> None:
    path = trial(write)
    path.write_text(path.read_text().replace("servo.angle < 0.5 rad", check))
    with pytest.raises(InputError, match=r"cannot end a run: with ends = true a condition"):
        load_trial(str(path))
