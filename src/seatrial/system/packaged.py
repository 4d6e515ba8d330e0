"""Packages of other tools, as their readers return them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .rig import Rig

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
