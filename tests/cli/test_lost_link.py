"""A line that is unplugged in a run: a fact in its signals, its result, its report and its end."""

from __future__ import annotations

import json
import os
import select
import socket
import subprocess
import time
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.command import SEATRIAL, seatrial
from tests.kit import needs_kits

from .gateway import SAFE, TALKER, Launched, Start
from .test_stop import wait_for

if not hasattr(os, "openpty"):
    pytest.skip("terminals", allow_module_level=True)

SERIAL = """
port = {{ fmu = "serial-gateway", set = {{ links = "serial:{line}:115200", safe_state = "{safe}" }} }}
"""
MAVLINK = """
port = {{ fmu = "mavlink", set = {{ links = "serial:{line}:115200" }} }}
"""
BOARD = """
port = {{ fmu = "arduino", set = {{ backend = "board", links = "0=serial:{line}:115200", safe_state = "{safe}" }} }}
"""
SLCAN = """
bus  = {{ fmu = "canbus", set = {{ nodes = "port" }} }}
port = {{ fmu = "can-gateway", set = {{ link = "python-can:slcan:{line}:250000", safe_state = "123#" }} }}
"""
OTHER = """
other  = {{ fmu = "serial-gateway", set = {{ links = "serial:{other}:115200", safe_state = "{safe}" }} }}
talker = {{ fmu = "talker.py:Talker" }}
[connections]
"talker.tx" = "other.rx"
"""
TRIAL = """
rig = "rig.toml"
stop = "{stop} s"
[[criteria]]
name = "the line is there"
check = "always port.link_lost < 0.5"
"""


class Line:
    """A serial line at a name, as udev gives it, with a peer that can be unplugged."""

    def __init__(self, place: Path) -> None:
        self.place, self.received = place, b""
        self.plug()

    def plug(self) -> None:
        self._own, self._other = os.openpty()
        tty.setraw(self._other)
        self.place.symlink_to(os.ttyname(self._other))

    def unplug(self) -> None:
        self.place.unlink()
        os.close(self._own)
        os.close(self._other)
        self._own = -1

    def read(self) -> bytes:
        while self._own >= 0 and select.select([self._own], [], [], 0.0)[0]:
            self.received += os.read(self._own, 65536)
        return self.received

    def close(self) -> None:
        if self._own >= 0:
            self.unplug()


@pytest.fixture
def lines(tmp_path: Path) -> Iterator[tuple[Line, Line]]:
    both = Line(tmp_path / "line"), Line(tmp_path / "other")
    yield both
    for line in both:
        line.close()


@pytest.fixture
def start(write, tmp_path: Path, launched: Launched) -> Start:
    """Return a function that starts a run of one line beside another."""

    def start(port: str, stop: float, *options: str) -> subprocess.Popen[str]:
        write("talker.py", TALKER)
        place = {"line": tmp_path / "line", "other": tmp_path / "other", "safe": SAFE.hex()}
        bus = '"bus.n1" = "port.bus"\n' if "canbus" in port else ""
        text = f'step = "10 ms"\n[components]{port}{OTHER}{bus}'.format(**place)
        write("rig.toml", text)
        write("trial.toml", TRIAL.format(stop=stop))
        command = (SEATRIAL, "run", "trial.toml", "--real-time", "1", "--hardware", "--out", "run")
        return launched(*command, *options)

    return start


@pytest.mark.sampled(6)
@pytest.mark.slow
@needs_kits("can")
@pytest.mark.parametrize("engine", ["direct", pytest.param("fmu", marks=pytest.mark.interop)])
@pytest.mark.parametrize(
    "port",
    [
        pytest.param(SERIAL, id="serial"),
        pytest.param(MAVLINK, id="mavlink", marks=pytest.mark.interop),
        pytest.param(BOARD, id="board", marks=pytest.mark.interop),
        pytest.param(SLCAN, id="slcan"),
    ],
)
def test_a_lost_line_ends_a_run_with_hardware(
    port: str, engine: str, start: Start, lines: tuple[Line, Line], tmp_path: Path
) -> None:
    line, other = lines
    process = start(port, 1000.0, "--engine", engine)
    wait_for(lambda: b"!!!" in other.read())
    line.unplug()
    unplugged = time.monotonic()
    _, message = process.communicate(timeout=60)
    assert time.monotonic() - unplugged < 30.0
    assert process.returncode == 3
    assert "seatrial: port: a link is lost at t = " in message
    assert other.read().endswith(SAFE)  # the other vehicle is not left with its last order
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert manifest["status"] == "failed"
    assert manifest["error"].startswith("port: a link is lost at t = ")
    timing = json.loads((tmp_path / "run" / "timing.json").read_text())
    assert timing["lost_links"].keys() == {"port"}
    page = (tmp_path / "run" / "report.html").read_text()
    assert "<h2>Lost links</h2>" in page


@pytest.mark.slow
def test_a_run_goes_on_without_it_if_that_is_wanted_and_it_comes_back(
    start: Start, lines: tuple[Line, Line], tmp_path: Path
) -> None:
    line, other = lines
    process = start(SERIAL, 5.0, "--engine", "direct", "--keep-going")
    wait_for(lambda: b"!!!" in other.read())
    line.unplug()
    time.sleep(0.5)
    line.plug()
    output, message = process.communicate(timeout=60)
    assert process.returncode == 1, message  # the criterion of the line
    assert "FAIL  the line is there" in output
    assert "note: port: a link was lost at t = " in message + output
    assert "it came back 1 times" in message + output
    assert line.read().endswith(SAFE)
    rows = (tmp_path / "run" / "signals.csv").read_text().splitlines()
    place = rows[0].split(",").index("port.link_lost")
    lost = [row.split(",")[place] for row in rows[1:]]
    assert (lost[0], lost[-1], len(set(lost))) == (lost[0], lost[0], 2)


def test_keeping_on_is_a_word_for_hardware(write, tmp_path: Path) -> None:
    write("rig.toml", 'step = "10 ms"\n[components]\nport = { fmu = "serial-gateway" }\n')
    write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
    done = seatrial("run", "trial.toml", "--keep-going", cwd=tmp_path)
    assert (done.returncode, "goes with --hardware" in done.stderr) == (2, True)


@pytest.mark.slow
def test_a_server_that_is_gone_is_a_lost_link_of_a_simulation(write, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = f"tcpout:127.0.0.1:{server.getsockname()[1]}"
        write("rig.toml", 'step = "10 ms"\n[components]\nport = { fmu = "serial-gateway" }\n')
        write("trial.toml", TRIAL.format(stop=4) + f'[set]\n"port.links" = "{link}"\n')
        command = [SEATRIAL, "run", "trial.toml", "--engine", "direct", "--real-time", "1"]
        process = subprocess.Popen(
            [*command, "--out", "run"], cwd=tmp_path, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
        server.accept()[0].close()
        server.accept()[0].close()  # it comes back, and is lost again
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "port: a link was lost at t = " in output
    assert "it came back 1 times" in output


@pytest.mark.slow
def test_clients_that_leave_are_no_lost_link(write, tmp_path: Path) -> None:
    write("rig.toml", 'step = "10 ms"\n[components]\nport = { fmu = "serial-gateway" }\n')
    write("trial.toml", TRIAL.format(stop=2))
    command = [SEATRIAL, "run", "trial.toml", "--engine", "direct", "--real-time", "1"]
    process = subprocess.Popen(
        [*command, "--out", "run"], cwd=tmp_path, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    assert process.stdout is not None
    process.stdout.readline()
    _, host, port = process.stdout.readline().strip().split(":")
    socket.create_connection((host, int(port))).close()
    output, _ = process.communicate(timeout=60)
    assert (process.returncode, "lost" in output) == (0, False), output
