"""Trials with FMUs of others: interfaces, structural parameters, simulations that an FMU ends."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import fmpy
import pytest
from typer.testing import CliRunner

from seatrial import Simulation
from seatrial.cli.main import app
from seatrial.errors import InputError, SimulationError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from tests.fmi.models import build_model_fmu

TRIAL = """
rig = "rig.toml"
stop = "1 s"
[[criteria]]
name = "it decays"
check = "boat.x < 1.1"
"""
RIG = """
step = "0.1 s"
[components.boat]
fmu = "{path}"
{more}
[components.other]
fmu = "{path}"
{other}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("models")


@pytest.fixture
def run(write, tmp_path: Path):
    """Return a function that runs a rig of two instances of an FMU."""

    def run(path: Path, more: str = "", other: str = "", trial: str = TRIAL):
        write("rig.toml", RIG.format(path=path, more=more, other=other or more))
        return run_trial(load_trial(str(write("trial.toml", trial))), tmp_path / "out")

    return run


def rows(folder: Path) -> list[dict[str, str]]:
    return list(csv.DictReader((folder / "signals.csv").open()))


@pytest.mark.parametrize("version", [1, 2, 3])
def test_a_trial_in_model_exchange(run, folder: Path, version: int) -> None:
    result = run(
        build_model_fmu(version, folder),
        'interface = "model exchange"\ntolerance = 1e-9\nset.k = 2.0',
        'isolated = true\ninterface = "model exchange"\ntolerance = 1e-9\nset.k = 2.0',
    )
    assert result.passed
    last = rows(result.folder)[-1]
    assert float(last["boat.x"]) == pytest.approx(math.exp(-2.0), abs=1e-7)
    assert last["other.x"] == last["boat.x"]
    assert last["boat.steps"] == "4"


ENDING = {
    "co-simulation": 'interface = "co-simulation"\nset.end = 0.42',
    "model exchange": 'interface = "model exchange"\nset.end = 0.42',
    "isolated": "isolated = true\nset.end = 0.42",
}


@pytest.mark.parametrize("how", ENDING)
def test_a_run_that_an_fmu_ends_keeps_its_last_row(run, folder: Path, how: str) -> None:
    result = run(build_model_fmu(2, folder), ENDING[how], "set.k = 1.0")
    assert result.status == "ended by boat"
    assert result.passed
    assert json.loads((result.folder / "manifest.json").read_text())["status"] == "ended by boat"
    last = rows(result.folder)[-1]
    assert [float(last[name]) for name in ("time", "boat.x", "other.x")] == [
        pytest.approx(0.5),
        pytest.approx(math.exp(-0.42), abs=1e-6),
        pytest.approx(math.exp(-0.5)),
    ]
    assert any("boat ended the simulation at t = 0.42" in note for note in result.notes)
    assert load_run(result.folder).passed


def test_criteria_hold_on_what_there_is(run, folder: Path) -> None:
    trial = TRIAL.replace('"boat.x < 1.1"', '"finally boat.x < 0.5"')
    result = run(build_model_fmu(2, folder), "set.end = 0.42", "set.k = 1.0", trial)
    assert result.status == "ended by boat"
    assert not result.passed


@pytest.mark.slow
def test_the_exit_status_is_that_of_the_verdicts(folder: Path, write, tmp_path: Path) -> None:
    path = build_model_fmu(2, folder)
    write("rig.toml", RIG.format(path=path, more="set.end = 0.42", other="set.k = 1.0"))
    trial = str(write("trial.toml", TRIAL))
    ended = CliRunner().invoke(app, ["run", trial, "--out", str(tmp_path / "whole")])
    assert ended.exit_code == 0
    write("trial.toml", TRIAL.replace("< 1.1", "< 0.9"))
    broken = CliRunner().invoke(app, ["run", trial, "--out", str(tmp_path / "broken")])
    assert broken.exit_code == 1
    assert "ENDED BY BOAT" in broken.output


def test_an_end_at_the_stop_time_is_a_complete_run(run, folder: Path) -> None:
    result = run(build_model_fmu(2, folder), "set.end = 1.0", "set.k = 1.0")
    assert result.status == "complete"


def test_structural_parameters_are_set_before_sizes(run, native_fmu) -> None:
    inputs = "[components.boat.set]\nrows = 2\nmatrix = [1.0, 2.0, 3.0, 4.0]"
    trial = TRIAL + '[record]\nsignals = ["boat.transpose*"]'
    result = run(native_fmu("fmi3"), inputs, "set.rows = 1", trial)
    assert rows(result.folder)[-1] == {
        "time": "1.0",
        "boat.transpose[1,1]": "1.0",
        "boat.transpose[1,2]": "3.0",
        "boat.transpose[2,1]": "2.0",
        "boat.transpose[2,2]": "4.0",
    }
    given = json.loads((result.folder / "manifest.json").read_text())["components"]["boat"]
    assert given["parameters"]["rows"]["value"] == 2


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ('interface = "model"', "interface: .*'co-simulation' or 'model exchange'"),
        ("tolerance = 0.0", "tolerance"),
        ('interface = "model exchange"', r"fmi3\.fmu has no model exchange, only co-simulation"),
        ("set.rows = -1", r"set\.rows: a whole number from 0 to"),
    ],
)
def test_settings_that_do_not_fit(run, native_fmu, more: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        run(native_fmu("fmi3"), more, "set.k = 1.0")


def test_a_trial_cannot_change_sizes(run, native_fmu) -> None:
    with pytest.raises(InputError, match=r"rows is a structural parameter, .*table of its rig"):
        run(native_fmu("fmi3"), "set.rows = 2", "set.k = 1.0", TRIAL + "[set]\n'boat.rows' = 3")


def test_components_in_python_have_one_interface(run) -> None:
    with pytest.raises(InputError, match="the key 'tolerance' is for FMUs of others"):
        run(Path("servo"), "tolerance = 1e-3", "isolated = false")


def test_a_simulation_that_an_fmu_ended_can_be_read_and_closed(folder: Path, write) -> None:
    path = build_model_fmu(2, folder)
    rig = write("rig.toml", RIG.format(path=path, more="set.end = 0.42", other="set.k = 1.0"))
    with Simulation(str(rig), engine="fmu") as simulation:
        with pytest.raises(SimulationError, match=r"boat ended the simulation at t = 0\.42 s"):
            simulation.run(1.0)
        assert simulation.time == 0.5
        assert simulation.get("other.x") == pytest.approx(math.exp(-0.5))


def test_describe_names_version_interfaces_and_platforms(folder: Path) -> None:
    shown = CliRunner().invoke(app, ["fmu", "describe", str(build_model_fmu(2, folder))])
    assert (
        f"FMI 2.0, co-simulation and model exchange; binaries for {fmpy.platform}" in shown.output
    )
