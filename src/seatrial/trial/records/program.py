"""Identity of the program that runs: its source, that of kits, and the libraries that compute."""

from __future__ import annotations

import hashlib
import importlib.metadata
import os
import platform
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from ... import __version__
from ...fmi.on_demand import compilers_of
from ...kits import OURS, kits
from ...shipped import shipped_folder

LIBRARIES = ("casadi", "fmpy", "numpy", "pint", "pythonfmu", "scipy")
"""Distributions that decide the numbers of a run."""
_CONTENT = ("fmus", "harness", "hil_profiles")
_SHIPPED = "_shipped"
"""Folder of the content in an installed package, which is counted by itself."""


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of `LIBRARIES`."""
    found = {name: importlib.metadata.version(name) for name in LIBRARIES}
    return {"python": platform.python_version(), **found}


@cache
def program() -> dict[str, str]:
    """Return what decides the bytes of all runs, beside a user's files, by name.

    seatrial and each further kit by version and a hash of all their files, libraries by
    version, the compiler by its command.
    """
    ours = [(name, Path(__file__).parents[3] / name) for name in OURS]
    ours += [(name, shipped_folder(name)) for name in _CONTENT]
    found = {"seatrial": f"{__version__}, source {hash_of(_files(ours))}"}
    for kit in kits().found:
        if kit.folder.parent.name not in OURS:
            found[f"kit {kit.name}"] = hash_of(_files([(kit.name, kit.folder)]))
    compilers = compilers_of()
    said = " ".join([*compilers[0], os.environ.get("CFLAGS", "")]) if compilers else "none"
    return {**found, **versions(), "compiler": said.strip()}


def hash_of(files: Iterator[tuple[str, Path]]) -> str:
    """Return a hash of files, each with its name."""
    digest = hashlib.sha256()
    for name, path in files:
        data = path.read_bytes()
        digest.update(f"{name}\0{len(data)}\0".encode() + data)
    return digest.hexdigest()[:16]


def _files(folders: list[tuple[str, Path]]) -> Iterator[tuple[str, Path]]:
    for name, folder in folders:
        for path in files_below(folder):
            inside = path.relative_to(folder)
            if inside.parts[0] != _SHIPPED:
                yield f"{name}/{inside.as_posix()}", path


def files_below(folder: Path) -> Iterator[Path]:
    """Yield the files below a folder in order, without hidden and compiled ones."""
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(f for f in folders if f != "__pycache__" and not f.startswith("."))
        yield from (Path(place, name) for name in sorted(names) if not name.startswith("."))
