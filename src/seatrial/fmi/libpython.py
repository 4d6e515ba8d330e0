"""The shared library of the running Python."""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path


def find_libpython() -> Path | None:
    """Return the shared library of this interpreter, or of the system's equal version."""
    name = f"libpython{sys.version_info.major}.{sys.version_info.minor}.so"
    folders = [
        Path(str(sysconfig.get_config_var("LIBDIR") or "")),
        Path(sys.base_prefix) / "lib",
        Path("/usr/lib") / str(sysconfig.get_config_var("MULTIARCH") or ""),
    ]
    for folder in folders:
        for candidate in (folder / f"{name}.1.0", folder / name):
            if candidate.is_file():
                return candidate
    return None
