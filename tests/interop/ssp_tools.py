"""Other people's tools that run an SSP package, each in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

TOOLS = ("libcosim", "ecos", "fmpy")


def started(tool: str, package: Path, **job: Any) -> subprocess.CompletedProcess[str]:
    """Run ``package`` in ``tool``: ``steps`` steps of ``step`` s, watching ``watch``."""
    runner = Path(__file__).with_name(f"ssp_{tool}_run.py")
    work = {"package": str(package), "step": 0.01, "parameters": None, **job}
    # ecos needs the library of the package tbb, which lies in the environment's lib.
    libraries = str(Path(sys.prefix) / "lib")
    # The tools leave what they unpack; the runner's exit is none that would let them clean up.
    environment = {
        **os.environ, "LD_LIBRARY_PATH": libraries, "TMPDIR": str(package.parent)
    }  # fmt: skip
    return subprocess.run(
        [sys.executable, str(runner)], input=json.dumps(work), capture_output=True, text=True,
        check=False, env=environment, cwd=package.parent, timeout=300,
    )  # fmt: skip


def run(tool: str, package: Path, **job: Any) -> list[list[float]]:
    """Return the watched values after each step."""
    done = started(tool, package, **job)
    assert done.returncode == 0, done.stderr
    rows: list[list[float]] = json.loads(done.stdout.splitlines()[-1])
    return rows
