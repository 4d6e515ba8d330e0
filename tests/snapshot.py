"""Every value reachable from an object, to compare what was restored with what there was."""

from __future__ import annotations

import types
from collections.abc import Mapping
from typing import Any

import numpy as np

_LEAVES = (int, float, complex, str, bytes, bytearray, type(None), types.FunctionType)
_OPAQUE = (type, types.ModuleType, types.BuiltinFunctionType)


def snapshot(root: Any, but: frozenset[str] = frozenset()) -> dict[str, Any]:
    """Return copies of all values below ``root`` by path, attributes named in ``but`` left out.

    Of what is not from seatrial, its kits or tests (compiled functions, parsers of libraries) only the type.
    """
    found: dict[str, Any] = {}
    above: set[int] = set()

    def walk(path: str, value: Any) -> None:
        if isinstance(value, _OPAQUE) or callable(value):
            return
        if isinstance(value, _LEAVES):
            found[path] = bytes(value) if isinstance(value, bytearray) else value
        elif isinstance(value, np.ndarray):
            found[path] = value.tobytes()
        elif id(value) not in above:
            above.add(id(value))
            for name, part in _parts(value):
                if name not in but:
                    walk(f"{path}.{name}", part)
            above.remove(id(value))
            found[path] = type(value).__name__

    walk("", root)
    return found


def _parts(value: Any) -> list[tuple[str, Any]]:
    if isinstance(value, Mapping):
        return [(str(key), part) for key, part in value.items()]
    if isinstance(value, list | tuple):
        return [("length", len(value)), *((str(i), part) for i, part in enumerate(value))]
    if isinstance(value, set | frozenset):
        return [("members", sorted(map(repr, value)))]
    if type(value).__module__.split(".")[0] in ("seatrial", "seatrial_kits", "tests"):
        slots = {s: getattr(value, s) for s in getattr(value, "__slots__", ()) if hasattr(value, s)}
        return [*slots.items(), *getattr(value, "__dict__", {}).items()]
    if hasattr(value, "popleft"):  # a deque
        return _parts(list(value))
    return []


def changed(before: Mapping[str, Any], after: Mapping[str, Any]) -> set[str]:
    """Return the paths whose values differ."""
    missing = object()
    return {
        path
        for path in before.keys() | after.keys()
        if before.get(path, missing) != after.get(path, missing)
    }
