"""Short references inside a vehicle's folder: ``.TABLE`` and ``.GROUP.PART`` of that vehicle.

In ``harness/vehicles/otter``, ``parameters = ".hull"`` is ``otter.hull``, ``.hull.mass`` in an
expression is ``otter.hull.mass``, and ``rig = ".actuators.esc"`` is ``actuators/otter-esc``: a
folder that is copied under another name refers to itself.
"""

from __future__ import annotations

import re
from typing import Any

from ...errors import InputError
from .expressions import is_expression

_SHORT = re.compile(r"\.[A-Za-z_]")
_NAME = re.compile(r"(?<![\w.])\.(?=[A-Za-z_])")


def with_owner(content: Any, vehicle: str, where: str) -> Any:
    """Return a rig's content with short references written out.

    ``vehicle`` is whose folder the file is in; empty: none. Raises InputError for a short
    reference in a file of no vehicle's folder, and for a rig without group or part.
    """
    components = content.get("components")
    if not isinstance(components, dict):
        return content
    changed = {
        name: _component(entry, vehicle, f"{where}: components.{name}")
        for name, entry in components.items()
    }
    return {**content, "components": changed}


def _component(entry: Any, vehicle: str, where: str) -> Any:
    if not isinstance(entry, dict):
        return entry
    new = dict(entry)
    if _is_short(entry.get("parameters")):
        new["parameters"] = f"{_owner(vehicle, f'{where}.parameters')}{entry['parameters']}"
    if _is_short(entry.get("rig")):
        group, dot, part = entry["rig"][1:].partition(".")
        name = _owner(vehicle, f"{where}.rig")
        if not (dot and part):
            raise InputError(f"{where}.rig: .GROUP.PART is needed, found {entry['rig']!r}")
        new["rig"] = f"{group}/{name}-{part}"
    if isinstance(entry.get("set"), dict):
        new["set"] = {
            key: _written(value, vehicle, f"{where}.set: {key}")
            for key, value in entry["set"].items()
        }
    return new


def _written(value: Any, vehicle: str, where: str) -> Any:
    if isinstance(value, list):
        return [_written(each, vehicle, where) for each in value]
    if not is_expression(value) or not _NAME.search(value):
        return value
    return _NAME.sub(f"{_owner(vehicle, where)}.", value)


def _is_short(written: Any) -> bool:
    return isinstance(written, str) and _SHORT.match(written) is not None


def _owner(vehicle: str, where: str) -> str:
    if not vehicle:
        raise InputError(
            f"{where}: a name that begins with a dot is of the vehicle's own folder, and this "
            "file is in none"
        )
    return vehicle
