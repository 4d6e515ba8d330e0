"""``seatrial log``: the channels of a log, and what they serve."""

import json

import pytest

from tests.command import seatrial

TABLE = "t [s],HDG [deg],RUD [deg]\n0,350,0\n1,355,\n2,0,-5\n10,5,-5\n"


@pytest.fixture
def log(write, tmp_path):
    write("boat.csv", TABLE)
    write("many.csv", "time," + ",".join(f"a{k}" for k in range(60)) + "\n" + ",".join(["1"] * 61))
    return lambda *arguments: seatrial("log", *arguments, cwd=tmp_path)


def test_units_rates_ranges_gaps_and_quantities(log):
    done = log("boat.csv", "--columns", "time=t,heading=HDG", "--json")
    result = json.loads(done.stdout)["result"]
    assert (result["format"], result["from"], result["to"]) == ("csv", 0.0, 10.0)
    heading = {"name": "HDG", "unit": "deg", "values": 4, "rate": 1.0, "least": 0.0, "most": 355.0,
               "gaps": 1, "serves": ["heading"]}  # fmt: skip
    assert result["channels"][0] == heading
    assert [each["name"] for each in result["channels"]] == ["HDG", "t", "RUD"]


def test_lines_for_a_person(log):
    done = log("boat.csv", "--columns", "time=t,heading=HDG")
    assert "boat.csv: CSV (csv), from 0 s to 10 s" in done.stdout
    assert "HDG" in done.stdout


def test_clocks_and_order_of_a_log_are_said(log, write):
    """Times since 1970 and a clock that was set back: the list is that of import."""
    rows = [(1.7e9 + k - 3600.0 * (k > 20), k) for k in range(40)]
    rows[5], rows[6] = rows[6], rows[5]
    write("set.csv", "time,HDG\n" + "".join(f"{time:.1f},{k}\n" for time, k in rows))
    done = log("set.csv", "--columns", "heading=HDG:deg")
    assert "from 0 s to 39 s, time 0 is 2023-11-14T22:13:20+00:00" in done.stdout
    assert "the clock was set once, the first before line 23, by -3600 s" in done.stdout
    assert "1 rows were out of order" in done.stdout


def test_empty_cells_are_counted(log):
    done = log("boat.csv", "--columns", "time=t,helm=RUD")
    assert done.returncode == 0
    assert "cells without a number, by column: RUD (1)" in done.stdout


def test_of_many_channels_those_that_serve_are_shown(log):
    assert (
        "60 more channels: --all shows them"
        in log("many.csv", "--columns", "time=time,roll=a0").stdout
    )
    assert "a59" in log("many.csv", "--all").stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.csv"], "there is no log none.csv"),
        (["boat.csv"], "time: unknown column 'time'"),
        (["boat.csv", "--columns", "time=t,roll=ROL"], "roll: unknown column 'ROL'"),
        (["boat.csv", "--format", "cvs"], "did you mean 'csv'"),
    ],
)
def test_mistakes(log, arguments, message):
    done = log(*arguments)
    assert done.returncode == 2
    assert message in done.stderr
