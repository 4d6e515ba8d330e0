"""C compiled on demand into the user's cache, as FMUs are built; without a compiler there is none.

A wheel that carried it would be one per platform, with a build that can fail where pip installs.
What it compiles gives the numbers of what it stands for, which goes on where there is no compiler.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from ..errors import InputError
from .cache import cache_folder, write_named

_FLAGS = (
    "-shared",
    "-fPIC",
    "-fvisibility=hidden",
    "-ffp-contract=off",  # a fused multiplication and addition is another number
    "-fno-builtin",  # and so is x * x for pow(x, 2)
)
_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def shared_library(kind: str, source: bytes, flags: Sequence[str]) -> Path | None:
    """Return the library of a C file in the cache's folder ``kind``, None if none can be had."""
    compilers, options = compilers_of(), (*flags, *_FLAGS)
    said = " ".join((*options, platform.machine(), *(compilers[0] if compilers else ())))
    name = hashlib.sha256(source + said.encode()).hexdigest()[:16]
    try:
        path = cache_folder(kind) / f"{name}{_SUFFIX}"
        if not path.is_file():
            compiled = _compiled(source, options, compilers)
            if compiled is None:
                return None
            write_named(path, compiled)
    except (OSError, InputError):
        return None
    return path


def _compiled(
    source: bytes, options: Sequence[str], compilers: Sequence[Sequence[str]]
) -> bytes | None:
    """Return what the first compiler that can makes of a C file."""
    for compiler in compilers:
        with tempfile.TemporaryDirectory() as folder:
            text, target = Path(folder, "source.c"), Path(folder, f"library{_SUFFIX}")
            text.write_bytes(source)
            kept = {"ZIG_GLOBAL_CACHE_DIR": str(cache_folder("zig")), "ZIG_LOCAL_CACHE_DIR": folder}
            mathematics = [] if sys.platform == "win32" else ["-lm"]
            run = subprocess.run(
                [*compiler, *options, str(text), "-o", str(target), *mathematics],
                env=os.environ | kept,
                capture_output=True,
            )
            if run.returncode == 0 and target.is_file():
                return target.read_bytes()
    return None


def compilers_of(language: str = "c") -> list[list[str]]:
    """Return the commands of the compilers that there are: the system's, and Zig's from pip.

    ``language`` is ``c`` or ``c++``.
    """
    variable, usual = {"c": ("CC", "cc"), "c++": ("CXX", "c++")}[language]
    system = os.environ.get(variable) or usual
    found = [[system]] if shutil.which(system) else []
    if importlib.util.find_spec("ziglang"):
        found.append([sys.executable, "-m", "ziglang", usual])
    return found
