"""The library of a rig's copies: its components, its steps and `batch.c`, compiled."""

from __future__ import annotations

import ctypes
import hashlib
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.fmi.cache import cache_folder, write_named
from seatrial.fmi.compiler import FLAGS, HERE, TARGETS, library_here, require_compiler
from seatrial.system.system import System
from seatrial_kits.interchange.rig_fmu.native import rig_in_c, why_not_native
from seatrial_kits.native.engine import carry_natively

_SOURCE = Path(__file__).with_name("batch.c")
_POINTER = ctypes.c_void_p
_COUNT = ctypes.c_int64


@dataclass(frozen=True)
class Program:
    """A rig in C: its library, the references of its variables by ``component.port``, its step."""

    library: ctypes.CDLL
    references: Mapping[str, int]
    step_ns: int


def program_of(system: System) -> Program:
    """Return the program of a system whose engine is "native" and whose parameters are given.

    It comes from the user's cache, and is compiled if it is not there. Raises InputError for a
    system with a component that has no C, naming the reasons, and without a compiler.
    """
    require_compiler()
    where = system.rig.read_from.path
    if whys := why_not_native(system, carry_natively(system, weather=True)):
        raise InputError(f"{where}: copies of it cannot be compiled; {'; '.join(whys)}")
    rig = rig_in_c(system, "rig")
    references = {name: each.reference for name, each in rig.face.variables.items()}
    sources = {**rig.sources, "batch.c": _SOURCE.read_bytes()}
    return Program(_loaded(_built(sources)), references, rig.step_ns)


@cache
def _processor() -> frozenset[str]:
    """Return what the processor can do beside what all of its kind can, as Linux names it."""
    if HERE != "linux64":
        return frozenset()
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return frozenset()
    return frozenset(next((line for line in text.splitlines() if line[:5] == "flags"), "").split())


def _options(processor: frozenset[str]) -> tuple[str, ...]:
    """Return options for what runs on this processor alone: copies step in lanes of its vectors."""
    for flag, lanes in (("avx512f", 8), ("avx2", 4)):
        if flag in processor:
            return "-march=native", f"-DLANES={lanes}"
    return ()


def _built(sources: Mapping[str, bytes]) -> Path:
    own = _options(_processor()), sorted(_processor())
    digest = hashlib.sha256(repr((FLAGS, HERE, sys.version_info[:2], own)).encode())
    for name, content in sorted(sources.items()):
        digest.update(name.encode() + b"\0" + hashlib.sha256(content).digest())
    path = cache_folder("batch") / f"{digest.hexdigest()[:16]}{TARGETS[HERE][1]}"
    if not path.is_file():
        write_named(path, library_here(sources, HERE, ("-lm", "-pthread"), own[0]))
    return path


def _loaded(path: Path) -> ctypes.CDLL:
    found = ctypes.CDLL(str(path))
    found.batch_new.restype, found.batch_new.argtypes = _POINTER, [_COUNT]
    found.batch_free.argtypes = [_POINTER]
    values: list[Any] = [_POINTER, _POINTER, _POINTER, _COUNT, _POINTER]
    found.batch_start.argtypes = found.batch_set.argtypes = values
    found.batch_override.argtypes = found.batch_reseed.argtypes = values
    found.batch_set_text.argtypes = [_POINTER, _POINTER, ctypes.c_uint32, ctypes.c_char_p]
    found.batch_get.argtypes = [_POINTER, _POINTER, _COUNT, _POINTER]
    found.batch_step.argtypes = [*values[:2], _COUNT, _COUNT, _POINTER, _COUNT, _POINTER]
    found.batch_message.restype = ctypes.c_char_p
    found.batch_message.argtypes = [_POINTER, _COUNT]
    found.batch_times.argtypes = [_POINTER, _POINTER, _POINTER]
    found.batch_save.argtypes = found.batch_free_states.argtypes = [_POINTER, _POINTER]
    found.batch_restore.argtypes = [_POINTER, _POINTER, _POINTER, _POINTER]
    found.batch_surround.argtypes = [_POINTER, _COUNT, _COUNT, _POINTER, _POINTER]
    for name in (
        "surround",
        "override",
        "reseed",
        "start",
        "set",
        "set_text",
        "get",
        "step",
        "times",
        "restore",
        "free",
        "free_states",
    ):
        getattr(found, f"batch_{name}").restype = None
    return found
