"""A vehicle behind a link, of which everything may be killed: it gets what stops it."""

from __future__ import annotations

import json
import os
import random
import select
import signal
import subprocess
import sys
import time
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

import can
import pytest

from .test_cli import SEATRIAL
from .test_stop import children_of, has_ended, wait_for

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="terminals and processes")

SAFE = bytes.fromhex("FAAF0100000F5B0000000000000000000000FFFFFFFF00")
TALKER = '''
"""Sends, and may be slow to start."""
import time

from seatrial.component import Component, Output, Parameter
from seatrial.links.text import Outbox


class Talker(Component):
    """Sends a byte in every step, which says full ahead."""

    start_takes = Parameter(0.0, "s", "wall time of the start")
    tx = Output("1", "bytes", type=str)

    def start(self, t):
        self._tx = {}
        time.sleep(self.start_takes)

    def step(self, t, h):
        box = Outbox(self._tx)
        box.put(self.now_ns, b"!")
        box.flush()

    def outputs(self, t):
        self.tx = Outbox(self._tx).text
'''
RIG = """
step = "10 ms"
[components]
port = {{ fmu = "serial-gateway", isolated = {isolated}, set = {{ links = "serial:{device}:115200", safe_state = "{safe}" }} }}
talker = {{ fmu = "talker.py:Talker", set = {{ start_takes = {start_takes} }} }}
[connections]
"talker.tx" = "port.rx"
"""
ENDS = [
    pytest.param("supervisor", signal.SIGINT, id="int"),
    pytest.param("supervisor", signal.SIGTERM, id="term", marks=pytest.mark.interop),
    pytest.param("supervisor", signal.SIGHUP, id="hup"),
    pytest.param("supervisor", signal.SIGQUIT, id="quit", marks=pytest.mark.interop),
    pytest.param("supervisor", signal.SIGKILL, id="supervisor-killed", marks=pytest.mark.interop),
    pytest.param("child", signal.SIGKILL, id="killed"),
    pytest.param("child", signal.SIGSEGV, id="segfault", marks=pytest.mark.interop),
]


class Vehicle:
    """The other end of a line: a pseudo-terminal, and what has come from it."""

    def __init__(self) -> None:
        self._own, self._other = os.openpty()
        tty.setraw(self._other)
        self.device = os.ttyname(self._other)
        self.received = b""

    def read(self) -> bytes:
        while select.select([self._own], [], [], 0.0)[0]:
            self.received += os.read(self._own, 65536)
        return self.received

    def close(self) -> None:
        os.close(self._own)
        os.close(self._other)


@pytest.fixture
def vehicle() -> Iterator[Vehicle]:
    vehicle = Vehicle()
    yield vehicle
    vehicle.close()


Start = Callable[..., subprocess.Popen[str]]


@pytest.fixture
def start(write, tmp_path: Path, vehicle: Vehicle) -> Iterator[Start]:
    """Return a function that starts a run with a gateway to the vehicle."""
    processes = []

    def start(
        isolated: bool = False, start_takes: float = 0.0, out: str = "run"
    ) -> subprocess.Popen[str]:
        write("talker.py", TALKER)
        write("rig.toml", RIG.format(
            isolated=str(isolated).lower(), device=vehicle.device, safe=SAFE.hex(), start_takes=start_takes
        ))  # fmt: skip
        write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')
        command = [SEATRIAL, "run", "trial.toml", "--engine", "direct", "--realtime", "--out", out]
        command.append("--hardware")  # the terminal is this test's, which a run cannot know
        pipe = subprocess.PIPE
        processes.append(
            subprocess.Popen(command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True)
        )
        return processes[-1]

    yield start
    for process in processes:
        process.kill()
        process.communicate()


def ended(process: subprocess.Popen[str], whose: str, number: int) -> str:
    """Send a signal and wait for the end of all; return the message."""
    (child,) = children_of(process)
    os.kill(child if whose == "child" else process.pid, number)
    _, message = process.communicate(timeout=60)
    wait_for(lambda: has_ended(child))
    killed = whose == "supervisor" and number == signal.SIGKILL
    assert process.returncode == (-signal.SIGKILL if killed else 3), message
    assert "Traceback" not in message
    return message


@pytest.mark.parametrize(
    "isolated",
    [
        pytest.param(False, id="in-process"),
        pytest.param(True, id="isolated", marks=pytest.mark.interop),
    ],
)
@pytest.mark.parametrize(("whose", "number"), ENDS)
def test_the_vehicle_gets_its_safe_state_last(
    whose: str, number: int, isolated: bool, start, vehicle: Vehicle, tmp_path: Path
) -> None:
    process = start(isolated)
    wait_for(lambda: b"!!!" in vehicle.read())
    message = ended(process, whose, number)
    wait_for(lambda: vehicle.read().endswith(SAFE))
    if whose == "child":
        assert f"was ended by {signal.Signals(number).name}" in message
        status = '"failed"'
        if not isolated:
            assert f"sent the safe state of port to serial:{vehicle.device}:115200" in message
    else:
        status = '"stopped"'
    assert f'"status": {status}' in (tmp_path / "run" / "manifest.json").read_text()


@pytest.mark.parametrize(("whose", "number"), [ENDS[2], ENDS[-2]])
def test_the_vehicle_gets_its_safe_state_during_the_start(
    whose: str, number: int, start, vehicle: Vehicle
) -> None:
    process = start(start_takes=1.0)
    wait_for(lambda: len(children_of(process)) == 1 and holds(process, vehicle.device))
    ended(process, whose, number)
    wait_for(lambda: vehicle.read().endswith(SAFE))


def holds(process: subprocess.Popen[str], device: str) -> bool:
    """Say if a process has a device open."""
    for descriptor in Path(f"/proc/{process.pid}/fd").iterdir():
        try:
            if os.readlink(descriptor) == device:
                return True
        except FileNotFoundError:
            continue
    return False


def test_an_isolated_gateway_that_is_killed_leaves_its_safe_state(
    start, vehicle: Vehicle, tmp_path: Path
) -> None:
    process = start(isolated=True)
    wait_for(lambda: b"!!!" in vehicle.read())
    (child,) = children_of(process)
    (worker,) = Path(f"/proc/{child}/task/{child}/children").read_text().split()
    os.kill(int(worker), signal.SIGKILL)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 3
    assert "port: its process was ended by SIGKILL" in message
    assert vehicle.read().endswith(SAFE)


def test_a_gateway_whose_master_and_supervisor_are_killed_ends_in_order(
    start, vehicle: Vehicle
) -> None:
    process = start(isolated=True)
    wait_for(lambda: b"!!!" in vehicle.read())
    (child,) = children_of(process)
    os.kill(process.pid, signal.SIGSTOP)  # it sends nothing any more
    os.kill(child, signal.SIGKILL)
    wait_for(lambda: vehicle.read().endswith(SAFE))
    os.kill(process.pid, signal.SIGKILL)


MEDDLER = '''
"""Interrupts the gateway of its rig beside its code, or kills the supervisor."""
import os
import signal
import sys
import time

from seatrial.component import Component, Output, Parameter


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
    command = [SEATRIAL, "run", "trial.toml", "--engine", engine, "--realtime", "--hardware"]
    done = subprocess.run(
        [*command, "--out", "run"], cwd=folder, capture_output=True, text=True, timeout=60
    )
    wait_for(lambda: vehicle.read().endswith(SAFE))
    said = json.loads((folder / "run" / "manifest.json").read_text())
    return done.stdout + done.stderr, vehicle.read(), said["status"]


def test_an_interruption_beside_the_code_of_an_fmu_is_a_stop(write, vehicle: Vehicle) -> None:
    # pythonfmu releases the component then, and calls of it read freed memory.
    output, received, status = meddled(write, vehicle, "interrupt", "fmu")
    assert status == "stopped", output
    assert received.removesuffix(SAFE).strip(b"!") == b""  # once
    assert "sent the safe state" not in output  # nobody had to do it in its place


def test_a_supervisor_killed_in_a_release_keeps_no_other_from_it(write, vehicle: Vehicle) -> None:
    _, received, status = meddled(write, vehicle, "kill", "direct")
    assert status == "stopped"
    assert received.endswith(b"!" + SAFE)


def test_a_stopped_run_goes_on(start, vehicle: Vehicle) -> None:
    process = start()
    wait_for(lambda: b"!!!" in vehicle.read())
    (child,) = children_of(process)
    for pid in (process.pid, child):
        os.kill(pid, signal.SIGSTOP)
    time.sleep(0.2)
    before = len(vehicle.read())
    time.sleep(0.2)
    assert len(vehicle.read()) == before
    for pid in (process.pid, child):
        os.kill(pid, signal.SIGCONT)
    wait_for(lambda: len(vehicle.read()) > before + 10)
    ended(process, "supervisor", signal.SIGINT)
    assert vehicle.read().endswith(SAFE)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT])
def test_a_signal_while_the_command_starts_is_one_message(number: int, write, tmp_path) -> None:
    # An import of seconds: whatever is imported then must not show a traceback.
    write(
        "slow/typer.py",
        "from pathlib import Path\nPath('importing').touch()\nimport time\ntime.sleep(60)\n",
    )
    environment = {
        **os.environ,
        "PYTHONPATH": f"{tmp_path}/slow:{os.environ.get('PYTHONPATH', '')}",
    }
    process = subprocess.Popen(
        [SEATRIAL, "run", "landing"], cwd=tmp_path, env=environment,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    wait_for((tmp_path / "importing").is_file)
    process.send_signal(number)
    _, message = process.communicate(timeout=60)
    assert (process.returncode, message) == (3, "seatrial: stopped\n")


CAN_RIG = """
step = "10 ms"
[components]
bus = {{ fmu = "canbus", set = {{ nodes = "gateway" }} }}
gateway = {{ fmu = "can-gateway", set = {{ link = "{link}", safe_state = "09F10D17#FF00FF7F 123#" }} }}
[connections]
"bus.n1" = "gateway.bus"
"""


@pytest.mark.parametrize(
    ("whose", "number"),
    [
        pytest.param("supervisor", signal.SIGHUP, marks=pytest.mark.interop),
        ("child", signal.SIGKILL),
    ],
)
def test_a_can_bus_gets_its_frames(whose: str, number: int, write, tmp_path: Path) -> None:
    vehicle = Vehicle()
    write("rig.toml", CAN_RIG.format(link=f"python-can:slcan:{vehicle.device}:250000"))
    write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')
    command = [SEATRIAL, "run", "trial.toml", "--engine", "direct", "--realtime", "--out", "run"]
    command.append("--hardware")
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True)
    try:
        wait_for((tmp_path / "run").is_dir)
        message = ended(process, whose, number)
        wait_for(lambda: b"T09F10D174FF00FF7F\rt1230\r" in vehicle.read())
        if whose == "child":
            assert "sent the safe state of gateway to python-can:slcan:" in message
    finally:
        process.kill()
        process.communicate()
        vehicle.close()


def test_clients_of_a_can_gateway_get_its_frames(write, tmp_path: Path) -> None:
    write("rig.toml", CAN_RIG.format(link="slcan-tcp:127.0.0.1:0"))
    write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')
    command = [SEATRIAL, "run", "trial.toml", "--engine", "direct", "--realtime", "--out", "run"]
    process = subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    assert process.stdout is not None
    try:
        assert "gateway" in process.stdout.readline()
        url = process.stdout.readline().strip()
        with can.Bus(url, "slcan", bitrate=250_000, sleep_after_open=0.0) as bus:
            time.sleep(0.3)  # it is known to be open in the next step
            ended(process, "child", signal.SIGKILL)
            received = [bus.recv(10.0), bus.recv(10.0)]
        assert [message.arbitration_id for message in received] == [0x09F10D17, 0x123]
        assert bytes(received[0].data) == b"\xff\x00\xff\x7f"
    finally:
        process.kill()
        process.communicate()


@pytest.mark.long
def test_seven_ends_at_twenty_random_moments(start, vehicle: Vehicle) -> None:
    """The vehicle never gets anything after its safe state, and always that if it got anything."""
    generator = random.Random(17)
    for number, (whose, signal_, isolated) in enumerate(
        (*end.values, bool(k % 2)) for end in ENDS for k in range(20)
    ):
        vehicle.read()
        vehicle.received = b""
        process = start(isolated, start_takes=0.2, out=f"run{number}")
        time.sleep(generator.uniform(0.05, 3.0))
        children = children_of(process)
        os.kill(children[0] if whose == "child" and children else process.pid, signal_)
        _, message = process.communicate(timeout=60)
        for child in children:
            wait_for(lambda child=child: has_ended(child))
        time.sleep(0.5)  # an isolated gateway, whose master was killed
        received = vehicle.read()
        assert not received or received.endswith(SAFE), (whose, signal_, message)
        assert "Traceback" not in message, (whose, signal_)
        assert process.returncode in (3, -signal_), (whose, signal_, message)
