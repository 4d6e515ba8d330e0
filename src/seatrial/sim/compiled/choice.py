"""Choice of the master: compiled where it can be."""

from __future__ import annotations

from ...system.system import System

ALGORITHMS = ("jacobi", "plain-jacobi", "gauss-seidel", "extrapolated")
"""Those that `program` knows."""


def is_compiled(system: System) -> bool:
    """Say if the master's steps are compiled: one of `ALGORITHMS`, FMUs in C, and a compiler."""
    return system.rig.file.algorithm in ALGORITHMS and _can_be(system)


def lost_by_algorithm(system: System) -> str:
    """Return a note where an algorithm alone is why steps are not compiled; else an empty text."""
    algorithm = system.rig.file.algorithm
    if algorithm in ALGORITHMS or not _can_be(system):
        return ""
    return (
        f"the master's steps are taken in Python, not in C: the algorithm {algorithm!r} is none of "
        f"{', '.join(ALGORITHMS)}"
    )


def _can_be(system: System) -> bool:
    instances = [part.instance for part in system.parts.values()]
    if not any(getattr(instance, "is_native", False) for instance in instances):
        return False
    from .library import library

    return library() is not None
