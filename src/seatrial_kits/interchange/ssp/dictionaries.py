"""Signal dictionaries in a flat structure: signals that any of their references may give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from seatrial.errors import InputError, unknown

from .graph import Graph, Node, Path_
from .model import Dictionary, Reference


@dataclass
class Dictionaries:
    """The dictionaries of all systems, and what refers to their signals."""

    _places: dict[Path_, Mapping[str, Dictionary]] = field(default_factory=dict)
    """By the system that has them."""
    _references: dict[Node, list[tuple[Node, str]]] = field(default_factory=dict)
    """Connectors of references, and where those are, by signal."""

    def add(self, dictionaries: Mapping[str, Dictionary], path: Path_, graph: Graph) -> None:
        """Add the dictionaries of the system at ``path``."""
        self._places[path] = dictionaries
        for name, dictionary in dictionaries.items():
            for signal, connector in dictionary.signals.items():
                graph.connectors[_place(path, name), signal] = connector

    def refer(self, reference: Reference, path: Path_, graph: Graph) -> None:
        """Add a reference at ``path``. Raises InputError for what its dictionary does not have."""
        around = path[:-1]
        while reference.dictionary not in self._places.get(around, {}):
            if not around:
                known = {name for each in self._places.values() for name in each}
                message = unknown("signal dictionary", reference.dictionary, known)
                raise InputError(f"{reference.where}: {message}")
            around = around[:-1]
        signals = self._places[around][reference.dictionary].signals
        for name, connector in reference.connectors.items():
            if name not in signals:
                raise InputError(f"{connector.where}: {unknown('signal', name, signals)}")
            items = connector.items or signals[name].items
            graph.connectors[path, name] = replace(connector, items=items)
            signal = (_place(around, reference.dictionary), name)
            self._references.setdefault(signal, []).append(((path, name), connector.where))

    def connect(self, graph: Graph) -> None:
        """Let the references of each signal have what one of them is given.

        Raises InputError for a signal that two are given.
        """
        for signal, references in self._references.items():
            given = [(node, place) for node, place in references if graph.is_fed(node)]
            if len(given) > 1:
                raise InputError(
                    f"{given[1][1]}: the signal {signal[1]!r} of the dictionary "
                    f"{signal[0][-1][1:]!r} is given twice, first at {given[0][1]}"
                )
            if not given:
                continue
            graph.pass_on(given[0][0], signal, given[0][1])
            for node, place in references:
                if node != given[0][0]:
                    graph.pass_on(signal, node, place)


def _place(path: Path_, name: str) -> Path_:
    return (*path, f"\0{name}")  # no element of an XML file is called so
