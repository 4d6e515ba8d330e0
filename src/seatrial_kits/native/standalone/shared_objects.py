"""Shared libraries: what they need of a machine."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable
from pathlib import Path

_C_LIBRARY = re.compile(
    r"(ld-linux.*|linux-vdso|linux-gate|lib(c|m|dl|pthread|rt|util|resolv|nsl|anl))\.so.*"
)
"""What every machine with Linux and glibc has."""
_LINE = re.compile(r"\s*(?P<name>\S+) => (?P<path>/\S+)")
_VERSION = re.compile(rb"GLIBC_(2\.\d+)")


def needed(libraries: Iterable[Path], folder: Path) -> dict[str, Path]:
    """Return the libraries that others need, by name: those that others of them need come first.

    Without those of glibc, those that are found in ``folder``, where ``libraries`` lie as they will
    in the FMU, and those that this machine lacks: what needs them, a plug-in of a solver say,
    does not load here either.
    """
    found: dict[str, Path] = {}

    def add(library: Path) -> None:
        for name, path in _of(library).items():
            if name not in found and not _C_LIBRARY.fullmatch(name) and folder not in path.parents:
                add(path)
                found[name] = path

    for library in libraries:
        add(library)
    return found


def least_glibc(contents: Iterable[bytes]) -> str:
    """Return the newest version of glibc that any of the binaries asks for."""
    versions = {version for content in contents for version in _VERSION.findall(content)}
    newest = max((tuple(map(int, v.split(b"."))) for v in versions), default=(2, 0))
    return ".".join(map(str, newest))


def _of(library: Path) -> dict[str, Path]:
    run = subprocess.run(["ldd", str(library)], capture_output=True, text=True)
    if run.returncode:  # not a dynamic one
        return {}
    return {m["name"]: Path(m["path"]) for m in map(_LINE.match, run.stdout.splitlines()) if m}
