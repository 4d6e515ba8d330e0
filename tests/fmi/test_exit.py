"""End of a process that had an FMU in it."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HOST = """
import fmpy, sys
fmpy.simulate_fmu(sys.argv[1], stop_time=0.05)
print("done", flush=True)
"""


@pytest.mark.slow
def test_python_hosts_end_well(counter_fmu: Path) -> None:
    for _ in range(3):
        command = [sys.executable, "-c", HOST, str(counter_fmu)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.strip().endswith("done")


@pytest.mark.long
def test_nothing_is_released_twice(counter_fmu: Path) -> None:
    """pythonfmu's library, left to itself, reads and writes freed memory when it is unloaded."""
    assert shutil.which("valgrind"), "valgrind is needed: on Debian, apt install valgrind"
    command = ["valgrind", "--error-limit=no", sys.executable, "-c", HOST, str(counter_fmu)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "done" in done.stdout
    assert "finalizePythonInterpreter" not in done.stderr
