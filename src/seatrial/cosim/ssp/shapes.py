"""Variables as a version of SSP can name them: types of FMI 3, and arrays instead of elements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ...fmi.instance import Variable
from ...fmi.load import load_fmu
from ...fmi.source import find_source
from ..part import Part
from ..system import System
from .model import Indices
from .parameters import type_name

Version = Literal["1.0", "2.0"]


@dataclass(frozen=True)
class Shapes:
    """Types and arrays of a component's variables; empty where the version knows neither."""

    types: Mapping[str, str] = field(default_factory=dict)
    """SSP's type by variable."""
    arrays: Mapping[str, tuple[str, Indices]] = field(default_factory=dict)
    """By element: its array, and its indices there."""
    sizes: Mapping[str, Indices] = field(default_factory=dict)
    """By array."""

    def connector(self, variable: str) -> tuple[str, Indices | None]:
        """Return the connector of a variable, and which element of it that is."""
        return self.arrays.get(variable, (variable, None))

    def type(self, variable: Variable) -> str:
        """Return SSP's type of a variable."""
        return self.types.get(variable.name) or type_name(variable.type)


def shapes_of(system: System, part: Part, version: Version) -> Shapes:
    """Return what ``version`` can say of a component: version 2 all, of FMUs of FMI 3."""
    source = find_source(part.fmu, system.rig.components[part.name].scope.folder)
    if version == "1.0" or not isinstance(source, Path):
        return Shapes()
    fmu = load_fmu(source)
    if fmu.description.fmiMajorVersion != 3:
        return Shapes()
    types: dict[str, str] = {}
    arrays: dict[str, tuple[str, Indices]] = {}
    sizes: dict[str, Indices] = {}
    for name, variable in fmu.variables.items():
        # An enumeration would need its definition in every file; its values are Int64.
        types[name] = "Int64" if variable.items else fmu.arrays[variable.reference].fmi_type
        if "[" in name and name.endswith("]"):
            base, _, indices = name[:-1].rpartition("[")
            arrays[name] = (base, tuple(map(int, indices.split(","))))
            sizes[base] = arrays[name][1]  # in the end, of the last element
    return Shapes(types, arrays, sizes)
