"""Commands of whose output nobody reads the rest, as `head` does not: their status stays."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.cli import commands
from seatrial.shipped import shipped_folder
from tests.kit import OF_PROFILES, needs_kits

from ..command import seatrial

GLORIA = str(shipped_folder("harness") / "kits/arduino/firmware" / "gloria_autopilot")
COMMANDS = [
    (["--version"], 0),
    (["--help"], 0),
    (["list"], 0),
    (["profile", "check", "videoray"], 0),
    (["profile", "describe", "otter"], 0),
    (["sketch", "check", GLORIA, "--profile", "gloria:mega"], 0),
    (["decode", "videoray", "one.stream"], 0),
    (["decode", "videoray", "none.stream"], 2),
    (["list", "--all"], 2),
]
STREAM = "# seatrial stream 1\n" + "".join(
    f"{second}.000000000 > FAAF010100005500\n" for second in range(1000)
)
CODE = """
import json, os, sys
from seatrial.cli import main
unread, found = os.dup(1), []
for command in json.loads(sys.argv[1]):
    os.dup2(unread, 1)
    sys.argv = ["seatrial", *command]
    try:
        main()
        found.append(0)
    except SystemExit as end:
        found.append(end.code or 0)
os.write(2, b"statuses:" + json.dumps(found).encode())
"""


@pytest.mark.slow
@needs_kits(*OF_PROFILES, "sailing")
@pytest.mark.parametrize("buffered", [True, False])
def test_a_reader_that_is_gone_changes_no_status(buffered: bool, tmp_path: Path) -> None:
    (tmp_path / "one.stream").write_text(STREAM)
    ours, theirs = os.pipe()
    os.close(ours)
    given = json.dumps([command for command, _ in COMMANDS])
    options = [] if buffered else ["-u"]
    done = subprocess.run(
        [sys.executable, *options, "-c", CODE, given],
        cwd=tmp_path, stdout=theirs, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    os.close(theirs)
    assert "Traceback" not in done.stderr
    found = json.loads(done.stderr.partition("statuses:")[2])
    assert found == [status for _, status in COMMANDS], done.stderr


def test_another_pipe_that_breaks_is_no_verdict(monkeypatch, tmp_path: Path) -> None:
    def broken(name: str) -> None:
        raise BrokenPipeError(errno.EPIPE, "Broken pipe")

    monkeypatch.setattr(commands, "loaded", broken)
    done = seatrial("list", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (3, "seatrial: cannot write: Broken pipe\n")
