"""The seabed of a trial: its key ``seabed``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...errors import InputError
from ...system.files import FileModel
from ...system.references.values import from_written
from ...system.system import System

Quantity = float | str
_MARK = "seabed_depth"
"""Parameter by which a component says that it is over a seabed."""


class SeabedEntry(FileModel):
    """The seabed and what stands on it: the parameters of `OverSeabed` of the kit `underwater`."""

    depth: Quantity | None = None
    slope: Quantity | None = None
    direction: Quantity | None = None
    file: str | None = None
    obstacles: str | None = None

    @property
    def level(self) -> Quantity | None:
        """Depth of the water, if it is the same everywhere."""
        return None if self.slope or self.file else self.depth


def set_seabed(system: System, entry: SeabedEntry, where: str, folder: Path) -> None:
    """Give the seabed to all components that are over one; ``folder`` is the trial's.

    Raises InputError for a rig without such a component, or a value that does not fit.
    """
    over = [name for name, part in system.parts.items() if _MARK in part.instance.variables]
    if not over:
        raise InputError(f"{where}: no component of the rig looks at the seabed or touches it")
    for key, value in entry.model_dump(exclude_none=True).items():
        port = key if key == "obstacles" else f"seabed_{key}"
        for name in over:
            system.set(f"{name}.{port}", value, f"{where}.{key}", folder)


def water_depth(system: System, sea: Quantity | None, bed: SeabedEntry, where: str) -> Any:
    """Return the depth of the water under the waves: what ``sea`` says, or the level seabed's.

    Raises InputError if they differ: the water has one depth.
    """
    level = bed.level
    if sea is None or level is None:
        return level if sea is None else sea
    variables = next(
        part.instance.variables
        for part in system.parts.values()
        if _MARK in part.instance.variables
    )
    found = [
        from_written(depth, [variables[_MARK]], {}, where)[_MARK].value for depth in (sea, level)
    ]
    if found[0] != found[1]:
        raise InputError(f"{where}: sea.depth is {sea!r} and seabed.depth {level!r}: one is enough")
    return sea
