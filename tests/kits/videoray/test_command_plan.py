"""``seatrial plan`` as its user meets it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.command import seatrial

CASE = ("videoray-surface", "--surge", "0.05 m/s", "--yaw-rate", "0.2 rad/s")


def test_it_says_whether_it_can_be_done_and_leaves_table_and_page(tmp_path: Path) -> None:
    constant = ("--constant", "surge", "--constant", "yaw", "--out", "plan")
    done = seatrial("plan", *CASE, *constant, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "yes  the thrusters can do it: largest command 0.001071, limit 1" in done.stdout
    assert "yes  the flatness law can track it" in done.stdout
    assert '"law.surge" = "0.05 m/s"' in done.stdout
    assert sorted(path.name for path in (tmp_path / "plan").iterdir()) == [
        "plan.csv",
        "report.html",
    ]


def test_what_the_thrusters_cannot_do_has_status_1(tmp_path: Path) -> None:
    arguments = ("videoray-surface", "--surge", "3 m/s", "--duration", "0.2 s", "--out", "plan")
    done = seatrial("plan", *arguments, cwd=tmp_path)
    assert done.returncode == 1
    assert "no   the thrusters can do it" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (
            ("hydrone", "--surge", "1 m/s"),
            "hydrone/vehicle.toml: a vehicle with a table 'surface-vessel'",
        ),
        (("videoray-surface", "--surge", "2 kg"), "unit 'kg' cannot be converted to 'm/s'"),
        (("videoray-surface", "--surge", "200 m/s"), "no duration is long enough"),
        (("videoray-surface",), "Missing option '--surge'"),
    ],
)
def test_mistakes_are_named_and_leave_nothing(
    tmp_path: Path, arguments: tuple[str, ...], expected: str
) -> None:
    done = seatrial("plan", *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert expected in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.iterdir())
