"""System structures as read: systems in systems, with connectors, values and connections."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from .annotations import StepSizes
from .definitions import Measure
from .parameters import Parameter
from .transformations import Transformation

FMU = "application/x-fmu-sharedlibrary"
PACKAGE = "application/x-ssp-package"
DEFINITION = "application/x-ssp-definition"

TABLES = ("text/csv", "application/table", "application/vnd.apache.parquet")
"""Files of values over time, as OMSimulator 3 and 2 have them, and Parquet's own type."""

DEEPEST = 32
"""Levels of systems inside systems."""
MOST_SYSTEMS = 1000
"""References can double at each level."""

Indices = tuple[int, ...]
"""Of one element of an array, one per dimension, from 1."""


@dataclass(frozen=True)
class Connector:
    """A connector of an element, or a signal of a dictionary."""

    name: str
    kind: str
    """input, output, parameter, calculatedParameter, inout ..."""
    type: type | None
    """None: the file says none, or it is a clock."""
    unit: Measure | None
    items: Mapping[str, int]
    """Of an enumeration that the file defines."""
    sizes: tuple[int | None, ...]
    """Of an array, by dimension; None where only the FMU knows it."""
    is_clock: bool
    where: str
    problem: str = ""
    """Why it cannot be connected."""


@dataclass(frozen=True)
class End:
    """One end of a connection; without element, it is a connector of the system itself."""

    element: str
    connector: str
    indices: Indices | None
    """None: the whole connector."""


@dataclass(frozen=True)
class Connection:
    """A connection; units are converted, if at all, before its transformation."""

    start: End
    end: End
    transformation: Transformation
    converts: bool
    where: str


@dataclass(frozen=True)
class Source:
    """What a ``source`` names: a file, and what the fragment behind ``#`` says of it."""

    file: Path | None
    """None for a fragment alone, which is in the description itself."""
    fragment: str
    isolated: bool = False
    """An FMU that is to run in a process of its own."""


@dataclass(frozen=True)
class Component:
    """A reference to an FMU, a package, or a system described elsewhere."""

    name: str
    kind: str
    source: Source
    """Without a file: in this description (`inner`), or nowhere. A package's has its variant."""
    inner: System | None
    implementation: str
    connectors: dict[str, Connector]
    parameters: list[Parameter]
    step: float | None
    where: str


@dataclass(frozen=True)
class Dictionary:
    """A signal dictionary: its signals by name."""

    name: str
    signals: dict[str, Connector]
    where: str


@dataclass(frozen=True)
class Reference:
    """A place where a system meets a signal dictionary."""

    name: str
    dictionary: str
    connectors: dict[str, Connector]
    where: str


@dataclass(frozen=True)
class System:
    """A system; its parameters are in the order in which later ones win."""

    name: str
    connectors: dict[str, Connector]
    parameters: list[Parameter]
    elements: dict[str, Component | System | Reference]
    connections: list[Connection]
    where: str
    dictionaries: dict[str, Dictionary] = field(default_factory=dict)


@dataclass(frozen=True)
class Structure:
    """A whole description."""

    name: str
    system: System
    start: float | None
    stop: float | None
    steps: StepSizes
