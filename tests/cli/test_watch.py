"""Progress without a terminal: plain lines on stderr."""

from __future__ import annotations

import pytest

from seatrial.cli.watch import PERIOD, Watch


def test_a_line_every_few_seconds(capsys: pytest.CaptureFixture[str]) -> None:
    now = 0.0
    with Watch("landing", lambda: now) as watch:
        watch.building("hull")
        for quarter in range(1, 9):
            now = quarter * PERIOD / 4
            watch.progress(quarter * 2.0, 20.0)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.splitlines() == [
        "landing: 40 %, 8.0 of 20 s, 1.6 x real time",
        "landing: 80 %, 16.0 of 20 s, 1.6 x real time",
    ]


def test_several_runs_are_one_whole(capsys: pytest.CaptureFixture[str]) -> None:
    now = 0.0
    with Watch("pads", lambda: now) as watch:
        watch.expect(4)
        watch.log(lambda: None)
        now = PERIOD
        watch.building("hull")
        now = 2 * PERIOD
        watch.progress(10.0, 20.0)
    line = "pads: 38 %, 10.0 of 20 s, 2.0 x real time (2 of 4)\n"
    assert capsys.readouterr().err == line
