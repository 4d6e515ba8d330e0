"""Buses in rigs: the delay of the coupling, both carriers, and what `seatrial run` leaves."""

from pathlib import Path

import can
import pytest

from seatrial.errors import InputError
from seatrial.links.hardware import ALLOWED
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

pytestmark = pytest.mark.interop

LISTENER = '''
from seatrial.model.component import Component, Input, Output
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit


class Listener(Component):
    """Reports how late it receives: the time at the beginning of its step, less the frame's end."""

    discrete = True
    rx = Input("1", "what the bus tells", type=str)
    tx = Output("1", "what it tells the bus", type=str)
    earliest = Output("s", "of all frames")
    latest = Output("s", "of all frames")
    received = Output("1", "frames", type=int)

    def start(self, t):
        self._can, self._late = {}, []

    def step(self, t, h):
        for when, operation in CanNode(self._can).receive(self.rx):
            if isinstance(operation, Transmit):
                self._late.append(t - when / 1e9)

    def outputs(self, t):
        self.received = len(self._late)
        self.earliest = min(self._late, default=0.0)
        self.latest = max(self._late, default=0.0)
'''
RIG = """
step = "{step}"
algorithm = "{algorithm}"

[components]
{components}

[connections]
"talker.tx"   = "can.tx.n1"
"listener.tx" = "can.tx.n2"
"can.rx.n1"   = "talker.rx"
"can.rx.n2"   = "listener.rx"
"""
CAN = 'can = { fmu = "canbus" }'
TALKER = (
    'talker = { fmu = "can-traffic", set = { messages = "0x123 0.00037 2; 0x18FF0001 0.0013 8" } }'
)
LISTENS = 'listener = { fmu = "listener.py:Listener" }'
TRIAL = """
rig  = "rig.toml"
stop = "200 ms"
"""


def run(folder, name, *, order, algorithm="jacobi", step="1 ms", engine="direct"):
    """Return the last row of a run, by signal, and the bus's log."""
    text = RIG.format(step=step, algorithm=algorithm, components="\n".join(order))
    (folder / "rig.toml").write_text(text, "utf-8")
    (folder / "listener.py").write_text(LISTENER, "utf-8")
    (folder / "trial.toml").write_text(TRIAL, "utf-8")
    result = run_trial(load_trial(str(folder / "trial.toml")), folder / name, engine=engine)
    assert result.status == "complete", result.error
    rows = (result.folder / "signals.csv").read_text("utf-8").splitlines()
    last = dict(zip(rows[0].split(","), rows[-1].split(","), strict=False))
    return last, Path(result.folder, "can.log").read_bytes()


@pytest.mark.parametrize(
    ("algorithm", "order", "steps"),
    [
        ("jacobi", (CAN, TALKER, LISTENS), 1),
        ("jacobi", (LISTENS, TALKER, CAN), 1),
        ("plain-jacobi", (CAN, TALKER, LISTENS), 1),
        ("gauss-seidel", (CAN, TALKER, LISTENS), 0),
        ("gauss-seidel", (LISTENS, TALKER, CAN), 1),
    ],
)
def test_a_frame_is_received_so_many_steps_after_its_end(tmp_path, algorithm, order, steps):
    """More than ``steps`` of 1 ms, and less than one more; the bus itself is never wrong."""
    last, log = run(tmp_path, "run", order=order, algorithm=algorithm)
    assert int(last["listener.received"]) > 500
    assert float(last["listener.earliest"]) == pytest.approx(steps * 1e-3, abs=5e-5)
    assert float(last["listener.latest"]) == pytest.approx((steps + 1) * 1e-3, abs=5e-5)
    _, reference = run(tmp_path, "reference", order=(CAN, TALKER, LISTENS))
    assert log == reference


def test_the_step_of_the_rig_does_not_change_the_bus(tmp_path):
    logs = [
        run(tmp_path, f"run{number}", order=(CAN, TALKER, LISTENS), step=step)[1].splitlines()
        for number, step in enumerate(("0.1 ms", "1 ms", "10 ms"))
    ]
    common = min(map(len, logs))  # the last step's frames are not on the bus yet
    assert common > 500
    assert logs[0][:common] == logs[1][:common] == logs[2][:common]


@pytest.mark.parametrize("name", ["can-load", "can-node-off", "can-babbling"])
def test_shipped_trials_hold(name, tmp_path):
    result = run_trial(load_trial(name), tmp_path / "run", engine="direct")
    assert result.status == "complete", result.error
    assert [name for name, _, verdict in result.verdicts if not verdict.passed] == []


@pytest.mark.long
def test_both_carriers_leave_the_same_logs(tmp_path):
    runs = [
        run_trial(load_trial("can-bus-off"), tmp_path / engine, engine=engine)
        for engine in ("direct", "fmu")
    ]
    for result in runs:
        assert result.status == "complete", result.error
        assert [name for name, _, verdict in result.verdicts if not verdict.passed] == []
    for file in ("can.blf", "can.log", "can.json", "signals.csv"):
        one, other = ((result.folder / file).read_bytes() for result in runs)
        assert one == other
    with can.LogReader(str(runs[0].folder / "can.blf")) as log:
        kinds = [each.is_error_frame for each in log]
    assert kinds.count(False) > 300
    assert kinds.count(True) > 300


def test_a_bus_above_its_bit_rate_fails_its_trial(tmp_path):
    """Nodes that share the queue of the load wait longest; those of higher priority do not."""
    trial = load_trial("can-load").changed({"display.load": 1.1, "stop": "2 s"}, "test")
    result = run_trial(trial, tmp_path / "run", engine="direct")
    failed = [name for name, _, verdict in result.verdicts if not verdict.passed]
    assert failed == [
        "the display's state takes less than 20 ms, its period",
        "nothing is dropped",
    ]


PROFILE = """
title = "A boat with a CAN bus"

[identity]
system_id        = 1
component_id     = 1
vehicle_type     = "surface_boat"
autopilot_type   = "ardupilotmega"
firmware_version = "0.1.0-dev"
uid              = 1

[home]
latitude  = "0 deg"
longitude = "0 deg"
altitude  = "0 m"
date      = 2026-01-01
source    = "invented"

[links.bus]
kind = "can-gateway"
link = "{gateway}"
"""
GATEWAY = """
step = "1 ms"
profile = "boat"

[components]
can  = { fmu = "canbus", set = { nodes = "node gateway", bit_rate = 500000 } }
node = { fmu = "can-traffic", set = { messages = "0x123 0.01 2" } }
gateway = { fmu = "can-gateway", profile = "links.bus" }

[connections]
"node.tx"   = "can.tx.n1"
"gateway.tx"   = "can.tx.n2"
"can.rx.n1" = "node.rx"
"can.rx.n2" = "gateway.rx"
"""


def through(folder, gateway):
    for name, text in (
        ("hil_profiles/boat.toml", PROFILE.format(gateway=gateway)),
        ("harness/rigs/gateway.toml", GATEWAY),
        ("harness/trials/gateway.toml", 'rig = "gateway"\nstop = "100 ms"\n'),
    ):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, "utf-8")
    trial = load_trial(str(folder / "harness/trials/gateway.toml"))
    return run_trial(trial, folder / "run", engine="direct")


def test_a_profile_names_the_bus(tmp_path):
    with can.Bus(str(tmp_path), "virtual", ignore_config=True) as outside:
        assert through(tmp_path, f"python-can:virtual:{tmp_path}").status == "complete"
        found = [outside.recv(1.0).timestamp for _ in range(9)]
    # Requested every 10 ms; 11 bits and 2 bytes last 60 to 79 bits of 2 us.
    assert all(120e-6 <= time - 0.01 * k <= 160e-6 for k, time in enumerate(found))


def test_a_profile_that_names_hardware_needs_permission(tmp_path, monkeypatch):
    monkeypatch.delenv(ALLOWED, raising=False)
    with pytest.raises(
        InputError, match=r"'python-can:socketcan:can0' reaches the bus can0.*allow it with"
    ):
        through(tmp_path, "python-can:socketcan:can0")
