"""Choice of the master: compiled where it can be."""

from __future__ import annotations

from ..system import System

ALGORITHMS = ("jacobi", "plain-jacobi", "gauss-seidel", "extrapolated")
"""Those that `program` knows."""


def is_compiled(system: System) -> bool:
    """Say if the master's steps are compiled: one of `ALGORITHMS`, FMUs in C, and a compiler."""
    instances = [part.instance for part in system.parts.values()]
    if system.rig.file.algorithm not in ALGORITHMS:
        return False
    if not any(getattr(instance, "is_native", False) for instance in instances):
        return False
    from .library import library

    return library() is not None
