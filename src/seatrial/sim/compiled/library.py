"""The library of `master.c` and `decimals.c`, compiled on demand."""

from __future__ import annotations

import ctypes
from functools import cache
from pathlib import Path

from ...fmi.on_demand import shared_library
from .structures import Master, Operation, Pace

_SOURCES = tuple(Path(__file__).with_name(name) for name in ("master.c", "fmi3.c", "decimals.c"))


@cache
def library() -> ctypes.CDLL | None:
    """Return the library, None without a compiler that makes one here."""
    text = b"\n".join(source.read_bytes() for source in _SOURCES)
    path = shared_library("master", text, ("-std=gnu11", "-O2"))
    if path is None:
        return None
    try:
        found = ctypes.CDLL(str(path))
    except OSError:
        return None
    found.master_size.restype = ctypes.c_int64
    found.master_run.argtypes = [ctypes.POINTER(Master), ctypes.c_int64]
    found.rows_as_text.restype = None
    sizes = [ctypes.sizeof(one) for one in (Operation, Pace, Master)]
    return found if [found.master_size(i) for i in range(3)] == sizes else None


def function_address(name: str) -> int:
    """Return where a function of the library is, 0 without a library."""
    found = library()
    return 0 if found is None else ctypes.cast(getattr(found, name), ctypes.c_void_p).value or 0
