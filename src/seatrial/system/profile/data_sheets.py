"""Data sheets of sensors by name: ``part = "neo-m8n"`` in a profile takes what the file says."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...errors import InputError
from ..files import find_file, read_toml

KIND = "hil_profiles/parts"
_PART = "part"


def with_data_sheets(sensors: Any, profile: Path) -> tuple[Any, list[str]]:
    """Return the tables of a profile's sensors with what their parts say, and mistakes.

    A table's own keys come before those of the part, its source after that of the part.
    """
    if not isinstance(sensors, dict):
        return sensors, []
    found: dict[str, Any] = {}
    mistakes: list[str] = []
    for name, table in sensors.items():
        found[name] = table
        if isinstance(table, dict) and _PART in table:
            try:
                found[name] = _joined(table, profile)
            except InputError as error:
                mistakes.append(f"sensors.{name}.{_PART}: {error}")
    return found, mistakes


def data_sheets_of(profile: Path) -> Iterator[Path]:
    """Yield the files of the parts that a profile names. Raises InputError for one of none."""
    sensors = read_toml(profile)[0].get("sensors", {})
    for table in sensors.values() if isinstance(sensors, dict) else ():
        if isinstance(table, dict) and _PART in table:
            yield _file(table[_PART], profile)


def _joined(table: dict[str, Any], profile: Path) -> dict[str, Any]:
    path = _file(table[_PART], profile)
    sheet, _ = read_toml(path)
    own = {key: value for key, value in table.items() if key != _PART}
    if not isinstance(sheet.get("kind"), str) or _PART in sheet:
        raise InputError(f"{path}: a data sheet has a kind, and no part of its own")
    if own.get("kind", sheet["kind"]) != sheet["kind"]:
        raise InputError(f"{path} is of the kind {sheet['kind']!r}, not {own['kind']!r}")
    sources = [each["source"] for each in (sheet, own) if each.get("source")]
    return {**sheet, **own, "source": "; ".join(map(str, sources))}


def _file(name: Any, profile: Path) -> Path:
    if not isinstance(name, str):
        raise InputError(f"the name of a data sheet is needed, found {name!r}")
    return find_file(KIND, name, profile.parent)
