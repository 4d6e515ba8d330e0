"""Whole systems in files of other tools: SSP packages, and OSP-IS' system structures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..plugins import service
from .rig import Rig


def is_package(name: str, relative_to: Path | None = None) -> bool:
    """Say if ``name`` is a package: .ssp, .ssd, .xml, or a folder with one's description."""
    if name.endswith((".ssp", ".ssd", ".xml")):
        return True
    folder = (relative_to or Path.cwd()) / name
    return any((folder / file).is_file() for file in (OSP_FILE, SSP_FILE))


def read_package(path: Path, changes: Mapping[str, Any]) -> PackagedSystem:
    """Read the package at ``path``; ``changes`` may have another step for it.

    A folder with both descriptions is OSP's, as libcosim has it. Raises InputError naming file
    and line.
    """
    is_osp = path.suffix == ".xml" or (path / OSP_FILE).is_file()
    read: Callable[[Path, Any], PackagedSystem] = service(
        "interchange.read_osp" if is_osp else "interchange.read_ssp"
    )
    return read(path, changes.get("step"))


SSP_FILE = "SystemStructure.ssd"
"""The description that every SSP package has."""
OSP_FILE = "OspSystemStructure.xml"
"""The name that libcosim looks for in a folder."""


@dataclass(frozen=True)
class PackagedSystem:
    """A package read: its rig, the times it names, and what was met and not used."""

    title: str
    rig: Rig
    start: str | None
    stop: str | None
    notes: tuple[str, ...]
    called: Mapping[str, str] = field(default_factory=dict)
    """Components by the names in the package, where they are no identifiers."""
