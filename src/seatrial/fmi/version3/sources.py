"""C of FMI 3.0 in front of FMI 2.0."""

from __future__ import annotations

from pathlib import Path

import fmpy

_OWN = Path(__file__).parent
FORWARDED = _OWN / "forwarded.h"
"""What passes calls of FMI 2.0 on to pythonfmu's library."""
_SOURCES = ("absent.c", "chunks.c", "fmi3.c", "fmi2Functions.h", "front.h", "values.c")
_HEADERS = (
    *("fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    *("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
)
"""FMI's own (2-clause BSD, as they say), from FMPy: they travel with the sources."""


def front_sources() -> dict[str, bytes]:
    """Return the sources by file name: functions of FMI 2.0 are to be compiled with them."""
    headers = Path(fmpy.__file__).parent / "c-code"
    return {
        **{name: (_OWN / name).read_bytes() for name in _SOURCES},
        **{name: (headers / name).read_bytes() for name in _HEADERS},
    }


def forwarding_sources() -> dict[str, bytes]:
    """Return the sources of a library that passes all on to pythonfmu's."""
    return {
        **front_sources(),
        "forward.c": (_OWN / "forward.c").read_bytes(),
        FORWARDED.name: FORWARDED.read_bytes(),
    }
