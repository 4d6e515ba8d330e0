"""Hosts that --cluster may reach: this machine, and others only if that is said."""

import subprocess

import pytest

import seatrial
from seatrial.errors import InputError
from seatrial_kits.campaigns.cluster import check_address
from tests.command import SEATRIAL
from tests.kit import needs_kits

HERE = ("127.0.0.1:8786", "localhost:8786", "tcp://127.1.2.3:1", "tls://[::1]:8786")
ELSEWHERE = ("10.0.0.1:8786", "tcp://192.0.2.1:8786", "tls://[2001:db8::1]:8786", "0.0.0.0:8786")


@pytest.mark.parametrize("address", HERE)
def test_this_machine(address):
    check_address(address)


@pytest.mark.parametrize("address", ELSEWHERE)
def test_another_host_needs_its_word(address, monkeypatch):
    with pytest.raises(InputError, match=r"--cluster reaches the host .* --network"):
        check_address(address)
    monkeypatch.setenv("SEATRIAL_NETWORK", "1")
    check_address(address)


@pytest.mark.parametrize(
    "address",
    ["", "8786", "ucx://127.0.0.1:1", "inproc://x/1/2", "http://127.0.0.1:1", "a:b", "::1:1"],
)
def test_what_is_no_address(address):
    with pytest.raises(InputError, match="HOST:PORT, tcp://HOST:PORT or tls://HOST:PORT is needed"):
        check_address(address)


@pytest.mark.slow
@needs_kits("search")
def test_the_commands_and_python_refuse_it(tmp_path):
    (tmp_path / "c.toml").write_text('trials = ["hydrone-landing"]\n', "utf-8")
    for command in (("run", "c.toml"), ("campaign", "c.toml", "--ask", "limits")):
        done = subprocess.run(
            [SEATRIAL, *command, "--cluster", "192.0.2.1:8786"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 2
        assert "--cluster reaches the host 192.0.2.1; allow it with --network" in done.stderr
        assert "Traceback" not in done.stderr
    with pytest.raises(InputError, match="--network"):
        seatrial.run_campaign(tmp_path / "c.toml", cluster="192.0.2.1:8786", out=tmp_path / "out")
    assert not (tmp_path / "out").exists()
