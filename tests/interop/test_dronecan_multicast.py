"""DroneCAN's multicast bus, with the dronecan package's driver on the other side."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ALONE = "ip link set lo up && ip route add 239.65.82.0/24 dev lo"


def alone(command: str) -> list[str]:
    """Return a command in a network of its own, with nothing but a loopback interface."""
    return ["unshare", "--user", "--map-root-user", "--net", "sh", "-c", f"{ALONE} && {command}"]


def can_be_alone() -> bool:
    if not (shutil.which("unshare") and shutil.which("ip")):
        return False
    return subprocess.run(alone("true"), capture_output=True).returncode == 0


@pytest.mark.skipif(not can_be_alone(), reason="no network of one's own here")
def test_the_packages_driver_meets_our_node():
    command = f"exec {sys.executable} -m tests.interop.dronecan_multicast"
    ended = subprocess.run(alone(command), cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert ended.returncode == 0, ended.stderr
    found = json.loads(ended.stdout.splitlines()[-1])
    assert found["names"][0] == "org.seatrial.node"
    assert found["health"][0] in (0, 1)
    assert abs(found["command"] - 4096 / 8191) < 1e-12
    assert (found["clients"], found["at"]) == (1, "mcast:0")
