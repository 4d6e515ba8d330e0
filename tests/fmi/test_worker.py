"""The process of an isolated component, its parent, and signals."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from . import crashing
from .native import build_native_fmu

PARENT = """
import os, signal, sys, threading
from pathlib import Path
from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.fmi.loading.load import load_fmu

# A shell that runs the tests in the background has interrupts ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
instance = IsolatedInstance(load_fmu(Path(sys.argv[1])), "boat", 60.0)
instance.initialise(0.0, 1.0)
instance.begin()
instance.writer(["how"])([int(sys.argv[2])])
print(instance.pid, flush=True)
sys.stdin.read(1)
instance.step(0.5, 0.1)
print("stepped", flush=True)
sys.stdin.read(1)
instance.free()
"""


@pytest.fixture(scope="module")
def crash_fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_native_fmu("crash", tmp_path_factory.mktemp("crash"))


def parent(fmu: Path, how: int) -> tuple[subprocess.Popen[str], int]:
    """Start a process with an isolated instance; return it and the pid of the instance's."""
    process = subprocess.Popen(
        [sys.executable, "-c", PARENT, str(fmu), str(how)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        process_group=0,
    )  # fmt: skip
    assert process.stdout is not None
    return process, int(process.stdout.readline())


def lives(pid: int) -> bool:
    """Say if a process is there and is no zombie."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def until(condition: Callable[[], bool]) -> None:
    for _ in range(400):
        if condition():
            return
        time.sleep(0.05)
    raise AssertionError("waited in vain")


@pytest.mark.slow
@pytest.mark.parametrize("how", [crashing.FINE, crashing.HANG])
def test_a_worker_ends_with_its_parent(how: int, crash_fmu) -> None:
    process, pid = parent(crash_fmu, how)
    if how == crashing.HANG:
        process.stdin.write("\n")
        process.stdin.flush()
        time.sleep(0.5)  # it hangs in its step now, and answers nobody
    assert lives(pid)
    process.kill()
    process.communicate()
    until(lambda: not lives(pid))


def test_an_interrupt_in_the_terminal_does_not_reach_the_worker(crash_fmu) -> None:
    process, pid = parent(crash_fmu, crashing.FINE)
    assert os.getpgid(pid) != os.getpgid(process.pid)
    for number in (signal.SIGINT, signal.SIGTERM):
        os.kill(pid, number)
    out, err = process.communicate("\n\n", timeout=30)
    assert (out, err, process.returncode) == ("stepped\n", "", 0)


@pytest.mark.slow
def test_an_interrupt_ends_the_wait_and_the_worker(crash_fmu) -> None:
    process, pid = parent(crash_fmu, crashing.HANG)
    process.stdin.write("\n")
    process.stdin.flush()
    time.sleep(0.5)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert "KeyboardInterrupt" in err
    until(lambda: not lives(pid))
