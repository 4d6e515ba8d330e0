"""Criteria that are expected to fail, text ports in a run, and what both leave."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

import seatrial
from seatrial.cli.main import app
from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial

Write = Callable[[str, str], Path]
BOARD = '''
"""A board with a UART."""

from typing import ClassVar

from seatrial.model.component import Output
from seatrial.links.text import Outbox
from seatrial.model.sampled import Sampled
from seatrial.model.terminals import terminal


class Board(Sampled):
    """Says OK at 0.5 s, and when it is alive."""

    tx = Output("1", "bytes that left the UART, as text", type=str)
    mode = Output("1", "mode", type=str)
    alive = Output("1", "whether it is", type=bool)
    terminals: ClassVar = {"uart0": terminal(up="tx")}

    def reset(self, t):
        self._box = {}

    def sample(self, t, k):
        self.tx = Outbox(self._box).text
        self.mode, self.alive = "AUTO" if t > 1 else "MANUAL", True

    def update(self, t, k):
        box = Outbox(self._box)
        said = {49: b"O", 50: b"K\\n"}.get(k)
        if said:
            box.put(round(t * 1e9), said)
        box.flush()
'''
RIG = """
step = "10 ms"

[components]
board = { fmu = "board.py:Board", set = { period = "10 ms" } }
servo = { fmu = "angle-servo", set = { period = "10 ms", rate = "1 rad/s" } }
"""
TRIAL = """
rig  = "rig.toml"
stop = "2 s"

[set]
"servo.command" = 1.0

[[criteria]]
name  = "it says so"
check = 'board.uart0 says "OK" within 1 s'

[[criteria]]
name  = "then it is in control"
check = '(board.mode is "MANUAL" or board.alive) until[0 s, 2 s] board.tx says "K"'

[[criteria]]
name   = "it stays below half a radian"
check  = 'servo.angle < {limit}'
expect = "fail"
why    = "its command is 1 rad"
"""


@pytest.fixture
def trial(write: Write) -> Callable[[str], str]:
    def made(limit: str = "0.5 rad") -> str:
        write("board.py", BOARD)
        write("rig.toml", RIG)
        return str(write("trial.toml", TRIAL.format(limit=limit)))

    return made


@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_a_failure_that_is_expected_is_no_failure(trial, tmp_path, engine):
    result = seatrial.run_trial(trial(), out=tmp_path / "out", engine=engine)
    says, control, angle = result.verdicts
    assert result.passed
    assert (says.passed, says.time) == (True, pytest.approx(0.51))
    assert control.passed
    assert (angle.passed, angle.expected, angle.why) == (
        False,
        "fail",
        "its command is 1 rad",
    )
    assert angle.robustness == pytest.approx(-1.0, abs=0.01)
    assert angle.margin == "-100 %"
    rows = json.loads((tmp_path / "out/verdicts.json").read_text())
    assert [row["robustness"] for row in rows[:2]] == [None, None]
    assert "fails as expected" in result.report().read_text("utf-8")


def test_what_holds_against_expectation_is_one(trial, tmp_path):
    arguments = ["run", trial("5 rad"), "--engine", "direct", "--out", str(tmp_path / "out")]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 1
    assert "XPASS  it stays below half a radian" in done.output
    assert not seatrial.load_result(tmp_path / "out").passed


def test_another_setting_is_not_what_was_published(trial, tmp_path):
    arguments = ["run", trial(), "--engine", "direct", "--set", "seed=2"]
    done = CliRunner().invoke(app, [*arguments, "--out", str(tmp_path / "out")])
    assert done.exit_code == 1
    assert "FAIL  it stays below half a radian" in done.output
    assert "XFAIL" not in done.output


@pytest.mark.parametrize(
    "line", ['expect = "fail"', 'why = "so it is"', 'expect = "never"\nwhy = "x"']
)
def test_an_expectation_says_why(trial, line):
    path = Path(trial())
    old = 'expect = "fail"\nwhy    = "its command is 1 rad"'
    path.write_text(path.read_text().replace(old, line))
    with pytest.raises(InputError, match=r"criteria\.2"):
        load_trial(str(path))


@pytest.mark.parametrize(
    ("check", "message"),
    [
        ("servo.angle", "a number: compare it"),
        ('servo.angle says "x"', "is no text"),
        ('board.uart1 says "x"', "unknown text signal"),
        ("board.tx < 3", "is a text"),
    ],
)
def test_signals_of_another_kind_are_refused_before_the_run(trial, tmp_path, check, message):
    path = Path(trial())
    path.write_text(path.read_text().replace("servo.angle < 0.5 rad", check))
    with pytest.raises(InputError, match=message):
        seatrial.run_trial(path, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_text_can_end_a_run(trial, tmp_path):
    path = Path(trial())
    end = '[[criteria]]\nname = "no auto"\ncheck = \'board.mode is "MANUAL"\'\nends = true\n'
    path.write_text(path.read_text() + end)
    result = seatrial.run_trial(path, out=tmp_path / "out")
    assert result.status == "ended"
    assert result.manifest["status"] == "ended"
    assert result.signals.t[-1] == pytest.approx(1.01)


@pytest.mark.slow
def test_the_shipped_landing_fails_as_published(tmp_path):
    result = seatrial.run_trial("hydrone-landing", out=tmp_path / "out")
    roll = result.verdicts[0]
    assert (roll.passed, roll.expected) == (False, "fail")
    assert "table 7" in roll.why
    assert result.passed
