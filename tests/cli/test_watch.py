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


def test_a_case_that_takes_longer_than_the_time_left_is_said_in_its_place(
    capsys: pytest.CaptureFixture[str],
) -> None:
    now = 0.0
    with Watch("pads", lambda: now) as watch:
        watch.expect(6)
        watch.cases(0, 0)
        for ended, at, running in ((3, 10.0, 4.0), (5, 20.0, 14.0), (5, 130.0, 124.0)):
            now = at
            watch.under_way(ended, 1, running)
            watch.cases(ended, 0)
    assert [line.rpartition(", ")[2] for line in capsys.readouterr().err.splitlines()] == [
        "15 s left",
        "case 2 has been running for 14 s",
        "case 2 has been running for 2 min",
    ]
