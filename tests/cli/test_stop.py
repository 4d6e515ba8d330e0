"""Signals, sent to real processes: every run leaves a whole record, or nothing."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.command import SEATRIAL, seatrial
from tests.kit import needs_kits

COMPONENT = '''
"""Takes its time."""
import time
from pathlib import Path

from seatrial.model.component import Component, Output, Parameter


class Slow(Component):
    """Sleeps in every step, or hangs in one; may be slow to start."""

    step_takes = Parameter(0.01, "s", "wall time of a step")
    start_takes = Parameter(0.0, "s", "wall time of the start")
    hangs_at = Parameter(1e9, "s", "a step that never ends")
    y = Output("m", "time")

    def start(self, t):
        if self.start_takes:
            Path("starting").touch()
            time.sleep(self.start_takes)

    def step(self, t, h):
        if t >= self.hangs_at:
            Path("hanging").touch()
            time.sleep(1000.0)
        time.sleep(self.step_takes)

    def outputs(self, t):
        self.y = t
'''
Start = Callable[..., subprocess.Popen[str]]


@pytest.fixture
def start(write, tmp_path: Path) -> Iterator[Start]:
    """Return a function that starts ``seatrial`` on files of a slow boat, in their folder."""
    write("slow.py", COMPONENT)
    write("rig.toml", 'step = "10 ms"\n[components]\nboat = { fmu = "slow.py:Slow" }\n')
    write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')
    write("campaign.toml", 'trials = ["trial.toml"]\n[grid]\nseed = [1, 2, 3]\n')
    processes = []

    def start(*arguments: str) -> subprocess.Popen[str]:
        pipe = subprocess.PIPE
        command = [SEATRIAL, *arguments]
        processes.append(
            subprocess.Popen(command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True)
        )
        return processes[-1]

    yield start
    for process in processes:
        process.kill()
        process.communicate()


def wait_for(condition: Callable[[], bool]) -> None:
    for _ in range(1200):
        if condition():
            return
        time.sleep(0.05)
    pytest.fail("waited for a minute")


def has_status(folder: Path, status: str = "running") -> bool:
    """Say whether the run has written its manifest, with that status."""
    manifest = folder / "manifest.json"
    return manifest.is_file() and f'"status": "{status}"' in manifest.read_text("utf-8")


def rows_of(folder: Path) -> int:
    """Return how many rows the record has so far."""
    signals = folder / "signals.csv"
    return len(signals.read_text("utf-8").splitlines()) - 1 if signals.is_file() else 0


def stopped(process: subprocess.Popen[str]) -> str:
    """Return what was output by a process that must end stopped."""
    _, output = process.communicate(timeout=60)
    assert process.returncode == 3, output
    assert "stopped" in output
    assert "Traceback" not in output
    return output


def assert_whole(folder: Path, rows: int) -> None:
    """Check that a stopped run left everything that a run leaves, with whole lines."""
    assert {p.name for p in folder.iterdir()} == {
        "signals.csv", "manifest.json", "timing.json", "report.html"
    }  # fmt: skip
    page = (folder / "report.html").read_text("utf-8")
    assert "NOT EVALUATED" in page
    assert "FAILED" not in page
    text = (folder / "signals.csv").read_text("utf-8")
    lines = text.splitlines()
    assert text.endswith("\n")
    assert len(lines) > rows
    assert all(line.count(",") == 1 for line in lines)
    assert has_status(folder, "stopped")
    timing = json.loads((folder / "timing.json").read_text("utf-8"))
    assert timing["step_times"]["boat"]["steps"] == timing["steps"]
    assert "run stopped" in (folder / "report.html").read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(("number", "engine"), [(signal.SIGINT, "fmu"), (signal.SIGTERM, "direct")])
def test_a_signal_leaves_a_whole_record(number: int, engine: str, start, tmp_path: Path) -> None:
    process = start("run", "trial.toml", "--out", "run", "--engine", engine)
    wait_for(lambda: has_status(tmp_path / "run"))
    time.sleep(0.5)
    process.send_signal(number)
    stopped(process)
    assert_whole(tmp_path / "run", 10)


@pytest.mark.slow
def test_a_signal_ends_a_wait(start, tmp_path: Path) -> None:
    pace = ("--real-time", "0.0001")  # 100 s of waiting for each step
    process = start("run", "trial.toml", "--out", "run", "--engine", "direct", *pace)
    wait_for(lambda: has_status(tmp_path / "run"))
    time.sleep(0.3)
    sent = time.monotonic()
    process.send_signal(signal.SIGTERM)
    stopped(process)
    assert time.monotonic() - sent < 30
    assert_whole(tmp_path / "run", 1)


@needs_kits("campaigns")
@pytest.mark.slow
def test_a_signal_ends_a_campaign_in_its_case(start, tmp_path: Path) -> None:
    process = start("run", "campaign.toml", "--out", "all", "--engine", "direct", "--jobs", "1")
    wait_for(lambda: any(has_status(folder) for folder in (tmp_path / "all").glob("01-*")))
    process.send_signal(signal.SIGTERM)
    assert "0 of 3 cases came to an end: --out all --resume goes on" in stopped(process)
    (case,) = (tmp_path / "all").glob("0*")
    assert_whole(case, 1)
    assert (tmp_path / "all" / "report.html").is_file()


@needs_kits("campaigns")
@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["campaign.toml", pytest.param("trial.toml", marks=pytest.mark.interop)]
)
def test_a_signal_during_initialisation_leaves_no_run(name: str, start, tmp_path: Path) -> None:
    rig = tmp_path / "rig.toml"
    rig.write_text(rig.read_text().replace('Slow"', 'Slow", set = { start_takes = 1.0 }'))
    process = start("run", name, "--out", "run", "--engine", "direct")
    wait_for((tmp_path / "starting").is_file)
    process.send_signal(signal.SIGINT)
    stopped(process)
    left = {p.name for p in (tmp_path / "run").glob("*")}
    assert left == (
        {"campaign.json", "plotly.js", "report.html"} if name == "campaign.toml" else set()
    )
    assert (tmp_path / "run").exists() == (name == "campaign.toml")


@pytest.mark.interop
@pytest.mark.parametrize("engine", ["fmu", "direct"])
def test_a_second_signal_ends_a_component_that_hangs(engine, start, tmp_path: Path) -> None:
    hang = ("--set", "boat.hangs_at=0.045")
    process = start("run", "trial.toml", "--out", "run", "--engine", engine, *hang)
    wait_for((tmp_path / "hanging").is_file)
    process.send_signal(signal.SIGINT)
    time.sleep(0.3)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    stopped(process)
    assert has_status(tmp_path / "run", "stopped")
    assert len((tmp_path / "run" / "signals.csv").read_text().splitlines()) == 7
    assert (tmp_path / "run" / "timing.json").is_file()
    assert "run stopped" in (tmp_path / "run" / "report.html").read_text("utf-8")


@pytest.mark.interop
@pytest.mark.parametrize("isolated", ["false", "true"])
@pytest.mark.parametrize("gap_s", [0.0, 0.003, 0.03])
def test_two_signals_leave_a_whole_record_too(
    gap_s: float, isolated: str, start, tmp_path: Path
) -> None:
    # As `timeout` sends them, and people who press twice.
    rig = tmp_path / "rig.toml"
    rig.write_text(rig.read_text().replace('Slow"', f'Slow", isolated = {isolated}'))
    process = start("run", "trial.toml", "--out", "run")
    wait_for(lambda: rows_of(tmp_path / "run") > 10)
    for _ in range(2):
        process.send_signal(signal.SIGTERM)
        time.sleep(gap_s)
    stopped(process)
    assert_whole(tmp_path / "run", 10)


@pytest.mark.slow
def test_signals_up_to_the_very_end_leave_status_and_message(start, tmp_path: Path) -> None:
    # A late one must not kill the program between its message and its end.
    process = start("run", "trial.toml", "--out", "run", "--engine", "direct")
    wait_for(lambda: rows_of(tmp_path / "run") > 10)
    deadline = time.monotonic() + 60
    while process.poll() is None and time.monotonic() < deadline:
        process.send_signal(signal.SIGTERM)
        time.sleep(0.002)
    stopped(process)
    assert_whole(tmp_path / "run", 10)


PACES = [
    pytest.param([], 10, id="free"),
    # 100 s of waiting for each step
    pytest.param(["--real-time", "0.0001"], 1, id="waiting", marks=pytest.mark.interop),
]


def children_of(process: subprocess.Popen[str]) -> list[int]:
    """Return the processes that a process has started."""
    listed = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text("utf-8")
    return [int(pid) for pid in listed.split()]


def child_of(process: subprocess.Popen[str]) -> int:
    """Return the process of the run: while a keeper is made, there is another one."""
    found: list[int] = []

    def one() -> bool:
        found[:] = [pid for pid in children_of(process) if not has_ended(pid)]
        return len(found) == 1

    wait_for(one)
    return found[0]


def has_ended(pid: int) -> bool:
    stat = Path(f"/proc/{pid}/stat")
    return not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "Z"


@pytest.mark.parametrize(("pace", "rows"), PACES)
def test_a_run_whose_supervisor_is_killed_ends_in_order(
    pace, rows: int, start, tmp_path: Path
) -> None:
    process = start("run", "trial.toml", "--out", "run", "--engine", "direct", *pace)
    wait_for(lambda: rows_of(tmp_path / "run") >= rows)
    child = child_of(process)
    os.kill(process.pid, signal.SIGKILL)
    wait_for(lambda: has_ended(child))
    assert has_status(tmp_path / "run", "stopped")
    done = seatrial("report", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert_whole(tmp_path / "run", rows)


@pytest.mark.slow
def test_a_suspended_run_whose_supervisor_is_killed_ends_when_it_goes_on(
    start, tmp_path: Path
) -> None:
    process = start("run", "trial.toml", "--out", "run", "--engine", "direct")
    wait_for(lambda: rows_of(tmp_path / "run") >= 10)
    child = child_of(process)
    os.kill(child, signal.SIGSTOP)
    os.kill(process.pid, signal.SIGKILL)
    assert process.wait(60) == -signal.SIGKILL
    assert has_status(tmp_path / "run", "running")
    os.kill(child, signal.SIGCONT)
    wait_for(lambda: has_ended(child))
    assert has_status(tmp_path / "run", "stopped")


@pytest.mark.parametrize(("pace", "rows"), PACES)
def test_a_run_of_which_all_is_killed_is_whole_up_to_its_last_row(
    pace, rows: int, start, tmp_path: Path
) -> None:
    process = start("run", "trial.toml", "--out", "run", "--engine", "direct", *pace)
    wait_for(lambda: rows_of(tmp_path / "run") >= rows)
    child = child_of(process)
    os.kill(child, signal.SIGSTOP)  # it cannot do anything any more
    for pid in (process.pid, child):
        os.kill(pid, signal.SIGKILL)
    process.communicate()
    assert has_status(tmp_path / "run", "running")
    lines = (tmp_path / "run" / "signals.csv").read_text("utf-8").splitlines()
    assert lines[:2] == ["time,boat.y", "0.0,0.0"]
    assert all(line.count(",") == 1 for line in lines)
    done = seatrial("report", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "run" / "report.html").read_text("utf-8")
    assert "The run has not ended, or was killed." in page
    assert "timing.json is missing" in page


@pytest.mark.slow
def test_nobody_reads_what_is_printed_and_the_status_is_the_verdict(write, tmp_path: Path) -> None:
    write("still.py", COMPONENT)
    write("rig.toml", 'step = "10 ms"\n[components]\nboat = { fmu = "still.py:Slow" }\n')
    criterion = '[[criteria]]\nname = "it ends"\ncheck = "finally boat.y > 0 m"\n'
    write("trial.toml", f'rig = "rig.toml"\nstop = "20 ms"\n{criterion}')
    ours, theirs = os.pipe()
    os.close(ours)
    command = [SEATRIAL, "run", "trial.toml", "--engine", "direct", "--out", "run"]
    done = subprocess.run(command, cwd=tmp_path, stdout=theirs, stderr=subprocess.PIPE, text=True)
    os.close(theirs)
    assert done.returncode == 0, done.stderr
    assert "seatrial:" not in done.stderr  # a slow machine shows its progress there
    assert (tmp_path / "run" / "report.html").is_file()


INTERRUPTED = {
    "function": "lambda *_, **__: os.kill(os.getpid(), signal.SIGINT)",
    # What Python 3.11 makes an error of its own of: modules that are imported late have many.
    "class body": "lambda *_, **__: type('A', (), {'field': Field()})",
}


@pytest.mark.parametrize("where", INTERRUPTED)
def test_a_signal_before_a_command_heeds_any_is_one_message(where: str, tmp_path: Path) -> None:
    code = (
        "import os, signal, seatrial.cli.running.run as run\n"
        "from seatrial.cli import main\n"
        "class Field:\n"
        "    def __set_name__(self, *_):\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        f"run.load_trial = {INTERRUPTED[where]}\n"
        "main()\n"
    )
    command = [sys.executable, "-c", code, "run", "square"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (3, "seatrial: stopped\n")
