"""The safe state of a killed run on python-can's own multicast bus, with python-can to receive it."""

import json
import os
import subprocess
import sys

import pytest

from .test_dronecan_multicast import ROOT, alone, can_be_alone


@pytest.mark.skipif(not can_be_alone(), reason="no network of one's own here")
def test_the_bus_gets_the_frames_of_a_killed_run(tmp_path):
    pytest.importorskip("msgpack")  # python-can's driver needs it
    command = f"exec {sys.executable} -m tests.interop.can_multicast_killed"
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    ended = subprocess.run(
        alone(command), cwd=tmp_path, env={**os.environ, "PYTHONPATH": paths},
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    found = json.loads(ended.stdout.splitlines()[-1])
    assert found["status"] == 3
    assert "was ended by SIGKILL" in found["message"]
    assert "sent the safe state of gateway to python-can:udp_multicast:" in found["message"]
    assert found["frames"] == [[0x09F10D17, True, "ff00ff7f"], [0x123, False, ""]]
