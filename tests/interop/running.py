"""A trial as its user starts it: ``seatrial run`` in a process of its own, on free ports."""

from __future__ import annotations

import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from seatrial.trial.records.run_folder import Run, load_run
from tests.command import SEATRIAL

HOST = "127.0.0.1"
_STOP_S = 60.0
"""Wall time in which a trial that is interrupted must have written its report."""


def free_port(kind: socket.SocketKind = socket.SOCK_DGRAM) -> int:
    """Return a port of the loopback that nobody uses: UDP, or TCP with SOCK_STREAM."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind((HOST, 0))
        return int(probe.getsockname()[1])


def wait_for(condition: Callable[[], bool], what: str, deadline_s: float = 60.0) -> None:
    """Return when the condition holds; fail after the deadline, wall time."""
    end = time.monotonic() + deadline_s
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"{what}: not within {deadline_s:g} s")
        time.sleep(0.05)


@dataclass
class RunningTrial:
    """A trial that runs. ``folder`` is that of the run."""

    folder: Path
    process: subprocess.Popen[bytes]
    output: Path
    """File with all that it prints."""

    @property
    def transcript(self) -> str:
        """What it has printed so far."""
        return self.output.read_text("utf-8", "replace")

    @property
    def is_running(self) -> bool:
        """Whether its steps have begun, and the process has not ended."""
        manifest = self.folder / "manifest.json"
        if self.process.poll() is not None:
            raise ChildProcessError(f"the trial has ended with status {self.process.returncode}")
        return manifest.is_file() and '"status": "running"' in manifest.read_text("utf-8")

    def signals(self) -> Run:
        """Return what it has recorded; while it runs, up to the last second or so."""
        return load_run(self.folder)

    def stop(self) -> Run:
        """Interrupt it, as Ctrl-C does, and return all that it has recorded."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        self.process.wait(_STOP_S)
        return self.signals()


@contextmanager
def running(
    trial: str, folder: Path, *, factor: float | None = 1.0, engine: str = "direct", **given: str
) -> Iterator[RunningTrial]:
    """Run a trial in real time times ``factor`` in ``folder``, and end it in any case.

    If the machine held it up it does not hurry afterwards: its peers could not follow. Without a
    factor the trial's own pace is kept.

    ``given`` goes to ``--set``, with two underscores for the point: ``autopilot__mavlink__links="..."``.
    An error in the block gets what the trial printed as a note.
    """
    sets = [f"--set={name.replace('__', '.')}={value}" for name, value in given.items()]
    command = [SEATRIAL, "run", trial, "--engine", engine, "--out", str(folder / "run")]
    if factor is not None:
        command += ["--real-time", str(factor)]
    command += ["--overrun", "slip", *sets]
    output = folder / "output.txt"
    with output.open("wb") as file:
        process = subprocess.Popen(command, cwd=folder, stdout=file, stderr=subprocess.STDOUT)
    started = RunningTrial(folder / "run", process, output)
    try:
        yield started
    except BaseException as error:
        error.add_note(f"the trial (status {process.poll()}) printed:\n{started.transcript}")
        raise
    finally:
        process.kill()
        process.wait()
