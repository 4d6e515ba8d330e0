"""A run that is interrupted where it is most delicate: its gateways stop the vehicle all the same."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from tests.command import SEATRIAL

from .gateway import RIG, SAFE, TALKER, Vehicle
from .test_stop import wait_for

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="terminals and processes")

MEDDLER = '''
"""Interrupts the gateway of its rig beside its code, or kills the supervisor."""
import os
import signal
import sys
import time

from seatrial.model.component import Component, Output, Parameter


def interrupt(frame, event, arg):
    """Raise, as a signal does, where pythonfmu calls the step of the FMU."""
    code = frame.f_code
    if event == "call" and code.co_name == "do_step" and code.co_filename.endswith("slave.py"):
        if frame.f_locals["self"].instance_name == "port":
            sys.setprofile(None)
            raise KeyboardInterrupt


class Meddler(Component):
    """Does it in its third step; or stops the run then, and kills when it is released."""

    does = Parameter("interrupt", "1", "interrupt or kill")
    steps = Output("1", "steps", type=int)

    def start(self, t):
        self.count = 0

    def step(self, t, h):
        self.count += 1
        if self.count == 3 and self.does == "interrupt":
            sys.setprofile(interrupt)
        elif self.count == 3:
            os.kill(os.getppid(), signal.SIGINT)

    def outputs(self, t):
        self.steps = self.count

    def close(self):
        if self.does == "kill":
            os.kill(os.getppid(), signal.SIGKILL)
            time.sleep(0.5)
'''


def meddled(write, vehicle: Vehicle, does: str, engine: str) -> tuple[str, bytes, str]:
    """Run a rig with a meddler; return what was output, and what the vehicle and manifest say."""
    write("talker.py", TALKER)
    write("meddler.py", MEDDLER)
    rig = RIG.format(isolated="false", device=vehicle.device, safe=SAFE.hex(), start_takes=0.0)
    meddler = f'meddler = {{ fmu = "meddler.py:Meddler", set = {{ does = "{does}" }} }}\nport = '
    write("rig.toml", rig.replace("port = ", meddler))
    folder = write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n').parent
    command = [SEATRIAL, "run", "trial.toml", "--engine", engine, "--real-time", "1", "--hardware"]
    done = subprocess.run(
        [*command, "--out", "run"], cwd=folder, capture_output=True, text=True, timeout=60
    )
    wait_for(lambda: vehicle.read().endswith(SAFE))
    said = json.loads((folder / "run" / "manifest.json").read_text())
    return done.stdout + done.stderr, vehicle.read(), said["status"]


@pytest.mark.slow
def test_an_interruption_beside_the_code_of_an_fmu_is_a_stop(write, vehicle: Vehicle) -> None:
    # pythonfmu releases the component then, and calls of it read freed memory.
    output, received, status = meddled(write, vehicle, "interrupt", "fmu")
    assert status == "stopped", output
    assert received.removesuffix(SAFE).strip(b"!") == b""  # once
    assert "sent the safe state" not in output  # nobody had to do it in its place


@pytest.mark.slow
def test_a_supervisor_killed_in_a_release_keeps_no_other_from_it(write, vehicle: Vehicle) -> None:
    _, received, status = meddled(write, vehicle, "kill", "direct")
    assert status == "stopped"
    assert received.endswith(b"!" + SAFE)
