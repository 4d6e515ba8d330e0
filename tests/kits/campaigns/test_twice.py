"""``--twice``: the same inputs give the same bytes, or the component that does not is named."""

import json

import pytest

from seatrial.errors import SimulationError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.again import run_again
from seatrial.trial.running.twice import sample
from tests.command import seatrial as command

COMPONENTS = """
import os
import random
import time

import numpy as np

from seatrial.model.component import Component, Input, Output, Parameter


class Gust(Component):
    \"\"\"Speed from somewhere, from the fifth step on.\"\"\"

    way = Parameter("", "1", "where it is from")
    number = Parameter(0.0, "m", "of the case")
    v = Output("m/s", "speed")

    def start(self, t):
        self.v = 0.0

    def step(self, t, h):
        if t < 0.35:
            return
        match self.way:
            case "clock":
                self.v = time.time() % 1.0
            case "entropy":
                self.v = np.random.default_rng().normal()
            case "generators":
                self.v = np.random.normal() + random.gauss(0.0, 1.0)
            case "environment":
                self.v = float(os.environ["GUST"])
            case "set":
                self.v = float("".join({str(digit) for digit in range(10)}))


class Hull(Component):
    \"\"\"Its place follows the gust.\"\"\"

    f = Input("m/s", "speed of the gust")
    x = Output("m", "place")

    def start(self, t):
        self.x = 0.0

    def step(self, t, h):
        self.x += h * self.f
"""
RIG = """
step = "100 ms"
[components]
hull = { fmu = "parts.py:Hull" }
gust = { fmu = "parts.py:Gust" }
[connections]
"gust.v" = "hull.f"
"""
TRIAL = 'rig = "rig.toml"\nstop = "1 s"\n[[criteria]]\nname = "far"\ncheck = "hull.x < 1e12 m"\n'


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A trial, with GUST in the environment."""
    monkeypatch.setenv("GUST", "2.5")
    for name, text in (("parts.py", COMPONENTS), ("rig.toml", RIG), ("t.toml", TRIAL)):
        (tmp_path / name).write_text(text, "utf-8")
    return tmp_path


def twice(folder, *arguments):
    done = command("run", *arguments, "--twice", "--engine", "direct", "--no-report", "--json",
                   cwd=folder)  # fmt: skip
    return done, json.loads(done.stdout)["result"]["twice"]


@pytest.mark.parametrize(
    ("way", "called"),
    [
        ("clock", ["time.time (parts.py:26 in step) 6 times"]),
        pytest.param(
            "entropy", ["os.urandom (parts.py:28 in step) 6 times"], marks=pytest.mark.slow
        ),
        pytest.param("set", None, marks=pytest.mark.slow),
    ],
)
def test_a_component_that_differs_is_named_with_its_calls(project, way, called):
    done, (found,) = twice(project, "t.toml", "--set", f"gust.way={way}", "--out", "out")
    assert done.returncode == 1
    assert found["difference"].startswith("gust.v differs from t = 0.5 s on: ")
    assert found["components"] == ["gust"]
    assert found["calls"].get("gust") == called


@pytest.mark.slow
def test_calls_that_make_no_difference_are_said_of_runs_that_are_the_same(project):
    (project / "c.toml").write_text(
        'trials = ["t.toml"]\nkeep = "none"\n[grid]\n"gust.way" = ["generators", "environment"]\n',
        "utf-8",
    )
    done, found = twice(project, "c.toml", "--out", "out", "--jobs", "1")
    assert done.returncode == 0, done.stderr
    assert [each["difference"] for each in found] == ["", ""]
    generators, environment = (each["calls"]["gust"] for each in found)
    assert any(line.startswith("numpy.random.normal (parts.py:30 in step)") for line in generators)
    assert any(line.startswith("random.random (parts.py:30 in step)") for line in generators)
    assert environment == ["os.environ['GUST'] (parts.py:32 in step) 6 times"]


@pytest.mark.slow
def test_of_a_campaign_with_folders_one_case_that_differs_is_a_failure(project):
    (project / "c.toml").write_text(
        'trials = ["t.toml"]\n[grid]\n"gust.way" = ["", "clock"]\n', "utf-8"
    )
    done, found = twice(project, "c.toml", "--out", "out")
    assert done.returncode == 1
    assert [bool(each["difference"]) for each in found] == [False, True]


def test_a_repetition_may_last_ten_times_the_limit_of_its_run(project, tmp_path):
    text = COMPONENTS.replace("self.v = time.time() % 1.0", "time.sleep(60)")
    (project / "parts.py").write_text(text, "utf-8")
    trial = load_trial(str(project / "t.toml"), changes={"gust.way": "clock"})
    trial = trial.limited({"wall": "20 ms"}, "test")
    with pytest.raises(SimulationError, match="beyond 10 times its limit of 20 ms of wall time"):
        run_again(trial, "direct", tmp_path / "again", lambda: 0)


def test_a_run_that_keeps_to_wall_time_is_refused(project):
    (project / "t.toml").write_text(TRIAL.replace("[[", "real_time = { factor = 1.0 }\n[[", 1))
    done = command("run", "t.toml", "--twice", "--engine", "direct", cwd=project)
    assert (done.returncode, (project / "runs").exists()) == (2, False)
    assert "--twice: t keeps to wall time" in done.stderr


@pytest.mark.parametrize(
    ("count", "expected"), [(1, [0]), (5, [0, 1, 2, 3, 4]), (1001, [0, 250, 500, 750, 1000])]
)
def test_a_sample_has_the_first_and_the_last_case(count, expected):
    assert sample(count) == expected
