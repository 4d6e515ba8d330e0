"""The library of `master.c`, compiled on demand into the user's cache, as FMUs are built.

A wheel that carried it would be one per platform and Python, with a build that can fail where
pip installs; here whoever has a compiler has it at the first run that can use it, editable
installs too, and everybody else has the master in Python, with the same numbers.
"""

from __future__ import annotations

import ctypes
import hashlib
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

from fmpy import sharedLibraryExtension

from ...errors import InputError
from ...fmi.cache import cache_folder, write_named
from .structures import Master, Operation, Pace

_SOURCE = Path(__file__).with_name("master.c")
_FLAGS = (
    "-std=gnu11",
    "-O2",
    "-shared",
    "-fPIC",
    "-fvisibility=hidden",
    "-ffp-contract=off",  # a fused multiplication and addition is another number
)


@cache
def library() -> ctypes.CDLL | None:
    """Return the library, None without a compiler that makes one here."""
    source = _SOURCE.read_bytes()
    digest = hashlib.sha256(source + " ".join((*_FLAGS, platform.machine())).encode())
    try:
        path = cache_folder("master") / f"{digest.hexdigest()[:16]}{sharedLibraryExtension}"
        if not path.is_file():
            made = _compiled()
            if made is None:
                return None
            write_named(path, made)
        return _loaded(path)
    except (OSError, InputError):
        return None


def _loaded(path: Path) -> ctypes.CDLL | None:
    found = ctypes.CDLL(str(path))
    found.master_size.restype = ctypes.c_int64
    found.master_run.argtypes = [ctypes.POINTER(Master), ctypes.c_int64]
    sizes = [ctypes.sizeof(one) for one in (Operation, Pace, Master)]
    return found if [found.master_size(i) for i in range(3)] == sizes else None


def _compiled() -> bytes | None:
    """Return what the first compiler that can compiles: the system's, or Zig's from pip."""
    for compiler in _compilers():
        with tempfile.TemporaryDirectory() as folder:
            target = Path(folder, f"master{sharedLibraryExtension}")
            kept = {"ZIG_GLOBAL_CACHE_DIR": str(cache_folder("zig")), "ZIG_LOCAL_CACHE_DIR": folder}
            mathematics = [] if sys.platform == "win32" else ["-lm"]
            run = subprocess.run(
                [*compiler, *_FLAGS, str(_SOURCE), "-o", str(target), *mathematics],
                env=os.environ | kept,
                capture_output=True,
            )
            if run.returncode == 0 and target.is_file():
                return target.read_bytes()
    return None


def _compilers() -> list[list[str]]:
    system = os.environ.get("CC") or "cc"
    found = [[system]] if shutil.which(system) else []
    if importlib.util.find_spec("ziglang"):
        found.append([sys.executable, "-m", "ziglang", "cc"])
    return found
