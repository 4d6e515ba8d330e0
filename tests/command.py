"""The command line in this process: a process of its own spends seconds on its imports."""

from __future__ import annotations

import contextlib
import io
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from seatrial.cli import main

SEATRIAL = str(Path(sys.executable).with_name("seatrial"))
"""The command as it was installed, for a process of its own."""


class Done(NamedTuple):
    """How a command ended, as `subprocess.run` would say it."""

    returncode: int
    stdout: str
    stderr: str


def seatrial(*arguments: str, cwd: Path) -> Done:
    """Run a command in a folder and return its status and what it printed."""
    stdout, stderr = io.StringIO(), io.StringIO()
    before, status = sys.argv, 0
    sys.argv = ["seatrial", *arguments]
    try:
        with (
            contextlib.chdir(cwd),
            contextlib.redirect_stdout(stdout),
            contextlib.redirect_stderr(stderr),
        ):
            main()
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
    finally:
        sys.argv = before
    return Done(status, stdout.getvalue(), stderr.getvalue())


def seatrial_process(*arguments: str, cwd: Path) -> Done:
    """Run a command in a process of its own: for what depends on how a process begins or ends."""
    done = subprocess.run(
        [SEATRIAL, *arguments], cwd=cwd, capture_output=True, text=True, check=False
    )
    return Done(done.returncode, done.stdout, done.stderr)
