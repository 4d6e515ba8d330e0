"""C of FMI 3.0 in front of FMI 2.0."""

from __future__ import annotations

from pathlib import Path

import fmpy

from ...model.component import Component
from .buses import events_header

_OWN = Path(__file__).parent
_SOURCES = (
    *("absent.c", "chunks.c", "events.c", "fmi3.c", "fmi2Functions.h", "front.h", "values.c"),
    *("../forwarding/retired.h", "../forwarding/seal.h"),
)
_HEADERS = (
    *("fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    *("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
)
"""FMI's own (2-clause BSD, as they say), from FMPy: they travel with the sources."""


def front_sources(component: Component | None = None) -> dict[str, bytes]:
    """Return the sources by file name: functions of FMI 2.0 are to be compiled with them.

    They are the same for all but a ``component`` with CAN terminals, which has events.
    """
    headers = Path(fmpy.__file__).parent / "c-code"
    files = [_OWN / name for name in _SOURCES] + [headers / name for name in _HEADERS]
    own = {path.name: path.read_bytes() for path in files}
    return {**own, "events.h": events_header(component).encode()}
