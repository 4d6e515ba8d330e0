"""Rigs: which components, with which parameters, connected how (``harness/rigs/*.toml``)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import Field

from ..component import NS
from ..errors import InputError
from ..units import quantity
from .files import FileModel, Source, find_file, read_toml, validated
from .registry import ALGORITHMS

LONGEST_S = 9.0e9
"""Times are counted in ns in 64 bits: 285 years."""
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class IterationEntry(FileModel):
    """How the iterated algorithm repeats a step."""

    tolerance: float = Field(default=1e-6, gt=0.0, allow_inf_nan=False)
    """Of every connection's value, relative to the nominal value of its output."""
    count: int = Field(default=10, ge=1, le=1000)
    """At most so many repetitions."""
    relaxation: float = Field(default=1.0, gt=0.0, le=1.0)
    """Share of each repetition's change that is applied."""


class ConnectionEntry(FileModel):
    """One end of a connection with a linear transformation, after conversion of units."""

    to: str
    factor: float = Field(default=1.0, allow_inf_nan=False)
    offset: float = Field(default=0.0, allow_inf_nan=False)
    convert: bool = True
    """Units are converted, and must measure the same."""


class ComponentEntry(FileModel):
    """One component of a rig."""

    fmu: str
    parameters: str | None = None
    """A vehicle's parameter set: ``hydrone``, or ``hydrone.TABLE`` for a table of another name."""
    profile: str | None = None
    """A section of the rig's profile, ``sensors.gnss``, or of another, ``gloria:sensors.gnss``."""
    set: dict[str, Any] = Field(default_factory=dict)
    step: str | None = None
    isolated: bool = False
    """It runs in a process of its own."""
    timeout: str | None = None
    """Longest wall time of one call of an isolated component."""


class RigFile(FileModel):
    """The content of a rig file."""

    title: str = ""
    step: str
    algorithm: str = "jacobi"
    """A name of `registry.ALGORITHMS`."""
    iteration: IterationEntry | None = None
    variant: str | None = None
    profile: str | None = None
    components: dict[str, ComponentEntry]
    connections: dict[str, str | ConnectionEntry | list[str | ConnectionEntry]] = Field(
        default_factory=dict
    )


@dataclass(frozen=True)
class Rig:
    """A rig file, read and checked as far as it can be without its FMUs."""

    file: RigFile
    read_from: Source
    unpacked: Path | None = None
    """The folder of its FMUs, if it was read from a package."""

    @property
    def folder(self) -> Path:
        """Folder that relative paths of FMUs start from."""
        return self.unpacked or self.read_from.path.parent

    @property
    def step_ns(self) -> int:
        """Communication step, ns."""
        return duration_ns(self.file.step, f"{self.read_from.path}: step")

    def changed(self, changes: Mapping[str, Any]) -> Rig:
        """Return the rig with keys of its file replaced. Raises InputError."""
        content = {**self.file.model_dump(exclude_unset=True), **changes}
        file = validated(RigFile, content, self.read_from.path)
        return _checked(replace(self, file=file))

    def connections(self) -> list[tuple[str, ConnectionEntry]]:
        """Return (from, where to) pairs as written, ports or scalars."""
        pairs = []
        for source, targets in self.file.connections.items():
            for target in targets if isinstance(targets, list) else [targets]:
                entry = ConnectionEntry(to=target) if isinstance(target, str) else target
                pairs.append((source, entry))
        return pairs


def load_rig(name: str, relative_to: Path | None = None) -> Rig:
    """Read the rig ``name`` (shipped, in ``harness/rigs``, or a path). Raises InputError."""
    path = find_file("harness/rigs", name, relative_to)
    content, read_from = read_toml(path)
    return _checked(Rig(validated(RigFile, content, path), read_from))


def _checked(rig: Rig) -> Rig:
    path, file = rig.read_from.path, rig.file
    for name, component in file.components.items():
        if not _IDENTIFIER.fullmatch(name):
            raise InputError(
                f"{path}: components.{name}: a component's name has letters, digits and '_' "
                "and starts with a letter or '_'"
            )
        if component.timeout is not None and not component.isolated:
            raise InputError(f"{path}: components.{name}.timeout: needs isolated = true")
    if rig.step_ns <= 0:
        raise InputError(f"{path}: step: must be positive, found {file.step!r}")
    _check_algorithm(path, file)
    return rig


def _check_algorithm(path: Path, file: RigFile) -> None:
    try:
        ALGORITHMS.target(file.algorithm)
        # What a package brings is imported at once only where a setting depends on it.
        if file.iteration and not getattr(ALGORITHMS.load(file.algorithm), "iterates", False):
            raise InputError(
                f"iteration has no effect with {file.algorithm!r}, only with one that iterates, "
                'such as "iterated"'
            )
    except InputError as error:
        raise InputError(f"{path}: algorithm: {error}") from None


def duration_ns(text: str, where: str) -> int:
    """Return a duration such as ``"10 ms"`` in whole nanoseconds; InputError says ``where``."""
    try:
        value = quantity(text, "s")
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    if abs(value) > LONGEST_S:
        raise InputError(f"{where}: {text!r} is beyond {LONGEST_S:g} s")
    return round(value * NS)
