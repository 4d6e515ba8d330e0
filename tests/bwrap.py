"""Tests that need bubblewrap: it may be missing, or a container may allow it no namespaces."""

import os
import shutil
import subprocess

import pytest

_EMPTY = ("bwrap", "--ro-bind", "/", "/", "--unshare-all", "true")


def _can() -> bool:
    there = shutil.which("bwrap") is not None
    return there and subprocess.run(_EMPTY, capture_output=True).returncode == 0


needs_bwrap = pytest.mark.skipif(
    not os.environ.get("SEATRIAL_NEED_TOOLCHAIN") and not _can(),
    reason="bubblewrap is missing, or makes no sandbox here",
)
