"""A component in a sandbox: it runs as any other, and reaches nothing outside."""

from __future__ import annotations

import csv
import json
import re
import struct
import subprocess
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.fmi.isolation.pipe import FAILURE, RESULT, frame
from seatrial.fmi.loading import sandbox
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

from ..bwrap import needs_bwrap
from ..command import seatrial

CURIOUS = '''
import json
import os
import socket
from pathlib import Path

from seatrial.model.component import Component, Input, Output


class Curious(Component):
    """Tries what it should not."""

    u = Input("m", "input")
    y = Output("m", "twice the input")
    found = Output("1", "what it reached", type=str)

    def start(self, t):
        self.x = 0.0
        self.report = {}

    def step(self, t, h):
        self.x += h
        if not self.report:
            self.report = {
                "home": reached(lambda: Path(HOME, "secret").read_text()),
                "list": reached(lambda: os.listdir(HOME)),
                "write": reached(lambda: Path(HOME, "left").write_text("x")),
                "connect": reached(lambda: socket.create_connection(("127.0.0.1", PORT), 1.0)),
                "processes": sorted(p for p in os.listdir("/proc") if p.isdigit()),
                "environment": os.environ.get("SEATRIAL_TEST_SECRET"),
                "own": Path(f"/tmp/seatrial-{PORT}").write_text("x"),
            }

    def outputs(self, t):
        self.y = 2.0 * self.x
        self.found = json.dumps(self.report)


def reached(what):
    try:
        return str(what())
    except OSError as error:
        return f"not: {error.errno}"
'''
TRIAL = 'rig = "rig.toml"\nstop = "0.2 s"\n'
RIG = 'step = "100 ms"\n[components]\nboat = {{ fmu = "curious.py:Curious", isolated = {} }}\n'


@pytest.fixture
def listening():
    """A port that a process on this machine could connect to."""
    import socket

    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


def ran(isolated: str, port: int, write, tmp_path: Path) -> list[dict[str, str]]:
    home = tmp_path / "home"
    home.mkdir(exist_ok=True)
    (home / "secret").write_text("the key")
    write("curious.py", f"HOME, PORT = {str(home)!r}, {port}\n{CURIOUS}")
    write("rig.toml", RIG.format(isolated))
    path = write("trial.toml", TRIAL)
    out = tmp_path / f"run-{len(isolated)}"
    result = run_trial(load_trial(str(path)), out)
    assert result.status == "complete", result.error
    with (out / "signals.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
@needs_bwrap
def test_nothing_outside_is_reached(listening, write, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("SEATRIAL_TEST_SECRET", "the token")
    free = ran("true", listening, write, tmp_path)
    bound = ran('"sandboxed"', listening, write, tmp_path)
    assert [row["boat.y"] for row in bound] == [row["boat.y"] for row in free]
    found = json.loads(free[-1]["boat.found"])  # what it would do, did it run without
    assert found["home"] == "the key"
    assert found["environment"] == "the token"
    assert found["connect"].startswith("<socket")
    (tmp_path / "home" / "left").unlink()
    mine = Path(f"/tmp/seatrial-{listening}")
    mine.unlink()
    found = json.loads(bound[-1]["boat.found"])
    assert found["own"] == 1
    assert not mine.exists()
    assert not (tmp_path / "home" / "left").exists()
    for what in ("home", "list", "write", "connect"):
        assert found[what].startswith("not: "), found
    assert len(found["processes"]) <= 3
    assert found["environment"] is None


@pytest.mark.slow
@needs_bwrap
def test_its_end_is_ours(write, tmp_path: Path) -> None:
    """A component that never returns is ended, with all that the sandbox holds."""
    source = CURIOUS.replace("self.x += h", "import time; time.sleep(1000)")
    write("curious.py", f"HOME, PORT = '/', 1\n{source}")
    write("rig.toml", RIG.format('"sandboxed", timeout = "1 s"'))
    path = write("trial.toml", TRIAL)
    result = run_trial(load_trial(str(path)), tmp_path / "run")
    assert result.status == "failed"
    assert "was ended for not answering within 1 s" in (result.error or "")
    listed = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True).stdout
    assert str(tmp_path) not in listed


GREEDY = """
import ctypes

import numpy

from seatrial.model.component import Component, Output


class Greedy(Component):
    \"\"\"Takes memory up to 4 GiB, and writes to none of it.\"\"\"

    y = Output("m", "output")

    def start(self, t):
        self.kept = []

    def step(self, t, h):
        for _ in range(16 if t > 0.05 else 0):
            {takes}

    def outputs(self, t):
        self.y = t
"""
LIBC = "import ctypes; libc = ctypes.CDLL(None); libc.malloc.restype = ctypes.c_void_p"


@pytest.mark.slow
@needs_bwrap
@pytest.mark.parametrize(
    ("takes", "said"),
    [
        ("self.kept.append(numpy.empty(1 << 28, 'u1'))", "MemoryError"),
        # As C code does that does not look at what it gets.
        (
            "p = libc.malloc(ctypes.c_size_t(1 << 28)); ctypes.memset(p or 0, 1, 1)",
            "was ended by SIGSEGV|exited with status 139",
        ),
    ],
)
def test_its_memory_is_bounded(takes: str, said: str, write, tmp_path: Path) -> None:
    write("greedy.py", f"{LIBC}\n{GREEDY.format(takes=takes)}")
    write("rig.toml", RIG.format('"sandboxed"').replace("curious.py:Curious", "greedy.py:Greedy"))
    write("trial.toml", TRIAL.replace("0.2 s", "1 s"))
    done = seatrial("run", "trial.toml", "--out", "run", cwd=tmp_path)
    assert done.returncode == 3
    assert re.search(f"boat: .*({said})", done.stderr)
    assert "(its sandbox has 4 GiB of memory)" in done.stderr
    lines = (tmp_path / "run" / "signals.csv").read_text().splitlines()
    assert lines == ["time,boat.y", "0.0,0.0", "0.1,0.1"]


@needs_bwrap
def test_its_files_in_memory_are_bounded(write, tmp_path: Path) -> None:
    """What /tmp and /dev/shm hold, and that nothing else of it can be written."""
    source = CURIOUS.replace(
        '"own": Path(f"/tmp/seatrial-{PORT}").write_text("x"),',
        '"own": [os.statvfs(p).f_blocks * os.statvfs(p).f_frsize for p in ("/tmp", "/dev/shm")],'
        ' "dev": reached(lambda: Path("/dev/own").write_text("x")),',
    )
    write("curious.py", f"HOME, PORT = '/', 1\n{source}")
    write("rig.toml", RIG.format('"sandboxed"'))
    result = run_trial(load_trial(str(write("trial.toml", TRIAL))), tmp_path / "run")
    assert result.status == "complete", result.error
    with (tmp_path / "run" / "signals.csv").open(newline="") as file:
        found = json.loads(list(csv.DictReader(file))[-1]["boat.found"])
    assert found["own"] == [1 << 30] * 2
    assert found["dev"] == "not: 30"


def test_where_there_is_no_bubblewrap(write, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(sandbox.shutil, "which", lambda _: None)
    with pytest.raises(InputError, match=r"boat\.fmu: isolated = \"sandboxed\" needs bubblewrap"):
        ran('"sandboxed"', 1, write, tmp_path)


def test_where_bubblewrap_may_not_make_name_spaces(write, tmp_path: Path, monkeypatch) -> None:
    fake = tmp_path / "bwrap"
    fake.write_text("#!/bin/sh\necho 'bwrap: No permissions to create new namespace' >&2\nexit 1\n")
    fake.chmod(0o755)
    monkeypatch.setattr(sandbox.shutil, "which", lambda _: str(fake))
    with pytest.raises(InputError, match="cannot make a sandbox here: bwrap: No permissions"):
        ran('"sandboxed"', 1, write, tmp_path)


def test_the_word_is_checked(write, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"components\.boat\.isolated: .*'sandboxed'"):
        ran('"jailed"', 1, write, tmp_path)


LIAR = """
import os
import sys

from seatrial.model.component import Component, Output


class Liar(Component):
    \"\"\"Answers in the place of its worker.\"\"\"

    y = Output("m", "output")

    def step(self, t, h):
        self.y = t
        os.write(int(sys.argv[2]), ANSWER)
"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "answer",
    [
        frame(RESULT, 0, frame(RESULT, 0, b"short") + frame(RESULT, 1, b"x") * 3),
        frame(FAILURE, 0, b"[" * 100_000),
        frame(FAILURE, 0, b"[1]"),
        frame(FAILURE, 0, b'["SimulationError", "no"]'),
        frame(FAILURE, 0, b"\xff"),
        frame(9, 0, b""),
        struct.pack("<IHI", 2**32 - 1, RESULT, 0),
    ],
)
def test_a_worker_that_was_taken_over_ends_the_run(answer: bytes, write, tmp_path: Path) -> None:
    write("liar.py", f"ANSWER = {answer!r}\n{LIAR}")
    write("rig.toml", RIG.format("true").replace("curious.py:Curious", "liar.py:Liar"))
    result = run_trial(load_trial(str(write("trial.toml", TRIAL))), tmp_path / "run")
    assert result.status == "failed"
    assert (result.error or "").startswith("boat: ") or result.error == "no"
