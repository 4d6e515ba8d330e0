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
        (
            ["boat.csv", "--columns", "time=t,helm=RUD"],
            "line 3, column 'RUD': a finite number is needed, found ''",
        ),
        (["boat.csv", "--columns", "time=t,roll=ROL"], "roll: unknown column 'ROL'"),
        (["boat.csv", "--format", "cvs"], "did you mean 'csv'"),
    ],
)
def test_mistakes(log, arguments, message):
    done = log(*arguments)
    assert done.returncode == 2
    assert message in done.stderr
