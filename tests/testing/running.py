"""Pytest in a process of its own, with the plugin."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path
from xml.etree import ElementTree


def pytest_in(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run pytest in a folder; where this package is not installed the plugin is named."""
    installed = any(e.value == "seatrial.testing.plugin" for e in entry_points(group="pytest11"))
    named = [] if installed else ["-p", "seatrial.testing.plugin"]
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST_")}
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *named, *arguments],
        cwd=folder, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip


def cases(junit: Path) -> dict[str, ElementTree.Element]:
    """Return the test cases of a JUnit file by name."""
    return {case.get("name", ""): case for case in ElementTree.parse(junit).iter("testcase")}
