"""C compilers of native FMUs: Zig's, which pip installs and which builds for any platform.

What only this machine runs may be built by the compiler that it has.
"""

from __future__ import annotations

import importlib.util
import os
import platform as machine
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..errors import InputError, unknown
from .cache import cache_folder

TARGETS = {
    "linux64": ("x86_64-linux-gnu.2.17", ".so"),
    "aarch64-linux": ("aarch64-linux-gnu.2.17", ".so"),
    "win64": ("x86_64-windows-gnu", ".dll"),
    "darwin64": ("x86_64-macos", ".dylib"),
    "aarch64-darwin": ("aarch64-macos", ".dylib"),
}
"""Zig's name of each platform, by FMI's, and the suffix of a library."""

TUPLES = {
    "linux64": "x86_64-linux",
    "aarch64-linux": "aarch64-linux",
    "win64": "x86_64-windows",
    "darwin64": "x86_64-darwin",
    "aarch64-darwin": "aarch64-darwin",
}
"""FMI 3.0's name of each platform, by FMI 2.0's."""

_HERE = {
    ("Linux", "x86_64"): "linux64",
    ("Linux", "aarch64"): "aarch64-linux",
    ("Windows", "AMD64"): "win64",
    ("Darwin", "x86_64"): "darwin64",
    ("Darwin", "arm64"): "aarch64-darwin",
}
HERE = _HERE.get((machine.system(), machine.machine()), "")
"""FMI's name of this machine's platform, empty for one that is not among `TARGETS`."""

_NO_COMPILER = "FMUs in C need a compiler to build: pip install 'seatrial[native]'"

SEMANTICS = (
    "-ffp-contract=off",  # a fused multiplication and addition is another number
    "-fno-builtin",  # and so is x * x for pow(x, 2)
    "-fno-math-errno",
)
"""Options that whoever compiles the sources needs for the same numbers."""

FLAGS = (
    "-std=c99",
    "-O2",
    "-shared",
    "-fPIC",
    "-fvisibility=hidden",  # FMUs of one process do not see each other's tables
    "-Wall",
    *SEMANTICS,
)


def checked_platforms(text: str) -> list[str]:
    """Return the platforms that a text names, separated by commas, by FMI 2.0's names.

    Those of FMI 3.0 are known too. Raises InputError.
    """
    by_tuple = {name: platform for platform, name in TUPLES.items()}
    names = [by_tuple.get(name.strip(), name.strip()) for name in text.split(",")]
    for name in names:
        if name not in TARGETS:
            raise InputError(unknown("platform", name, list(TARGETS)))
    return names


def require_compiler() -> None:
    """Raise InputError if this machine cannot build native FMUs for itself."""
    if not HERE:
        raise InputError(
            f"native FMUs are built for {', '.join(TARGETS)}, which this machine is none of"
        )
    if shutil.which("cc") is None and importlib.util.find_spec("ziglang") is None:
        raise InputError(_NO_COMPILER)


def library(
    sources: Mapping[str, bytes], platform: str, libraries: Sequence[str] = ("-lm",)
) -> bytes:
    """Return the shared library of C ``sources`` by file name, for a platform of `TARGETS`.

    The same sources give the same bytes. Raises InputError if there is no compiler, or it finds
    an error.
    """
    if importlib.util.find_spec("ziglang") is None:
        raise InputError(_NO_COMPILER)
    target, suffix = TARGETS[platform]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-fno-sanitize=undefined"]
    return _built(sources, command, suffix, platform, libraries)


def library_here(
    sources: Mapping[str, bytes],
    platform: str,
    libraries: Sequence[str] = ("-lm",),
    options: Sequence[str] = (),
) -> bytes:
    """Return the same for this machine's ``platform``, by its own compiler if it has one.

    ``libraries`` are options of the linker, ``options`` those of that compiler alone.
    """
    compiler = shutil.which("cc")
    if compiler is None:
        return library(sources, platform, libraries)
    return _built(sources, [compiler, *options], TARGETS[platform][1], platform, libraries)


def _built(
    sources: Mapping[str, bytes],
    compiler: Sequence[str],
    suffix: str,
    platform: str,
    libraries: Sequence[str],
) -> bytes:
    files = [name for name in sorted(sources) if name.endswith(".c")]
    with tempfile.TemporaryDirectory() as folder:
        for name, content in sources.items():
            Path(folder, name).write_bytes(content)
        own = f"model{suffix}"
        command = [*compiler, *FLAGS, "-s", "-I.", *files, "-o", own]
        command += [] if platform == "win64" else libraries
        kept = {"ZIG_GLOBAL_CACHE_DIR": str(cache_folder("zig")), "ZIG_LOCAL_CACHE_DIR": folder}
        run = subprocess.run(
            command, cwd=folder, env=os.environ | kept, capture_output=True, text=True
        )
        if run.returncode or run.stderr:
            raise InputError(f"the C compiler for {platform}: {run.stderr.strip()[-2000:]}")
        return Path(folder, own).read_bytes()
