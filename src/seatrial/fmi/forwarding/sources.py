"""C that checks calls and passes them on to pythonfmu's library."""

from __future__ import annotations

from pathlib import Path

import fmpy

from ...model.component import Component
from ..version3.sources import front_sources

_OWN = Path(__file__).parent
SEAL = _OWN / "seal.h"
"""C that native FMUs have, too."""
_SOURCES = ("checked.c", "folder.c", "folder.h", "forwarded.h", "retired.h", SEAL.name)
_HEADERS = ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h")
"""FMI's own (2-clause BSD, as they say), from FMPy."""


def checked_sources(version: int, component: Component | None = None) -> dict[str, bytes]:
    """Return the sources by file name of a library of FMI 2.0, or 3.0 by ``version``.

    What loads pythonfmu's library, `library_of`, is to be compiled with them.
    """
    headers = Path(fmpy.__file__).parent / "c-code"
    files = [*(_OWN / name for name in _SOURCES), *(headers / name for name in _HEADERS)]
    own = {path.name: path.read_bytes() for path in files}
    return own | (front_sources(component) if version == 3 else {})


def forwarding_sources(version: int, component: Component | None = None) -> dict[str, bytes]:
    """Return the sources of a library for processes that have a Python."""
    forward = (_OWN / "forward.c").read_bytes()
    return {**checked_sources(version, component), "forward.c": forward}
