"""Names of bundles, remembered in the user's cache by the stamps of the files they are made of.

A name carries the hash of everything that its FMU carries. Reading and parsing a hundred
modules for it takes longer than loading the FMU, so what was found is kept until a file, a
folder with modules, or what is installed has changed.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
import sysconfig
import time
from collections.abc import Iterable
from pathlib import Path

from ... import __version__
from ..cache import cache_folder, write_named
from ..components.source import ComponentSource
from .bundle import bundled

_SETTLED_NS = 2 * 10**9
"""A file that was just written may be written again within the grain of its stamps."""

Stamp = list[int]


def bundle_name(source: ComponentSource) -> str:
    """Return the name of the script in a component's bundle; see `bundle`."""
    what = [source.stem, source.script.hex(), str(source.folder), __version__]
    what += [sys.version, __file__]
    key = hashlib.sha256("\0".join(what).encode()).hexdigest()[:24]
    kept = cache_folder("bundles") / f"{key}.json"
    name = _remembered(kept)
    if name is None:
        began = time.time_ns()
        made = bundled(source)
        name, stamps = made.script, _stamps(made.read, source.folder)
        if all(began - max(stamp[:2]) > _SETTLED_NS for stamp in stamps.values()):
            write_named(kept, json.dumps({"name": name, "stamps": stamps}).encode())
    return name


def _remembered(kept: Path) -> str | None:
    """Return a name that was kept, None if there is none or anything changed since."""
    try:
        content = json.loads(kept.read_bytes())
        changed = any(_stamp(path) != stamp for path, stamp in content["stamps"].items())
        return None if changed else str(content["name"])
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _stamps(files: Iterable[Path], folder: Path | None) -> dict[str, Stamp]:
    """Return the stamps of files and of all folders where another file could take their place."""
    installed = {Path(sysconfig.get_path(kind)) for kind in ("purelib", "platlib")}
    paths = {*installed, *(p for file in files for p in (file, file.parent))}
    if folder is not None:
        paths.add(folder)
    return {str(path): _stamp(str(path)) for path in sorted(paths)}


def _stamp(path: str) -> Stamp:
    """Return what changes when a file is written or replaced, or a folder's names change."""
    status = os.stat(path)  # of a hundred files
    return [status.st_mtime_ns, status.st_ctime_ns, status.st_ino, status.st_size]
