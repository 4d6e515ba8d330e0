"""Rigs: which components, with which parameters, wired how (``harness/rigs/*.toml``)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from ..component import NS
from ..errors import InputError
from ..units import quantity
from .files import FileModel, Source, find_file, read_toml, validated

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class ComponentEntry(FileModel):
    """One component of a rig."""

    fmu: str
    parameters: str | None = None
    """A vehicle's parameter set: ``hydrone``, or ``hydrone.TABLE`` for a table of another name."""
    profile: str | None = None
    """A section of the rig's profile: ``sensors.gnss``, ``actuators.port``."""
    set: dict[str, Any] = Field(default_factory=dict)
    step: str | None = None


class RigFile(FileModel):
    """The content of a rig file."""

    title: str = ""
    step: str
    algorithm: Literal["jacobi", "plain-jacobi"] = "jacobi"
    variant: str | None = None
    profile: str | None = None
    components: dict[str, ComponentEntry]
    connections: dict[str, str | list[str]] = Field(default_factory=dict)


@dataclass(frozen=True)
class Rig:
    """A rig file, read and checked as far as it can be without its FMUs."""

    file: RigFile
    read_from: Source

    @property
    def step_ns(self) -> int:
        """Communication step, ns."""
        return duration_ns(self.file.step, f"{self.read_from.path}: step")

    def connections(self) -> list[tuple[str, str]]:
        """Return (from, to) pairs as written, ports or scalars."""
        pairs = []
        for source, targets in self.file.connections.items():
            for target in [targets] if isinstance(targets, str) else targets:
                pairs.append((source, target))
        return pairs


def load_rig(name: str, relative_to: Path | None = None) -> Rig:
    """Read the rig ``name`` (shipped, in ``harness/rigs``, or a path). Raises InputError."""
    path = find_file("harness/rigs", name, relative_to)
    content, read_from = read_toml(path)
    rig = Rig(validated(RigFile, content, path), read_from)
    for component in rig.file.components:
        if not _IDENTIFIER.fullmatch(component):
            raise InputError(
                f"{path}: components.{component}: a component's name has letters, digits and '_' "
                "and starts with a letter or '_'"
            )
    if rig.step_ns <= 0:
        raise InputError(f"{path}: step: must be positive, found {rig.file.step!r}")
    return rig


def duration_ns(text: str, where: str) -> int:
    """Return a duration such as ``"10 ms"`` in whole nanoseconds; InputError says ``where``."""
    try:
        value = quantity(text, "s")
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return round(value * NS)
