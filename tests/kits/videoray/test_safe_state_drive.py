"""`seatrial drive` ended by force: what stops the thrusters is the last that its vehicle gets."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from seatrial.shipped import available

if sys.platform == "win32":
    pytest.skip("terminals and processes", allow_module_level=True)

from tests.command import SEATRIAL

from ...cli.test_safe_state import SAFE, Vehicle
from ...cli.test_stop import child_of, wait_for
from .test_drive import WAIT_S, Terminal

OF_NODE_5 = bytes.fromhex("FAAF0500000F5F0000000000000000000000FFFFFFFF00")
"""As `SAFE`; the header's check, the sixth byte's next, is the XOR of those before."""
KILLED, HUNG_UP = ("child", signal.SIGKILL), ("program", signal.SIGHUP)
interop = pytest.mark.interop


@pytest.fixture
def vehicle() -> Iterator[Vehicle]:
    vehicle = Vehicle()
    yield vehicle
    vehicle.close()


def profile(tmp_path: Path, safe_state: str | None) -> tuple[str, ...]:
    """Return the options of a profile of node 5, with another safe state than the shipped one."""
    kept = [
        line
        for line in available("hil_profiles")["videoray"].read_text("utf-8").splitlines()
        if not line.startswith("safe_state")
    ]
    at = kept.index("[links.topside-port]") + 1
    own = [] if safe_state is None else [f'safe_state = "{safe_state}"']
    kept[at:at] = own
    topside = kept.index("[links.topside]") + 1
    kept[topside:topside] = ["node_id = 5"]
    (tmp_path / "mine.toml").write_text("\n".join(kept), "utf-8")
    return "--profile", str(tmp_path / "mine.toml")


@pytest.mark.parametrize(
    ("end", "written", "safe"),
    [
        pytest.param(KILLED, "shipped", SAFE, id="killed"),
        pytest.param(HUNG_UP, "shipped", SAFE, id="hung-up", marks=interop),
        pytest.param(KILLED, "0102", b"\x01\x02", id="killed-own", marks=interop),
        pytest.param(KILLED, None, OF_NODE_5, id="killed-default", marks=interop),
        pytest.param(HUNG_UP, None, OF_NODE_5, id="hung-up-default"),
    ],
)
def test_the_vehicle_gets_its_safe_state_last(
    end: tuple[str, int], written: str | None, safe: bytes, vehicle: Vehicle, tmp_path: Path
) -> None:
    options = () if written == "shipped" else profile(tmp_path, written)
    whose, number = end
    url = f"serial:{vehicle.device}:115200"
    with Terminal(SEATRIAL, "drive", url, "--hardware", *options) as terminal:
        wait_for(lambda: vehicle.read().count(b"\xfa\xaf") > 2)  # it looks for its vehicle
        child = child_of(terminal.process)
        os.kill(child if whose == "child" else terminal.process.pid, number)
        assert terminal.process.wait(WAIT_S) == 3
        wait_for(lambda: vehicle.read().endswith(safe))
        if whose == "child":
            terminal.until("was ended by SIGKILL")
            shown = terminal.until("safe state of topside-port")
            assert "Traceback" not in shown


@interop
def test_no_safe_state_is_what_the_profile_says_if_it_says_so(
    vehicle: Vehicle, tmp_path: Path
) -> None:
    url = f"serial:{vehicle.device}:115200"
    with Terminal(SEATRIAL, "drive", url, "--hardware", *profile(tmp_path, "")) as terminal:
        wait_for(lambda: vehicle.read().count(b"\xfa\xaf") > 2)
        os.kill(child_of(terminal.process), signal.SIGKILL)
        assert terminal.process.wait(WAIT_S) == 3
        assert OF_NODE_5 not in vehicle.read()
        assert "safe state" not in "".join(terminal.screen.display)
