"""Files of the running Python and of installed distributions, for machines that have neither."""

from __future__ import annotations

import importlib.metadata
import json
import py_compile
import sys
import sysconfig
import tempfile
from collections.abc import Iterable, Iterator
from importlib.metadata import Distribution
from pathlib import Path, PurePosixPath

from packaging.requirements import Requirement

from seatrial.errors import InputError

_UNUSED = {
    *("__pycache__", "test", "tests", "idlelib", "idle_test", "tkinter", "turtledemo", "turtle.py"),
    *("ensurepip", "lib2to3", "pydoc_data", "site-packages", "dist-packages", "curses", "include"),
}
"""Folders and files that no component needs: tests, windows, terminals, installers."""
_UNUSED_EXTENSIONS = (
    *("_test", "_xxtest", "xx", "_ctypes_test", "_tkinter", "_curses", "readline", "_gdbm", "_dbm"),
    *("nis", "ossaudiodev", "_crypt", "spwd"),
)
_SUFFIXES_LEFT = (".a", ".c", ".h", ".hpp", ".pxd", ".pyc", ".pyi", ".pyx", ".cmake", ".exe")


def standard_library() -> Iterator[tuple[str, bytes]]:
    """Yield path, below Python's ``lib``, and content of the standard library's files."""
    root = Path(sysconfig.get_path("stdlib"))
    for path in sorted(root.rglob("*")):
        inside = path.relative_to(root)
        if not path.is_file() or _is_unused(PurePosixPath(inside.as_posix())):
            continue
        if inside.parts[0].startswith("config-") or path.name.startswith(_UNUSED_EXTENSIONS):
            continue
        yield f"{root.name}/{inside.as_posix()}", path.read_bytes()


def distributions(requirements: Iterable[str]) -> dict[str, Distribution]:
    """Return the distributions that pip requirements name, and those that they need, by name.

    Raises InputError for one that is not installed.
    """
    found: dict[str, Distribution] = {}
    todo = [Requirement(text) for text in requirements]
    while todo:
        needed = todo.pop()
        name = needed.name.lower().replace("_", "-").replace(".", "-")
        if name in found or (needed.marker and not needed.marker.evaluate({"extra": ""})):
            continue
        try:
            found[name] = importlib.metadata.distribution(needed.name)
        except importlib.metadata.PackageNotFoundError:
            raise InputError(
                f"{needed.name} has to travel in the FMU: it is not installed"
            ) from None
        todo += [Requirement(text) for text in found[name].requires or []]
    return dict(sorted(found.items()))


def files_of(distribution: Distribution) -> Iterator[tuple[str, bytes]]:
    """Yield path, below ``site-packages``, and content of a distribution's files.

    Raises InputError for one that was installed without a list of its files, or as a link to
    the folder of its sources.
    """
    name, listed = distribution.metadata["Name"], distribution.files
    origin = json.loads(distribution.read_text("direct_url.json") or "{}")
    if listed is None or origin.get("dir_info", {}).get("editable"):
        raise InputError(f"{name} has to travel in the FMU: install it, not a link to its sources")
    for file in sorted(listed):
        path = Path(str(distribution.locate_file(file)))
        if ".." in file.parts or _is_unused(file) or not path.is_file():
            continue
        yield file.as_posix(), path.read_bytes()


def compiled(path: str, source: bytes) -> tuple[str, bytes] | None:
    """Return path and content of a module's bytecode; None for a file that is not Python.

    Bound to no date and no file: Python takes it unchecked, and the same source gives the
    same bytes.
    """
    if not path.endswith(".py"):
        return None
    place = PurePosixPath(path)
    with tempfile.TemporaryDirectory() as folder:
        module, target = Path(folder, "module.py"), Path(folder, "module.pyc")
        module.write_bytes(source)
        unchecked = py_compile.PycInvalidationMode.UNCHECKED_HASH
        try:
            py_compile.compile(
                str(module), str(target), place.name, True, invalidation_mode=unchecked
            )
        except py_compile.PyCompileError:  # of another version: packages carry such, for later
            return None
        tag = sys.implementation.cache_tag
        return f"{place.parent}/__pycache__/{place.stem}.{tag}.pyc", target.read_bytes()


def _is_unused(path: PurePosixPath) -> bool:
    return bool(_UNUSED & set(path.parts)) or path.suffix in _SUFFIXES_LEFT
