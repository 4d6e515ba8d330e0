"""One component of an assembled rig."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..fmi.instance import Instance
from .parameters import Body, Outline
from .references.values import Given


@dataclass
class Part:
    """One component of an assembled rig."""

    name: str
    fmu: str
    instance: Instance
    sha256: str
    """Of the FMU file; empty in process."""
    code: str
    """Name and hash of the code, equal in both carriers; empty for a file of somebody else."""
    every: int
    """It steps once in so many communication steps."""
    given: dict[str, Given] = field(default_factory=dict)
    """Values set by the rig's user, by variable name; the others keep the FMU's start values."""
    outline: Outline | None = None
    """Of the vehicle whose parameters it has, if its file has one."""
    shape: Body | None = None
    """What is drawn of it, as its vehicle's file has it."""
    vehicle: tuple[Path, str] | None = None
    """The file and the table that its parameters are of."""
    drawn: list[dict[str, Any]] = field(default_factory=list)
    """The shape with signals in the place of ports, for manifests."""
    meshes: dict[str, Path] = field(default_factory=dict)
    """Files that the shape shows, by their names in a run's folder."""
    home: tuple[float, float, float] | None = None
    """Origin of {n} where it is, if its rig says one: latitude and longitude, rad; altitude, m."""
    presets: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    undecided: str = ""
    """Why the dependencies of its outputs are unknown, if so: all depend on all inputs then."""
    is_sum: bool = False
    """It takes no step: every algorithm evaluates it where values move."""
