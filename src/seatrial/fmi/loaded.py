"""An FMU file as read: where it lies unpacked, and what its model description says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fmpy.model_description import ModelDescription

from ..terminals import Terminal
from .instance import Variables
from .variables import Array


@dataclass(frozen=True)
class LoadedFmu:
    """An FMU file unpacked and described; instances are made from it."""

    path: Path
    folder: Path
    sha256: str
    description: ModelDescription
    variables: Variables
    arrays: Mapping[int, Array]
    """What each value reference of an FMI 3 FMU stands for."""
    feedthrough: Mapping[str, Sequence[str]]
    terminals: Mapping[str, Terminal]
    """Groups of variables that are connected together."""
    views: Mapping[str, Mapping[str, str]]
    """What reports draw of it; see `ports.VIEWS`."""
    notes: tuple[str, ...]
    """What this FMU has that cannot be used here, for its user."""
