"""The libraries that an FMU in Python carries, by its platforms."""

from __future__ import annotations

import hashlib
import importlib.util
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pythonfmu

from ...errors import InputError, unknown
from ...model.component import Component
from ..cache import cache_folder, write_named
from ..compiler import FLAGS, HERE, TARGETS, TUPLES, library, library_here
from .sources import forwarding_sources

Compiler = Callable[[Mapping[str, bytes], str, Sequence[str]], bytes]

_BINARIES = Path(pythonfmu.__file__).parent / "resources" / "binaries"


def pythonfmu_libraries() -> dict[str, Path]:
    """Return pythonfmu's libraries by FMI's platforms."""
    return {one.parent.name: one for one in sorted(_BINARIES.rglob("*pythonfmu-export.*"))}


def bare_libraries(stem: str) -> dict[str, bytes]:
    """Return pythonfmu's libraries alone, by path in an FMU of FMI 2.0: nothing is compiled."""
    return {
        f"binaries/{platform}/{stem}{own.suffix}": own.read_bytes()
        for platform, own in pythonfmu_libraries().items()
    }


def checked_libraries(
    stem: str,
    platforms: Sequence[str],
    version: int,
    compiled: Compiler | None = None,
    component: Component | None = None,
) -> dict[str, bytes]:
    """Return libraries that check every call, and pythonfmu's behind them, by path in the FMU.

    ``version`` of FMI is 2 or 3; with 3 a ``component`` has events if it has CAN terminals.
    Raises InputError without a compiler, and for a platform that pythonfmu has no library for.
    """
    behind = pythonfmu_libraries()
    carried = {}
    for platform in platforms:
        if platform not in behind:
            raise InputError(unknown("platform", platform, [*behind]))
        own = behind[platform]
        folder = TUPLES[platform] if version == 3 else platform
        sources = forwarding_sources(version, component)
        checked = _checked_library(sources, platform, compiled or _compiler(platform))
        carried[f"binaries/{folder}/{stem}{own.suffix}"] = checked
        carried[f"resources/pythonfmu/{own.name}"] = own.read_bytes()
    return carried


def why_unchecked() -> str:
    """Return why FMUs of FMI 2.0 that are built here do not check calls, empty if they do."""
    try:
        checked_libraries("x", [HERE], 2)
    except InputError as error:
        return str(error)
    return ""


def _compiler(platform: str) -> Compiler:
    """Return Zig's compiler, whose libraries run on older systems too; else this machine's."""
    has_zig = importlib.util.find_spec("ziglang") is not None
    return library if has_zig or platform != HERE else library_here


def _checked_library(sources: Mapping[str, bytes], platform: str, compiled: Compiler) -> bytes:
    """Return the library, the same for nearly all components: it is kept in the user's cache."""
    what = repr((sorted(sources.items()), FLAGS, compiled.__name__))
    name = f"{platform}-{hashlib.sha256(what.encode()).hexdigest()[:16]}{TARGETS[platform][1]}"
    path = cache_folder("fronts") / name
    if not path.is_file():
        write_named(path, compiled(sources, platform, ("-ldl",)))
    return path.read_bytes()
