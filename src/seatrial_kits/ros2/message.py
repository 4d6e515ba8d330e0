"""Messages made of plain values: what is not given is 0, empty or False."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from .definitions import type_store

Builder = Callable[[Any], Any]


def message(kind: str, values: Mapping[str, Any]) -> Any:
    """Return a message of rosbags' class for ``kind``.

    A nested message is a mapping too, or a tuple of its fields in their order; times are whole
    nanoseconds.
    """
    return _nested(kind)(values)


@cache
def _nested(kind: str) -> Builder:
    store = type_store()
    made = store.types[kind]
    if kind == "builtin_interfaces/msg/Time":
        return lambda time: made(*divmod(time or 0, 1_000_000_000))
    fields = [(name, _field(entry)) for name, entry in store.fielddefs[kind][1]]
    builders = [builder for _, builder in fields]

    def build(values: Any) -> Any:
        if isinstance(values, tuple):
            return made(*(b(v) for b, v in zip(builders, values, strict=True)))
        given = values or {}
        if not given.keys() <= dict(fields).keys():
            raise KeyError(f"{kind} has no {sorted(given.keys() - dict(fields).keys())}")
        return made(*(builder(given.get(name)) for name, builder in fields))

    return build


def _field(entry: Any) -> Builder:
    from rosbags.interfaces import Nodetype

    sort, what = entry
    if sort == Nodetype.NAME:
        return _nested(what)
    if sort == Nodetype.BASE:
        zero: Any = {"string": "", "bool": False}.get(what[0], 0.0 if "f" in what[0] else 0)
        return lambda value: zero if value is None else value
    inner, size = what
    if inner[0] == Nodetype.BASE and inner[1][0] not in ("string", "bool"):
        kind = inner[1][0]
        empty = np.zeros(size if sort == Nodetype.ARRAY else 0, kind)
        return lambda values: empty if values is None else np.asarray(values, kind)
    element = _field(inner)
    return lambda values: [element(each) for each in values or ()]


def is_finite(part: Any) -> bool:
    """Return whether all numbers of a message are finite."""
    if isinstance(part, float):
        return math.isfinite(part)
    if isinstance(part, np.ndarray):
        return part.dtype.kind != "f" or bool(np.isfinite(part).all())
    if isinstance(part, list):
        return all(map(is_finite, part))
    if hasattr(part, "__dataclass_fields__"):
        return all(is_finite(getattr(part, name)) for name in part.__dataclass_fields__)
    return True


def stamp_ns(header: Any) -> int:
    """Return the stamp of a header, ns."""
    return int(header.stamp.sec) * 1_000_000_000 + int(header.stamp.nanosec)
