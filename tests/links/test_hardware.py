"""The command line and real ports: nothing opens one unless it is allowed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.links.hardware import ALLOWED, is_simulated_port

SEATRIAL = str(Path(sys.executable).with_name("seatrial"))
RIG = """\
step = "10 ms"
[components]
mavlink = { fmu = "mavlink", set = { links = "serial:/dev/null:57600" } }
"""


@pytest.mark.parametrize(
    ("flags", "expected"),
    [([], "is a real port; allow it with --hardware"), (["--hardware"], "cannot open the link")],
)
@pytest.mark.parametrize("isolated", ["false", pytest.param("true", marks=pytest.mark.interop)])
def test_a_real_port_is_opened_only_if_allowed(flags, expected, isolated, write, tmp_path):
    write("rig.toml", RIG.replace("set =", f"isolated = {isolated}, set ="))
    trial = write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
    environment = {name: value for name, value in os.environ.items() if name != ALLOWED}
    run = subprocess.run(
        [SEATRIAL, "run", str(trial), "--engine", "direct", *flags],
        cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert run.returncode == 2
    assert expected in " ".join(run.stderr.split())
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    ("device", "simulated"),
    [("/dev/pts/3", True), ("/dev/pts/../ttyS0", False), ("/dev/ttyACM0", False)],
)
def test_pseudo_terminals_are_no_hardware(device, simulated):
    assert is_simulated_port(device) is simulated


def test_what_a_link_leads_to_counts(tmp_path):
    link = tmp_path / "port"
    link.symlink_to("/dev/pts/3")
    assert is_simulated_port(str(link))
    other = tmp_path / "other"
    other.symlink_to("/dev/ttyS0")
    assert not is_simulated_port(str(other))
