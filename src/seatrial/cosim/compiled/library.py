"""The library of `master.c`, compiled on demand."""

from __future__ import annotations

import ctypes
from functools import cache
from pathlib import Path

from ...fmi.on_demand import shared_library
from .structures import Master, Operation, Pace

_SOURCE = Path(__file__).with_name("master.c")


@cache
def library() -> ctypes.CDLL | None:
    """Return the library, None without a compiler that makes one here."""
    path = shared_library("master", _SOURCE.read_bytes(), ("-std=gnu11", "-O2"))
    if path is None:
        return None
    try:
        found = ctypes.CDLL(str(path))
    except OSError:
        return None
    found.master_size.restype = ctypes.c_int64
    found.master_run.argtypes = [ctypes.POINTER(Master), ctypes.c_int64]
    sizes = [ctypes.sizeof(one) for one in (Operation, Pace, Master)]
    return found if [found.master_size(i) for i in range(3)] == sizes else None
