"""Plotly's JavaScript as pages carry it: packed, two fifths of its size."""

from __future__ import annotations

import hashlib
import importlib.util
import zlib
from functools import cache
from pathlib import Path

from ..fmi.cache import cache_folder, write_named
from .packed import packed


@cache
def plotly_js() -> str:
    """Return the library for a script element of a page; the page inflates it.

    Packing takes as long as the rest of a page, so the result is kept in the user's cache.
    """
    # Found, not imported: nothing else of the package is used.
    spec = importlib.util.find_spec("plotly")
    assert spec is not None
    assert spec.origin is not None
    source = Path(spec.origin).parent / "package_data" / "plotly.min.js"
    status = source.stat()
    what = f"{source} b85 {status.st_size} {status.st_mtime_ns} {zlib.ZLIB_RUNTIME_VERSION}"
    kept = cache_folder("pages") / f"plotly-{hashlib.sha256(what.encode()).hexdigest()[:16]}.txt"
    if not kept.is_file():
        write_named(kept, packed(source.read_bytes()).encode())
    return kept.read_text("ascii")
