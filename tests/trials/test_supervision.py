"""Whatever a component does to its process: a result that says so, rows, and a caller that lives."""

from __future__ import annotations

import csv
import json
import logging
import os
import signal
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import seatrial as api
from seatrial.errors import InputError, SimulationError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running import run as running
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.measuring import measure_trial
from seatrial.trial.running.supervision import Supervisor, run_supervised
from tests.kit import needs_kits

from ..command import seatrial, seatrial_process
from ..fmi import crashing
from ..fmi.native import dying

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes are not copied there")

DEADLY = '''
"""Ends its process in one of many ways, or leaves it changed."""
import ctypes
import logging
import os
import signal
import sys
from pathlib import Path

from seatrial.model.component import Component, Output, Parameter


class Deadly(Component):
    """Counts its steps; dies from t = 0.3 s on, or in another call."""

    how = Parameter("fine", "1", "how it dies")
    where = Parameter("step", "1", "in which call")
    steps = Output("1", "steps", type=int)

    def start(self, t):
        self.count = 0
        self.do("start")

    def step(self, t, h):
        self.count += 1
        if t > 0.29:
            self.do("step")

    def close(self):
        self.do("close")

    def outputs(self, t):
        self.steps = self.count

    def do(self, where):
        if where != self.where:
            return
        match self.how:
            case "exit":
                ctypes.CDLL(None).exit(0)
            case "sys.exit":
                sys.exit(0)
            case "_exit":
                os._exit(0)
            case "abort":
                os.abort()
            case "segfault":
                ctypes.string_at(0)
            case "kill":
                os.kill(os.getpid(), signal.SIGKILL)
            case "spoil":
                with sorted(Path().glob("**/signals.csv"))[-1].open("a") as record:
                    record.write("nonsense\\n" * 2)
                os._exit(0)
            case "leave":
                os.chdir("/")
            case "fork":
                os.fork()
            case "say":
                print("from Python")
                logging.getLogger("seatrial.fmu.boat").warning("the bilge is wet")
'''
RIG = """
step = "100 ms"
[components]
boat = {{ fmu = "{fmu}" {keys} }}
"""
TRIAL = """
rig = "rig.toml"
stop = "1 s"
[[criteria]]
name = "it sails on"
check = "boat.steps >= 0"
"""
PACKAGE = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
 version="1.0" name="boat">
 <ssd:System name="all">
  <ssd:Elements>
   <ssd:Component name="boat" type="application/x-fmu-sharedlibrary" source="resources/crash.fmu"/>
  </ssd:Elements>
 </ssd:System>
 <ssd:DefaultExperiment startTime="0.0" stopTime="1.0"/>
</ssd:SystemStructureDescription>
"""
WriteTrial = Callable[..., str]


@pytest.fixture
def trial(write) -> WriteTrial:
    """Return a function that writes a trial of a boat that dies."""

    def trial(how: object, where: str = "step", fmu: str = "deadly.py:Deadly") -> str:
        write("deadly.py", DEADLY)
        values = f'how = "{how}", where = "{where}"' if isinstance(how, str) else f"how = {how}"
        write("rig.toml", RIG.format(fmu=fmu, keys=f", set = {{ {values} }}"))
        return str(write("trial.toml", TRIAL))

    return trial


def manifest(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "manifest.json").read_text())


def times(folder: Path) -> list[str]:
    with (folder / "signals.csv").open(newline="") as file:
        return [row[0] for row in csv.reader(file)][1:]


DEATHS = {
    "exit": "exited with status 0",
    "_exit": "exited with status 0",
    "abort": "was ended by SIGABRT",
    "segfault": "was ended by SIGSEGV",
    "kill": "was ended by SIGKILL (perhaps for lack of memory)",
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("engine", ["direct", pytest.param("fmu", marks=pytest.mark.interop)])
@pytest.mark.parametrize("how", DEATHS)
def test_a_death_in_a_step_is_a_failed_run(how: str, engine: str, trial, tmp_path: Path) -> None:
    trial(how)
    command = ["run", "trial.toml", "--out", "run", "--engine", engine]
    # What exit ends, other tests may have begun in this process: threads of a library.
    done = (seatrial_process if how == "exit" else seatrial)(*command, cwd=tmp_path)
    assert done.returncode == 3
    *progress, message = done.stderr.splitlines()
    assert all(" % of " in line or " %, " in line for line in progress), done.stderr
    assert message.startswith(f"seatrial: boat: the process of the run {DEATHS[how]}")
    assert message.endswith("in its step at t = 0.3 s")
    if how in ("abort", "segfault"):  # Python says where it was
        assert "deadly.py:" in message
    assert manifest(tmp_path / "run")["status"] == "failed"
    assert message.endswith(manifest(tmp_path / "run")["error"])
    assert times(tmp_path / "run") == ["0.0", "0.1", "0.2", "0.3"]
    assert (tmp_path / "run" / "report.html").is_file()


def test_a_death_as_the_folder_is_made_is_a_failed_run(trial, tmp_path, monkeypatch) -> None:
    """The folder is there, and the supervisor does not know it yet."""
    claimed = running.claim_folder

    def killed(*given: Any) -> Path:
        claimed(*given)
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError

    monkeypatch.setattr(running, "claim_folder", killed)
    result = run_supervised(load_trial(trial("fine")), tmp_path / "run", engine="direct")
    assert result.status == manifest(tmp_path / "run")["status"] == "failed"
    assert "was ended by SIGKILL" in str(result.error)


@pytest.mark.parametrize("how", [crashing.SEGFAULT, crashing.ABORT, crashing.EXIT])
def test_a_native_fmu_that_dies_is_a_failed_run(how, trial, native_fmu, tmp_path: Path) -> None:
    Path(trial(how, fmu=str(native_fmu("crash")))).write_text('rig = "rig.toml"\nstop = "1 s"\n')
    done = seatrial("run", "trial.toml", "--out", "run", cwd=tmp_path)
    assert done.returncode == 3
    assert "boat: the process of the run" in done.stderr
    assert "in its step at t = 0.3 s" in done.stderr
    assert manifest(tmp_path / "run")["status"] == "failed"
    assert times(tmp_path / "run") == ["0.0", "0.1", "0.2", "0.3"]


@pytest.mark.parametrize(
    ("where", "call", "rows"),
    [
        ("start", "its initialisation at t = 0.0 s", 0),
        ("close", "its termination at t = 0.9 s", 11),
    ],
)
def test_a_death_before_and_after_the_steps(where, call, rows, trial, tmp_path: Path) -> None:
    trial("_exit", where)
    done = seatrial("run", "trial.toml", "--out", "run", "--engine", "direct", cwd=tmp_path)
    assert done.returncode == 3
    assert f"boat: the process of the run exited with status 0 in {call}" in done.stderr
    assert manifest(tmp_path / "run")["status"] == "failed"
    there = (tmp_path / "run" / "signals.csv").is_file()
    assert (len(times(tmp_path / "run")) if there else 0) == rows
    assert (tmp_path / "run" / "report.html").is_file()


LAST_CALLS = {
    crashing.DIE_AT_THE_END: ("AT_THE_END", "its termination"),
    crashing.DIE_IN_THE_RELEASE: ("IN_THE_RELEASE", "its release"),
}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("isolated", [False, True])
@pytest.mark.parametrize("how", LAST_CALLS)
def test_an_fmu_that_dies_after_the_last_step_has_failed_the_run(
    how: int, isolated: bool, version: int, write, native_fmu, tmp_path: Path
) -> None:
    """Overwritten memory is often noticed only in the release: no verdict on such numbers."""
    where, call = LAST_CALLS[how]
    path, step = native_fmu("crash"), 0.1
    if version == 3:
        path = dying(native_fmu("fmi3"), tmp_path / f"{where}.fmu", where)
    keys = f", isolated = {str(isolated).lower()}"
    keys += f", set = {{ how = {how} }}" if version == 2 else ""
    write("rig.toml", RIG.format(fmu=path, keys=keys))
    write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
    done = seatrial("run", "trial.toml", "--out", "run", cwd=tmp_path)
    assert done.returncode == 3
    whose = "its process" if isolated else "the process of the run"
    assert f"boat: {whose} was ended by SIGABRT in {call}" in done.stderr
    assert manifest(tmp_path / "run")["status"] == "failed"
    assert "was ended by SIGABRT" in manifest(tmp_path / "run")["error"]
    assert len(times(tmp_path / "run")) == 1.0 / step + 1


def test_an_fmu_that_dies_in_its_release_has_failed_a_measured_run(
    write, native_fmu, tmp_path: Path
) -> None:
    keys = f", isolated = true, set = {{ how = {crashing.DIE_IN_THE_RELEASE} }}"
    write("rig.toml", RIG.format(fmu=native_fmu("crash"), keys=keys))
    trial = write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
    measured = measure_trial(load_trial(str(trial)))
    assert measured.status == "failed"
    assert "its release" in str(measured.error)
    simulation = api.Simulation(str(tmp_path / "rig.toml"))
    simulation.run("1 s")
    with pytest.raises(SimulationError, match="its release"):
        simulation.close()
    simulation.close()


def test_a_death_while_a_component_is_loaded_leaves_nothing(trial, write, tmp_path: Path) -> None:
    trial("fine")
    write("deadly.py", "import os\nos._exit(0)\n" + DEADLY)
    done = seatrial("run", "trial.toml", "--out", "run", "--engine", "direct", cwd=tmp_path)
    assert done.returncode == 3
    assert "exited with status 0 while it loaded boat (deadly.py:Deadly)" in done.stderr
    assert not (tmp_path / "run").exists()


def test_the_caller_of_the_api_lives(trial, tmp_path: Path) -> None:
    path = trial("_exit")
    with pytest.raises(SimulationError, match=r"exited with status 0 in its step at t = 0\.3 s"):
        api.run_trial(path, out=tmp_path / "run")
    assert not api.load_result(tmp_path / "run").passed
    assert len(api.load_result(tmp_path / "run").signals["boat.steps"]) == 4


@needs_kits("campaigns")
@pytest.mark.slow
@pytest.mark.parametrize("where", ["step", "start"])
def test_a_case_that_dies_does_not_end_its_campaign(where: str, trial, write, tmp_path) -> None:
    trial("fine", where)
    path = write(
        "campaign.toml",
        'trials = ["trial.toml"]\n[grid]\n"boat.how" = ["fine", "segfault", "leave", "fine"]\n',
    )
    result = api.run_campaign(path, out=tmp_path / "all")
    assert [case.status for case in result.cases] == ["complete", "failed", "complete", "complete"]
    assert [case.passed for case in result.cases] == [True, False, True, True]
    assert "SIGSEGV" in result.cases[1].result.manifest["error"]
    done = seatrial("run", "campaign.toml", "--out", "b", "--engine", "direct", cwd=tmp_path)
    assert done.returncode == 3
    assert "3 of 4 cases pass" in done.stdout


@needs_kits("campaigns")
@pytest.mark.slow
def test_a_failed_run_stays_one_if_its_report_cannot_be_made(trial, write, tmp_path: Path) -> None:
    trial("spoil")
    done = seatrial("run", "trial.toml", "--out", "run", "--engine", "direct", cwd=tmp_path)
    assert done.returncode == 3
    assert done.stderr.startswith("seatrial: boat: the process of the run exited with status 0")
    assert "note: cannot write the report: run/signals.csv, line" in done.stdout
    write("campaign.toml", 'trials = ["trial.toml"]\n[grid]\n"boat.how" = ["spoil", "fine"]\n')
    done = seatrial("run", "campaign.toml", "--out", "all", "--engine", "direct", cwd=tmp_path)
    assert done.returncode == 3
    assert "1 of 2 cases pass" in done.stdout


@pytest.mark.slow
@needs_kits("interchange")
def test_a_component_of_a_package_can_be_isolated(native_fmu, tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "boat.ssp", "w") as package:
        package.writestr("SystemStructure.ssd", PACKAGE)
        package.write(native_fmu("crash"), "resources/crash.fmu")
    options = ("--set", f"boat.how={crashing.SEGFAULT}", "--set", "step=100 ms")
    for isolated, said in (
        ("false", "boat: the process of the run was ended by SIGSEGV in its step"),
        ("true", "boat: its process was ended by SIGSEGV in step"),
    ):
        chosen = (*options, "--set", f"boat.isolated={isolated}", "--out", isolated)
        done = seatrial("run", "boat.ssp", *chosen, cwd=tmp_path)
        assert done.returncode == 3
        assert said in done.stderr
    done = seatrial("run", "boat.ssp", "--set", "boat.isolated=jailed", cwd=tmp_path)
    assert done.returncode == 2
    assert "--set: boat.isolated: true, false or 'sandboxed' is needed" in done.stderr


def test_a_component_that_leaves_the_folder_moves_nothing(trial, tmp_path: Path) -> None:
    trial("leave", "start")
    done = seatrial("run", "trial.toml", "--out", "run", "--engine", "direct", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "report: run/report.html" in done.stdout
    assert times(tmp_path / "run")[-1] == "1.0"


@pytest.mark.slow
@pytest.mark.parametrize("isolated", ["false", pytest.param("true", marks=pytest.mark.interop)])
def test_a_component_that_forks_is_there_once(isolated: str, trial, write, tmp_path: Path) -> None:
    trial("fork")
    keys = f', set = {{ how = "fork" }}, isolated = {isolated}'
    write("rig.toml", RIG.format(fmu="deadly.py:Deadly", keys=keys))
    done = seatrial("run", "trial.toml", "--out", "run", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(times(tmp_path / "run")) == 11


def test_what_is_printed_and_logged_reaches_the_caller(trial, caplog, capsys, tmp_path) -> None:
    with caplog.at_level(logging.INFO, "seatrial"):
        api.run_trial(trial("say"), out=tmp_path / "run")
    assert ("seatrial.fmu.boat", logging.WARNING, "the bilge is wet") in caplog.record_tuples
    assert capsys.readouterr().out.count("from Python\n") == 8 - 1


@pytest.mark.slow
def test_results_and_errors_are_those_of_a_run_in_this_process(trial, tmp_path: Path) -> None:
    loaded = load_trial(trial("fine"))
    shown: list[tuple[float, float]] = []
    hooks = Hooks(progress=lambda passed, whole: shown.append((passed, whole)))
    result = run_supervised(loaded, tmp_path / "run", engine="direct", hooks=hooks)
    assert (result.status, result.passed, result.folder) == ("complete", True, tmp_path / "run")
    assert [(name, check) for name, check, _ in result.verdicts] == [
        ("it sails on", "boat.steps >= 0")
    ]
    assert result.verdicts[0][2].limits[0].value == 0.0
    assert shown[-1] == (1.0, 1.0)
    assert set(result.wall) == {"assemble", "initialise", "run"}
    with pytest.raises(InputError, match="not an empty folder"):
        run_supervised(loaded, tmp_path / "run", engine="direct")


@pytest.mark.slow
def test_nothing_is_left_of_the_processes(trial, tmp_path: Path) -> None:
    loaded = load_trial(trial("segfault"))
    before = len(os.listdir("/proc/self/fd"))
    with Supervisor([loaded, loaded], "direct") as supervisor:
        for number in range(2):
            result = supervisor.run(number, tmp_path / str(number))
            assert result.status == "failed"
    assert len(os.listdir("/proc/self/fd")) == before
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)


def test_status_1_is_a_verdict_and_no_error_of_ours(tmp_path: Path) -> None:
    code = (
        "from seatrial.cli import commands, main\n"
        "commands.loaded = lambda name: 1 / 0\n"
        "import sys; sys.argv = ['seatrial', 'list']; main()\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 3
    assert "ZeroDivisionError" in done.stderr
