"""Python components to FMUs of FMI 3.0: a library in front of pythonfmu's, which has FMI 2.0."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import InputError, unknown
from .cache import cache_folder, write_named
from .export import fmu_files, pythonfmu_libraries, zipped
from .native.compiler import FLAGS, TARGETS, TUPLES, library
from .source import ComponentSource
from .version3.sources import forwarding_sources

Compiler = Callable[[Mapping[str, bytes], str, Sequence[str]], bytes]


def build_fmu3(
    source: ComponentSource,
    destination: Path,
    platforms: Sequence[str],
    start_values: Mapping[str, Any] | None = None,
    compiled: Compiler = library,
) -> Path:
    """Build the FMU of ``source`` at ``destination`` and return its path.

    As `export.build_fmu`, but of FMI 3.0, for the ``platforms`` named. Raises InputError without
    a compiler, and for a platform that pythonfmu has no library for.
    """
    beneath = pythonfmu_libraries()
    carried = {}
    for platform in platforms:
        if platform not in beneath:
            raise InputError(f"{source.origin}: {unknown('platform', platform, [*beneath])}")
        own = beneath[platform]
        carried[f"binaries/{TUPLES[platform]}/{source.stem}{own.suffix}"] = _front(
            platform, compiled
        )
        carried[f"resources/pythonfmu/{own.name}"] = own.read_bytes()
    content = zipped(fmu_files(source, start_values, carried, 3))
    destination.parent.mkdir(parents=True, exist_ok=True)
    write_named(destination, content)
    return destination


def _front(platform: str, compiled: Compiler) -> bytes:
    """Return the library, which is the same for all components: it is kept in the user's cache."""
    sources = forwarding_sources()
    what = repr((sorted(sources.items()), FLAGS, compiled.__name__))
    name = f"{platform}-{hashlib.sha256(what.encode()).hexdigest()[:16]}{TARGETS[platform][1]}"
    path = cache_folder("fronts") / name
    if not path.is_file():
        write_named(path, compiled(sources, platform, ("-ldl",)))
    return path.read_bytes()
