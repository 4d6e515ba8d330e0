"""The C compiler of native FMUs: Zig's, which pip installs and which builds for any platform."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from ...errors import InputError, unknown
from ..cache import cache_folder

TARGETS = {
    "linux64": ("x86_64-linux-gnu.2.17", ".so"),
    "aarch64-linux": ("aarch64-linux-gnu.2.17", ".so"),
    "win64": ("x86_64-windows-gnu", ".dll"),
    "darwin64": ("x86_64-macos", ".dylib"),
}
"""Zig's name of each platform, by FMI's, and the suffix of a library."""

FLAGS = (
    "-std=c99",
    "-O2",
    "-shared",
    "-fPIC",
    "-fvisibility=hidden",  # FMUs of one process do not see each other's tables
    "-Wall",
    "-ffp-contract=off",  # a fused multiplication and addition is another number
    "-fno-builtin",  # and so is x * x for pow(x, 2)
    "-fno-sanitize=undefined",
)


def checked_platforms(text: str) -> list[str]:
    """Return the platforms that a text names, separated by commas. Raises InputError."""
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name not in TARGETS:
            raise InputError(unknown("platform", name, list(TARGETS)))
    return names


def library(sources: Mapping[str, bytes], platform: str) -> bytes:
    """Return the shared library of C ``sources`` by file name, for a platform of `TARGETS`.

    The same sources give the same bytes. Raises InputError if there is no compiler, or it finds
    an error.
    """
    if importlib.util.find_spec("ziglang") is None:
        raise InputError("native FMUs need a C compiler to build: pip install 'seatrial[native]'")
    target, suffix = TARGETS[platform]
    files = [name for name in sorted(sources) if name.endswith(".c")]
    with tempfile.TemporaryDirectory() as folder:
        for name, content in sources.items():
            Path(folder, name).write_bytes(content)
        own = f"model{suffix}"
        command = [sys.executable, "-m", "ziglang", "cc", "-target", target, *FLAGS, "-s", "-I."]
        command += [*files, "-o", own, *([] if platform == "win64" else ["-lm"])]
        kept = {"ZIG_GLOBAL_CACHE_DIR": str(cache_folder("zig")), "ZIG_LOCAL_CACHE_DIR": folder}
        run = subprocess.run(
            command, cwd=folder, env=os.environ | kept, capture_output=True, text=True
        )
        if run.returncode or run.stderr:
            raise InputError(f"the C compiler for {platform}: {run.stderr.strip()[-2000:]}")
        return Path(folder, own).read_bytes()
