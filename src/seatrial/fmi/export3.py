"""Python components to FMUs of FMI 3.0: a library in front of pythonfmu's, which has FMI 2.0."""

from __future__ import annotations

import hashlib
import importlib.util
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .cache import cache_folder, write_named
from .export import fmu_files, pythonfmu_libraries, zipped
from .native.compiler import FLAGS, HERE, TARGETS, TUPLES, library, library_here, require_compiler
from .source import ComponentSource
from .version3.sources import forwarding_sources


def build_fmu3(
    source: ComponentSource, destination: Path, start_values: Mapping[str, Any] | None = None
) -> list[str]:
    """Build the FMU of ``source`` at ``destination``; return the platforms it is for.

    As `export.build_fmu`, but of FMI 3.0. With Zig's compiler it is for all platforms that
    pythonfmu has, else for this machine's. Raises InputError without any compiler.
    """
    beneath = pythonfmu_libraries()
    fronts = _fronts([*beneath])
    carried = {}
    for platform, front in fronts.items():
        own = beneath[platform]
        carried[f"binaries/{TUPLES[platform]}/{source.stem}{own.suffix}"] = front
        carried[f"resources/pythonfmu/{own.name}"] = own.read_bytes()
    content = zipped(fmu_files(source, start_values, carried, 3))
    destination.parent.mkdir(parents=True, exist_ok=True)
    write_named(destination, content)
    return [TUPLES[platform] for platform in fronts]


def _fronts(platforms: list[str]) -> dict[str, bytes]:
    """Return the libraries by those of ``platforms`` that this machine's compiler builds for.

    They are kept in the user's cache.
    """
    require_compiler()
    any_platform = importlib.util.find_spec("ziglang") is not None
    sources = forwarding_sources()
    compiled = library if any_platform else library_here
    digest = hashlib.sha256(repr((sorted(sources.items()), FLAGS, any_platform)).encode())
    found = {}
    for platform in platforms if any_platform else [p for p in platforms if p == HERE]:
        name = f"{platform}-{digest.hexdigest()[:16]}{TARGETS[platform][1]}"
        path = cache_folder("fronts") / name
        if not path.is_file():
            write_named(path, compiled(sources, platform, ("-ldl",)))
        found[platform] = path.read_bytes()
    return found
