"""Variables as a version of SSP can name them: types of FMI 3, and arrays instead of elements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, NamedTuple

from seatrial.fmi.components.source import find_source
from seatrial.fmi.instance import Variable
from seatrial.fmi.loading.load import load_fmu
from seatrial.system.part import Part
from seatrial.system.system import System

from .model import Indices
from .parameters import Value, type_name

Version = Literal["1.0", "2.0"]
_INT = range(-(2**31), 2**31)
"""Values that SSP has for items of an enumeration."""


class Enumeration(NamedTuple):
    """A type of FMI."""

    name: str
    items: Mapping[str, int]


@dataclass(frozen=True)
class Shapes:
    """Types and arrays of a component's variables; empty where the version knows neither."""

    types: Mapping[str, str] = field(default_factory=dict)
    """SSP's type by variable."""
    enumerations: Mapping[str, Enumeration] = field(default_factory=dict)
    """By variable."""
    locals: frozenset[str] = frozenset()
    """Outputs in this rig that are local variables of the FMU."""
    unsaid: frozenset[str] = frozenset()
    """The same, in a version that knows none."""
    arrays: Mapping[str, tuple[str, Indices | None]] = field(default_factory=dict)
    """By element: its array, and its indices there; in version 1 its name by indices alone."""
    sizes: Mapping[str, Indices] = field(default_factory=dict)
    """By array."""

    def connector(self, variable: str) -> tuple[str, Indices | None]:
        """Return the connector of a variable, and which element of it that is."""
        return self.arrays.get(variable, (variable, None))

    def type(self, variable: Variable) -> str:
        """Return SSP's type of a variable."""
        return self.types.get(variable.name) or type_name(variable.type)

    def kind(self, variable: Variable) -> str:
        """Return the kind of a variable's connector."""
        return "local" if variable.name in self.locals else variable.causality

    def written(self, variable: Variable, values: Sequence[Value]) -> tuple[str, Sequence[Value]]:
        """Return SSP's type and values of a variable, or of an array with such elements.

        Of an enumeration they are names of items; as numbers if there is a value without one.
        """
        if variable.name not in self.enumerations:
            return self.type(variable), values
        names = {number: name for name, number in self.enumerations[variable.name].items.items()}
        if not names.keys() >= {*values}:
            return "Int64", values
        return "Enumeration", [names[int(value)] for value in values]


def local_outputs(system: System, part: Part) -> frozenset[str]:
    """Return the outputs of a component that are local variables of its FMU."""
    named = system.rig.components[part.name].entry.locals
    bases = {*named, *(name.rpartition("[")[0] for name in named)} - {""}
    return frozenset(
        name
        for name, variable in part.instance.variables.items()
        if variable.causality == "output" and not bases.isdisjoint({name, name.rpartition("[")[0]})
    )


def shapes_of(system: System, part: Part, version: Version) -> Shapes:
    """Return what ``version`` can say of a component: version 2 all, of FMUs of FMI 3."""
    source = find_source(part.fmu, system.rig.components[part.name].scope.folder)
    shown = local_outputs(system, part)
    if version == "1.0" or not isinstance(source, Path):
        variables = part.instance.variables.values()
        named = {v.name: (v.indexed, None) for v in variables if v.array}
        return Shapes(unsaid=shown, arrays=named)
    fmu = load_fmu(source)
    if fmu.description.fmiMajorVersion != 3:
        return Shapes(locals=shown)
    types: dict[str, str] = {}
    enumerations: dict[str, Enumeration] = {}
    declared = {
        tuple((item.name, int(item.value)) for item in one.items): one.name
        for one in fmu.description.typeDefinitions
    }
    arrays: dict[str, tuple[str, Indices | None]] = {}
    sizes: dict[str, Indices] = {}
    for name, variable in part.instance.variables.items():
        if variable.is_made:
            continue
        types[name] = fmu.arrays[variable.reference].fmi_type
        if types[name] == "Enumeration":
            called = declared.get(tuple(variable.items.items()))
            if called and all(number in _INT for number in variable.items.values()):
                enumerations[name] = Enumeration(called, variable.items)
            else:
                types[name] = "Int64"
        indexed = variable.indexed
        if "[" in indexed and indexed.endswith("]"):
            base, _, indices = indexed[:-1].rpartition("[")
            sizes[base] = tuple(map(int, indices.split(",")))  # in the end, of the last element
            arrays[name] = (base, sizes[base])
    return Shapes(types, enumerations, shown, frozenset(), arrays, sizes)
