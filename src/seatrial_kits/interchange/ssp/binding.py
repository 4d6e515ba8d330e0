"""Values for connectors of systems, which reach the variables that these lead to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Protocol

from seatrial.errors import InputError

from .definitions import Measure, converted
from .graph import Graph, Node, Origin, Path_
from .leaf import Leaf, numbered
from .notes import Notes
from .parameters import Item, Parameter, Value
from .transformations import Way

_SHOWN = 10


class Structured(Protocol):
    """Systems, FMUs and connectors, to which values are bound."""

    notes: Notes
    leaves: dict[Path_, Leaf]
    elements: dict[Path_, list[str]]
    graph: Graph


@dataclass
class Bound:
    """Parameters bound to connectors of systems, the last of each."""

    _parameters: dict[Node, Parameter] = field(default_factory=dict)
    _used: set[Node] = field(default_factory=set)

    def bind(self, parameters: Iterable[Parameter], path: Path_, flat: Structured) -> None:
        """Give values to what is below ``path``; they win over those given before.

        Raises InputError for a value that does not fit.
        """
        missing: dict[str, list[str]] = {}
        for parameter in parameters:
            if not self._give(parameter, parameter.name, path, flat):
                file = parameter.where.rpartition(": line")[0]
                missing.setdefault(file, []).append(parameter.name)
        for file, names in missing.items():
            shown = ", ".join(map(repr, names[:_SHOWN]))
            more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
            fit = "fits" if len(names) == 1 else "fit"
            flat.notes.add(f"{file}: {shown}{more} {fit} no variable; SSP has it ignored")

    def _give(self, parameter: Parameter, name: str, path: Path_, flat: Structured) -> bool:
        """Give a value to all that has the hierarchical name ``name``, seen from ``path``."""
        if path in flat.leaves:
            leaf = flat.leaves[path]
            if not leaf.scalars(name):
                return False
            leaf.bind(name, parameter, flat.notes)
            return True
        found = False
        if (path, name) in flat.graph.connectors:
            self._parameters[path, name] = parameter
            found = True
        for element in flat.elements[path]:
            if name.startswith(f"{element}."):
                rest = name.removeprefix(f"{element}.")
                found |= self._give(parameter, rest, (*path, element), flat)
        return found

    def carry(self, origin: Origin, leaf: Leaf, variable: str, flat: Structured) -> None:
        """Let a variable start from the value of the connector that it is connected to.

        Raises InputError for a value that does not fit.
        """
        parameter = self._parameters.get(origin.node)
        if parameter is None:
            shown = ".".join((*origin.node[0], origin.node[1])).replace("\0", "")
            flat.notes.add(f"connector {shown} of the system: nothing feeds it")
            return
        self._used.add(origin.node)
        value = _element(parameter, origin, leaf, flat.graph.connectors[origin.node].sizes)
        if isinstance(value, Item):
            items = flat.graph.connectors[origin.node].items or leaf.fmu.variables[variable].items
            value = numbered(value, items, f"{parameter.where}: {parameter.name}")
        begin, unit = _begin(parameter, flat.graph.connectors[origin.node].unit)
        way = flat.graph.way(origin, begin, unit)
        if type(value) is int and way.is_linear:
            value = float(value)
        leaf.start(variable, _through(way, value, parameter), parameter.where, flat.notes)

    def note_unused(self, graph: Graph, notes: Notes) -> None:
        """Note the values that no variable has got."""
        for (path, name), parameter in self._parameters.items():
            if (path, name) not in self._used:
                fed = graph.is_fed((path, name))
                why = "is fed by a connection" if fed else "leads to no variable"
                notes.add(
                    f"{parameter.where}: connector {'.'.join((*path, name))} {why}; "
                    "its start value is not used"
                )


def _begin(parameter: Parameter, unit: Measure | None) -> tuple[Way, Measure | None]:
    """Return what becomes of a value at its connector, in ``unit``, and its unit from there."""
    own = parameter.unit if parameter.converts else None
    way = Way()
    if own is not None and unit is not None:
        way = way.then(*converted(own, unit, parameter.where))
    return way.then(parameter.factor, parameter.offset), unit or own


def _through(way: Way, value: Value, parameter: Parameter) -> Value:
    if way.is_linear and type(value) is not float:
        raise InputError(
            f"{parameter.where}: {parameter.name}: a real number is needed to transform, "
            f"found {value!r}"
        )
    result: Value = way(value)
    return result


def _element(
    parameter: Parameter, origin: Origin, leaf: Leaf, sizes: tuple[int | None, ...]
) -> Value | Item:
    """Return the value for an element of a connector, row by row. Raises InputError."""
    known = [size for size in sizes if size is not None]
    place, count = 0, 1
    if origin.indices and len(known) == len(sizes) == len(origin.indices):
        for index, size in zip(origin.indices, known, strict=True):
            place, count = place * size + index - 1, count * size
    elif origin.indices:
        elements = list(leaf.scalars(origin.steps[-1][0][1]))
        place, count = elements.index(origin.indices), len(elements)
    if len(parameter.values) != count or not 0 <= place < count:
        raise InputError(
            f"{parameter.where}: {parameter.name} has {len(parameter.values)} values, "
            f"{count} are needed"
        )
    return parameter.values[place]
