"""A vehicle behind a link, of which everything may be killed: it gets what stops it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import can
import pytest

from tests.command import SEATRIAL
from tests.kit import needs_kits

from .gateway import ENDS, SAFE, Vehicle
from .test_stop import child_of, children_of, has_ended, wait_for

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="terminals and processes")


def ended(process: subprocess.Popen[str], whose: str, number: int) -> str:
    """Send a signal and wait for the end of all; return the message."""
    child = child_of(process)
    os.kill(child if whose == "child" else process.pid, number)
    _, message = process.communicate(timeout=60)
    wait_for(lambda: has_ended(child))
    killed = whose == "supervisor" and number == signal.SIGKILL
    assert process.returncode == (-signal.SIGKILL if killed else 3), message
    assert "Traceback" not in message
    return message


@pytest.mark.sampled(3)
@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize(("whose", "number"), [ENDS[2], ENDS[-2]])
def test_the_vehicle_gets_its_safe_state_during_the_start(
    whose: str, number: int, start, vehicle: Vehicle
) -> None:
    process = start(start_takes=1.0)
    wait_for(lambda: any(holds(child, vehicle.device) for child in children_of(process)))
    ended(process, whose, number)
    wait_for(lambda: vehicle.read().endswith(SAFE))


def holds(process: int, device: str) -> bool:
    """Say if a process has a device open."""
    for descriptor in Path(f"/proc/{process}/fd").iterdir():
        try:
            if os.readlink(descriptor) == device:
                return True
        except FileNotFoundError:
            continue
    return False


@pytest.mark.slow
def test_an_isolated_gateway_that_is_killed_leaves_its_safe_state(
    start, vehicle: Vehicle, tmp_path: Path
) -> None:
    process = start(isolated=True)
    wait_for(lambda: b"!!!" in vehicle.read())
    child = child_of(process)
    (worker,) = Path(f"/proc/{child}/task/{child}/children").read_text().split()
    os.kill(int(worker), signal.SIGKILL)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 3
    assert "port: its process was ended by SIGKILL" in message
    assert vehicle.read().endswith(SAFE)


@pytest.mark.slow
def test_a_gateway_whose_master_and_supervisor_are_killed_ends_in_order(
    start, vehicle: Vehicle
) -> None:
    process = start(isolated=True)
    wait_for(lambda: b"!!!" in vehicle.read())
    child = child_of(process)
    os.kill(process.pid, signal.SIGSTOP)  # it sends nothing any more
    os.kill(child, signal.SIGKILL)
    wait_for(lambda: vehicle.read().endswith(SAFE))
    os.kill(process.pid, signal.SIGKILL)


@pytest.mark.slow
def test_a_stopped_run_goes_on(start, vehicle: Vehicle) -> None:
    process = start()
    wait_for(lambda: b"!!!" in vehicle.read())
    child = child_of(process)
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
    # An import of seconds: whatever is imported then must not show a traceback. In short sleeps:
    # Python heeds a signal that comes just before one begins after that.
    write(
        "slow/typer.py",
        "from pathlib import Path\nPath('importing').touch()\n"
        "import time\nfor _ in range(600):\n    time.sleep(0.1)\n",
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


@pytest.mark.slow
@needs_kits("can")
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
    command = [
        SEATRIAL,
        "run",
        "trial.toml",
        "--engine",
        "direct",
        "--real-time",
        "1",
        "--out",
        "run",
    ]
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


@pytest.mark.slow
@needs_kits("can")
def test_clients_of_a_can_gateway_get_its_frames(write, tmp_path: Path) -> None:
    write("rig.toml", CAN_RIG.format(link="slcan-tcp:127.0.0.1:0"))
    write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')
    command = [
        SEATRIAL,
        "run",
        "trial.toml",
        "--engine",
        "direct",
        "--real-time",
        "1",
        "--out",
        "run",
    ]
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
