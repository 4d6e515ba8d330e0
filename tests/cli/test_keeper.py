"""A run that does not get on, and is asked to end while it does not: the vehicle gets its neutral.

Orders come in every step; what is asserted is that the safe state is the last, and that nothing
comes after it for longer than the component that hung would have taken to go on.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.command import SEATRIAL, seatrial

from .gateway import RIG, SAFE, TALKER, Launched, Start, Vehicle
from .test_stop import child_of, has_ended, wait_for

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes and name spaces")

HANGER = '''
"""Hangs in one of many ways, in one of many calls, and goes on after 20 s."""
import ctypes
import re
import time
from pathlib import Path

from seatrial.model.component import Component, Output, Parameter


class Hanger(Component):
    """Counts its steps."""

    how = Parameter("", "1", "how it hangs")
    where = Parameter("step", "1", "in which call")
    steps = Output("1", "steps", type=int)

    def start(self, t):
        self.count = 0
        self.hang("start")

    def step(self, t, h):
        self.count += 1
        if self.count == 30:
            self.hang("step")

    def outputs(self, t):
        self.steps = self.count

    def close(self):
        self.hang("close")

    def hang(self, where):
        if where != self.where or not self.how:
            return
        Path("hanging").touch()
        match self.how:
            case "sleeps":
                time.sleep(20.0)
            case "is busy":
                until = time.monotonic() + 20.0
                while time.monotonic() < until:
                    pass
            case "holds the lock":
                ctypes.PyDLL(None).usleep(20_000_000)
            case "matches":
                re.match("(a?){27}a{27}", "a" * 27)
            case "ignores":
                until = time.monotonic() + 20.0
                while time.monotonic() < until:
                    try:
                        time.sleep(20.0)
                    except KeyboardInterrupt:
                        pass
'''
HANGING_RIG = f"""{RIG}
[components.hanger]
fmu = "hanger.py:Hanger"
set = {{{{ how = "{{how}}", where = "{{where}}" }}}}
"""
NAMESPACE = [
    "unshare",
    "--user",
    "--map-root-user",
    "--pid",
    "--fork",
    "--kill-child",
    "--mount-proc",
]
ENGINES = ["direct", pytest.param("fmu", marks=pytest.mark.interop)]


def has_namespaces() -> bool:
    if shutil.which("unshare") is None:
        return False
    return subprocess.run([*NAMESPACE, "true"], capture_output=True).returncode == 0


in_namespace = pytest.mark.skipif(
    not has_namespaces(), reason="no name space of processes can be made here (unshare)"
)


@pytest.fixture
def start(write, vehicle: Vehicle, launched: Launched, tmp_path: Path) -> Start:
    """Return a function that starts a run of the vehicle beside a component that hangs."""
    write("talker.py", TALKER)
    write("hanger.py", HANGER)
    write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')

    def start(
        how: str = "sleeps", where: str = "step", *options: str, within: tuple[str, ...] = ()
    ) -> subprocess.Popen[str]:
        values = {"isolated": "false", "device": vehicle.device, "safe": SAFE.hex()}
        text = HANGING_RIG.format(**values, start_takes=0.0, how=how, where=where)
        write("rig.toml", text)
        (tmp_path / "hanging").unlink(missing_ok=True)
        shutil.rmtree(tmp_path / "run", ignore_errors=True)
        options = options or ("--engine", "direct")
        command = (SEATRIAL, "run", "trial.toml", "--real-time", "1", "--hardware", "--out", "run")
        return launched(*within, *command, *options, start_new_session=True)

    return start


def hanging(tmp_path: Path) -> None:
    wait_for((tmp_path / "hanging").is_file)


def is_last(vehicle: Vehicle, for_s: float = 0.5) -> None:
    """Check that the safe state comes, and that nothing comes after it."""
    wait_for(lambda: SAFE in vehicle.read())
    time.sleep(for_s)
    assert vehicle.read().endswith(SAFE)


def keeper_of(process: subprocess.Popen[str]) -> int:
    """Return the keeper of a run: the process that has the run's end of no terminal, by name."""
    ours = Path(f"/proc/{process.pid}/cwd").resolve()
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if (place / "comm").read_text() == "keeper-of-links\n" and (
                place / "cwd"
            ).resolve() == ours:
                return int(place.name)
        except OSError:
            continue
    pytest.fail("there is no keeper")


# ---------------------------------------------------------------------- a hang


@pytest.mark.sampled(5)
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    "how",
    [
        pytest.param("sleeps", marks=pytest.mark.interop),
        pytest.param("is busy", marks=pytest.mark.interop),
        "holds the lock",
        pytest.param("matches", marks=pytest.mark.interop),
    ],
)
def test_a_hang_in_a_step_ends_the_run(
    how: str, engine: str, start: Start, vehicle: Vehicle, tmp_path: Path
) -> None:
    process = start(how, "step", "--engine", engine)
    hanging(tmp_path)
    begun = time.monotonic()
    is_last(vehicle)
    assert time.monotonic() - begun < 15.0  # not when it goes on
    assert vehicle.read().count(b"!") >= 25
    _, message = process.communicate(timeout=60)
    assert process.returncode == 3
    assert "hanger: its step at t = 0.29 s hung: no progress for 2 s (limit.call)" in message
    assert f"sent the safe state of port to serial:{vehicle.device}:115200" in message
    assert '"status": "failed"' in (tmp_path / "run" / "manifest.json").read_text()


@pytest.mark.slow
def test_a_hang_in_the_start_ends_the_run(start: Start, vehicle: Vehicle, tmp_path: Path) -> None:
    process = start("sleeps", "start", "--engine", "direct", "--limit", "call=1 s")
    is_last(vehicle)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 3
    assert "hanger: its initialisation at t = 0.0 s hung" in message
    assert '"status": "failed"' in (tmp_path / "run" / "manifest.json").read_text()


@pytest.mark.interop
def test_a_hang_at_the_end_ends_the_run(start: Start, vehicle: Vehicle, tmp_path: Path) -> None:
    process = start("ignores", "close", "--engine", "direct", "--limit", "call=1 s")
    wait_for(lambda: b"!!!" in vehicle.read())
    process.send_signal(signal.SIGINT)
    is_last(vehicle)
    process.communicate(timeout=60)
    assert process.returncode == 3


@pytest.mark.slow
def test_all_that_is_called_seatrial_is_killed_at_once(
    start: Start, vehicle: Vehicle, tmp_path: Path
) -> None:
    """As ``pkill -9 -f seatrial`` does, of the processes of this test."""
    process = start("")
    wait_for(lambda: b"!!!" in vehicle.read())
    keeper_of(process)
    named = []
    for place in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            called = (place / "comm").read_bytes() + (place / "cmdline").read_bytes()
            if (place / "cwd").resolve() == tmp_path and b"seatrial" in called:
                named.append(int(place.name))
    assert len(named) >= 2
    for pid in named:
        os.kill(pid, signal.SIGKILL)
    is_last(vehicle)


def write_hanger(write, *, stop: str, how: str, longest: str = "20.0") -> None:
    """Write the trial of a component that hangs, alone."""
    write("hanger.py", HANGER.replace("time.sleep(20.0)", f"time.sleep({longest})"))
    write("rig.toml", 'step = "10 ms"\n[components]\nhanger = { fmu = "hanger.py:Hanger" }\n')
    write("trial.toml", f'rig = "rig.toml"\nstop = "{stop}"\n[set]\n"hanger.how" = "{how}"\n')


def test_a_hang_without_hardware_ends_the_run(write, tmp_path: Path) -> None:
    write_hanger(write, stop="10 s", how="holds the lock")
    arguments = ("--engine", "direct", "--limit", "call=0.5 s", "--out", "run")
    done = seatrial("run", "trial.toml", *arguments, cwd=tmp_path)
    assert done.returncode == 3
    assert "hanger: its step at t = 0.29 s hung: no progress for 0.5 s (limit.call)" in done.stderr
    lines = (tmp_path / "run" / "signals.csv").read_text().splitlines()
    assert len(lines) == 31
    refused = seatrial("run", "trial.toml", "--hardware", "--limit", "call=none", cwd=tmp_path)
    assert refused.returncode == 2
    assert "a device needs a limit" in refused.stderr


@pytest.mark.slow
def test_a_slow_step_is_no_hang(write, tmp_path: Path) -> None:
    write_hanger(write, stop="0.5 s", how="sleeps", longest="1.0")
    for limit in ("10 s", "none"):
        arguments = ("--engine", "direct", "--limit", f"call={limit}", "--out", f"run-{limit}")
        assert seatrial("run", "trial.toml", *arguments, cwd=tmp_path).returncode == 0


@pytest.mark.slow
def test_a_run_that_is_suspended_leaves_no_order(start: Start, vehicle: Vehicle) -> None:
    process = start("")
    wait_for(lambda: b"!!!" in vehicle.read())
    child = child_of(process)
    os.kill(child, signal.SIGSTOP)
    is_last(vehicle)
    process.communicate(timeout=60)
    assert process.returncode == 3


@pytest.mark.slow
def test_a_simulation_that_is_suspended_goes_on(write, tmp_path: Path) -> None:
    write_hanger(write, stop="2 s", how="")
    command = [SEATRIAL, "run", "trial.toml", "--engine", "direct", "--real-time", "1"]
    process = subprocess.Popen([*command, "--limit", "call=0.5 s", "--out", "run"], cwd=tmp_path)
    wait_for((tmp_path / "run").is_dir)
    child = child_of(process)
    for pid in (process.pid, child):
        os.kill(pid, signal.SIGSTOP)
    time.sleep(1.5)
    for pid in (process.pid, child):
        os.kill(pid, signal.SIGCONT)
    assert process.wait(60) == 0


# ---------------------------------------------------------------------- requests to stop


@pytest.mark.slow
@pytest.mark.parametrize(
    "number",
    [
        signal.SIGTERM,
        pytest.param(signal.SIGHUP, marks=pytest.mark.interop),
        pytest.param(signal.SIGQUIT, marks=pytest.mark.interop),
        pytest.param(signal.SIGINT, marks=pytest.mark.interop),
    ],
)
def test_a_signal_to_the_process_of_the_run_ends_it_in_order(
    number: int, start: Start, vehicle: Vehicle, tmp_path: Path
) -> None:
    process = start("")
    wait_for(lambda: b"!!!" in vehicle.read())
    child = child_of(process)
    os.kill(child, number)
    _, message = process.communicate(timeout=60)
    assert (process.returncode, "stopped" in message) == (3, True), message
    assert vehicle.read().endswith(SAFE)
    assert '"status": "stopped"' in (tmp_path / "run" / "manifest.json").read_text()
    assert (tmp_path / "run" / "report.html").is_file()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("how", "whose"),
    [
        ("ignores", "supervisor"),
        pytest.param("sleeps", "supervisor", marks=pytest.mark.interop),
        pytest.param("sleeps", "child", marks=pytest.mark.interop),
        ("holds the lock", "child"),
    ],
)
def test_one_signal_ends_a_hang_in_bounded_time(
    how: str, whose: str, start: Start, vehicle: Vehicle, tmp_path: Path
) -> None:
    process = start(how, "step", "--engine", "direct", "--limit", "call=100 s")
    hanging(tmp_path)
    child = child_of(process)
    os.kill(child if whose == "child" else process.pid, signal.SIGTERM)
    begun = time.monotonic()
    is_last(vehicle)
    process.communicate(timeout=60)
    assert time.monotonic() - begun < 15.0
    assert process.returncode == 3
    assert '"status": "stopped"' in (tmp_path / "run" / "manifest.json").read_text()


@pytest.mark.slow
def test_one_signal_ends_a_hung_simulation(write, tmp_path: Path) -> None:
    write_hanger(write, stop="10 s", how="holds the lock")
    command = [SEATRIAL, "run", "trial.toml", "--engine", "direct", "--out", "run"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    hanging(tmp_path)
    process.send_signal(signal.SIGTERM)
    begun = time.monotonic()
    process.communicate(timeout=60)
    assert time.monotonic() - begun < 15.0
    assert process.returncode == 3
    assert '"status": "stopped"' in (tmp_path / "run" / "manifest.json").read_text()


# ---------------------------------------------------------------------- deaths


@pytest.mark.slow
@pytest.mark.parametrize("how", ["", pytest.param("holds the lock", marks=pytest.mark.interop)])
def test_a_group_that_is_killed_leaves_the_safe_state(
    how: str, start: Start, vehicle: Vehicle, tmp_path: Path
) -> None:
    process = start(how)
    wait_for(lambda: b"!!!" in vehicle.read())
    if how:
        hanging(tmp_path)
    os.killpg(process.pid, signal.SIGKILL)
    is_last(vehicle)


@pytest.mark.slow
def test_a_hung_run_whose_supervisor_is_suspended_or_killed(
    start: Start, vehicle: Vehicle, tmp_path: Path
) -> None:
    process = start("holds the lock", "step", "--engine", "direct", "--limit", "call=5 s")
    hanging(tmp_path)
    child = child_of(process)
    os.kill(process.pid, signal.SIGSTOP)
    is_last(vehicle)
    wait_for(lambda: has_ended(child))
    os.kill(process.pid, signal.SIGKILL)


@pytest.mark.slow
def test_a_keeper_that_is_killed_ends_the_run(start: Start, vehicle: Vehicle) -> None:
    process = start("")
    wait_for(lambda: b"!!!" in vehicle.read())
    keeper = keeper_of(process)
    assert os.getsid(keeper) != os.getsid(process.pid)
    os.kill(keeper, signal.SIGTERM)  # it is meant for the others
    before = len(vehicle.read())
    wait_for(lambda: len(vehicle.read()) > before + 10)
    os.kill(keeper, signal.SIGKILL)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 3
    assert "the keeper of the safe states was killed" in message
    assert vehicle.read().endswith(SAFE)


@pytest.mark.slow
def test_no_keeper_is_left(start: Start, vehicle: Vehicle) -> None:
    process = start("")
    wait_for(lambda: b"!!!" in vehicle.read())
    keeper = keeper_of(process)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    wait_for(lambda: has_ended(keeper))


# ---------------------------------------------------------------------- containers


def container_stops(process: subprocess.Popen[str]) -> float:
    """Do what ``docker stop`` does to process 1 of a name space; return how long that took, s."""
    first = child_of(process)
    begun = time.monotonic()
    os.kill(first, signal.SIGTERM)
    while not has_ended(first) and time.monotonic() < begun + 10.0:
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)  # and, by --kill-child, all that is inside
    process.communicate(timeout=60)
    return time.monotonic() - begun


@pytest.mark.slow
@in_namespace
@pytest.mark.parametrize(
    ("how", "where"),
    [
        ("holds the lock", "start"),
        ("ignores", "step"),
        pytest.param("", "step", marks=pytest.mark.interop),
    ],
)
def test_a_container_that_is_stopped_leaves_the_safe_state(
    how: str, where: str, start: Start, vehicle: Vehicle, tmp_path: Path
) -> None:
    stop_container(how, where, start, vehicle, tmp_path)


@in_namespace
@pytest.mark.long
@pytest.mark.parametrize("engine", ["direct", "fmu"])
@pytest.mark.parametrize("where", ["start", "step"])
def test_twenty_of_twenty_containers_leave_the_safe_state(
    where: str, engine: str, start: Start, vehicle: Vehicle, tmp_path: Path
) -> None:
    ways = ["sleeps", "is busy", "holds the lock", "ignores", ""]
    for number in range(20):
        vehicle.received = b""
        stop_container(ways[number % len(ways)], where, start, vehicle, tmp_path, engine)


def stop_container(
    how: str, where: str, start: Start, vehicle: Vehicle, tmp_path: Path, engine: str = "direct"
) -> None:
    options = ("--engine", engine, "--limit", "call=100 s")
    process = start(how, where, *options, within=tuple(NAMESPACE))
    if how:
        hanging(tmp_path)
    if where == "step" or not how:
        wait_for(lambda: b"!!!" in vehicle.read())
    took = container_stops(process)
    assert vehicle.read().endswith(SAFE)
    assert took < 10.0
