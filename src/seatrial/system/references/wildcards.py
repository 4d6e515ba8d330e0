"""References of many entries at once: ``"position_*" = "= rov.propeller_position_*"``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from ...errors import InputError
from .entries import DerivedEntry

Tables = Mapping[str, Mapping[str, Any]]
_NAME = re.compile(r"=\s*([A-Za-z_][\w.-]*\*\w*)\s*")


def expanded(tables: Tables, where: str) -> dict[str, dict[str, Any]]:
    """Return tables of entries with each wildcard in the place of which stands what it matches.

    ``*`` stands for one or more letters, digits or underscores, once in the key and once in the
    name. An entry of its own goes before. Raises InputError for one that matches nothing.
    """
    return {
        name: _expanded(name, table, tables, f"{where}: {name}") if _has_any(table) else dict(table)
        for name, table in tables.items()
    }


def _has_any(table: Mapping[str, Any]) -> bool:
    return any("*" in key for key in table)


def _expanded(own: str, table: Mapping[str, Any], tables: Tables, where: str) -> dict[str, Any]:
    entries: dict[str, Any] = {}
    for key, entry in table.items():
        new = _matched(own, key, entry, tables, f"{where}.{key}") if "*" in key else {key: entry}
        entries |= {name: value for name, value in new.items() if name == key or name not in table}
    return entries


def _matched(own: str, key: str, entry: Any, tables: Tables, where: str) -> dict[str, Any]:
    """Return an entry for each one that the name in ``entry`` matches."""
    text = entry.value if isinstance(entry, DerivedEntry) else None
    said = _NAME.fullmatch(text) if isinstance(text, str) else None
    if said is None or key.count("*") != 1:
        raise InputError(
            f'{where}: a key with * needs the name of other entries with one *, "= table.entry_*", '
            f"found {getattr(entry, 'value', entry)!r}"
        )
    name = said[1]
    place, _, pattern = name.rpartition(".")
    place = place or own
    if place not in tables:
        raise InputError(f"{where}: there is no table {place!r}, allowed {', '.join(tables)}")
    before, _, after = pattern.partition("*")
    wanted = re.compile(rf"{re.escape(before)}(\w+){re.escape(after)}")
    found = {other: m[1] for other in tables[place] if (m := wanted.fullmatch(other))}
    if not found:
        there = ", ".join(tables[place])
        raise InputError(f"{where}: {name} matches nothing, {place} has {there}")
    return {
        key.replace("*", part): entry.model_copy(update={"value": f"= {place}.{other}"})
        for other, part in found.items()
    }
