"""A component's place in the network: where its outputs stand, and what its inputs take."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..fmi.instance import Reader, Writer
from ..system.part import Part
from ..system.system import Connection
from .injected import Injected
from .timing import StepTimes


@dataclass
class Chunk:
    """Outputs of one type of one component, side by side in the network's signals."""

    start: int
    stop: int
    read: Reader
    is_real: bool
    limits: list[tuple[int, float]] = field(default_factory=list)
    """Connected outputs with a nominal value: place within the chunk, largest magnitude."""


@dataclass
class Writes:
    """Connected inputs of one type of one component."""

    connections: list[Connection]
    places: list[int]
    """Where each input's value stands."""
    write: Writer
    continuous: list[int]
    """Inputs that change continuously between two communication points."""
    gather: Callable[[list[Any]], Sequence[Any]]
    scales: list[tuple[int, float, float]]
    now: Callable[[], int]
    """The network's time, ns."""
    mappings: list[tuple[int, Mapping[Any, Any]]] = field(default_factory=list)
    injected: dict[int, Injected] = field(default_factory=dict)
    """Faults of an input, once converted."""

    def values(self, signals: list[Any]) -> Sequence[Any]:
        """Return the inputs' values, converted."""
        values = self.gather(signals)
        if self.mappings:
            values = list(values)
            for i, mapping in self.mappings:
                values[i] = mapping.get(values[i], values[i])
        if self.scales:
            values = list(values)
            for i, factor, offset in self.scales:
                values[i] = values[i] * factor + offset
        if self.injected:
            values, t_ns = list(values), self.now()
            for i, faults in self.injected.items():
                values[i] = faults.value(t_ns, values[i])
        return values


@dataclass
class Node:
    """One component in the network."""

    part: Part
    chunks: list[Chunk] = field(default_factory=list)
    """All outputs."""
    reads: list[Chunk] = field(default_factory=list)
    """Outputs to read after a step: those that no feed-through visit reads anyway."""
    independent: list[Chunk] = field(default_factory=list)
    """Outputs that follow from the state alone."""
    writes: list[Writes] = field(default_factory=list)
    written_by_visit: bool = False
    """Its last feed-through visit leaves every input as a step with held inputs needs it."""
    times: StepTimes = field(default_factory=StepTimes)
    every: int = 1
    """It steps once in so many communication steps."""

    @property
    def fed_by(self) -> set[str]:
        """The components that feed it."""
        return {one.source[0] for writes in self.writes for one in writes.connections}
