"""File of all parameters as ArduPilot packs it, ``@PARAM/param.pck``."""

from __future__ import annotations

import struct
from collections.abc import Mapping

from .definition import INT8, INT16, INT32, REAL32
from .table import ParameterTable

_PLAIN, _WITH_DEFAULTS = 0x671B, 0x671C
_HEADER = struct.Struct("<HHH")
_LAYOUTS: Mapping[int, tuple[int, str]] = {
    INT8: (1, "<b"),
    INT16: (2, "<h"),
    INT32: (3, "<i"),
    REAL32: (4, "<f"),
}
"""ArduPilot's number of a type, and its bytes."""
_HAS_DEFAULT = 1 << 4


def packed(table: ParameterTable, *, defaults: bool) -> bytes:
    """Return all parameters, with the ``defaults`` of those that have another value if wanted.

    Each has its type and flags, how many characters its name has in common with the one before,
    how many follow, less 1, these, and its value.
    """
    names = sorted(table.names)
    found = [_HEADER.pack(_WITH_DEFAULTS if defaults else _PLAIN, len(names), len(names))]
    before = ""
    for name in names:
        found.append(_entry(table, name, before, defaults=defaults))
        before = name
    return b"".join(found)


def _entry(table: ParameterTable, name: str, before: str, *, defaults: bool) -> bytes:
    kind, layout = _LAYOUTS[table.kind(name)]
    common = next(n for n in range(len(name), -1, -1) if before[:n] == name[:n])
    value, default = _bytes(layout, table[name]), _bytes(layout, table.default(name))
    differs = defaults and default != value
    flags = _HAS_DEFAULT if differs else 0
    rest = name[common:].encode()
    head = bytes([kind | flags, common | len(rest) - 1 << 4])
    return head + rest + value + (default if differs else b"")


def _bytes(layout: str, value: float) -> bytes:
    return struct.pack(layout, value if layout == "<f" else round(value))
