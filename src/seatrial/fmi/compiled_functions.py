"""CasADi's functions as machine code: the same numbers as CasADi's own virtual machine, sooner."""

from __future__ import annotations

from pathlib import Path

import casadi as ca

from .on_demand import shared_library

_FLAGS = ("-std=c99", "-O1", "-DGCC_HASCLASSVISIBILITY")  # the last lets CasADi export its own
_known: dict[int, tuple[ca.Function, ca.Function]] = {}
"""By the hash of a function, which lives as long: the function, and what stands for it."""


def compiled_function(function: ca.Function) -> ca.Function:
    """Return a function compiled on demand, or the same one where there is no compiler."""
    if hash(function) not in _known:
        generator = ca.CodeGenerator("function.c", {"with_header": False})
        generator.add(function)
        path = shared_library("functions", generator.dump().encode(), _FLAGS)
        _known[hash(function)] = function, function if path is None else _loaded(function, path)
    return _known[hash(function)][1]


def _loaded(function: ca.Function, path: Path) -> ca.Function:
    try:
        return ca.external(function.name(), str(path))
    except RuntimeError:  # of a cache in which nothing may be executed, say
        return function
