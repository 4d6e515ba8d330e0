"""FMUs of a structure: their variables as connectors, and the values that they start from."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from seatrial.errors import InputError
from seatrial.fmi.instance import Variable
from seatrial.fmi.interfaces.loaded import LoadedFmu
from seatrial.fmi.loading.load import load_fmu
from seatrial.system.system import is_settable

from .definitions import converted
from .graph import Path_
from .model import Component, Connector, Indices
from .notes import Notes
from .parameters import Item, Parameter, Value

_OPEN_KINDS = ("inout", "unspecified", "constant")
_INDICES = re.compile(r"\[(\d+(?:,\d+)*)\]")


@dataclass
class Leaf:
    """One FMU of the flat system."""

    path: Path_
    fmu: LoadedFmu
    isolated: bool
    """It runs in a process of its own."""
    step: float | None
    where: str
    values: dict[str, tuple[Value, str]] = field(default_factory=dict)
    """Start values by variable, in its own unit, and where they are written."""
    locals: dict[str, None] = field(default_factory=dict)
    """Local variables that have a connector, or a connection."""

    @cached_property
    def structural(self) -> set[str]:
        """Names of the structural parameters."""
        if self.fmu.version < 3:
            return set()
        variables = self.fmu.variables.values()
        return {one.name for one in variables if one.causality == "structuralParameter"}

    def scalars(self, name: str) -> dict[Indices, str]:
        """Return the variables of a connector: one, or those of an array by their indices."""
        variables = self.fmu.variables
        if name in variables:
            return {(): name}
        for variable in variables.ports.get(name.partition("[")[0], ()):
            if variable.indexed == name:
                return {(): variable.name}
        found: dict[Indices, str] = {}
        for variable in variables.ports.get(name, ()):
            indices = _INDICES.fullmatch(variable.indexed, len(name))
            if indices is None:
                return {}
            found[tuple(map(int, indices[1].split(",")))] = variable.name
        return found

    def resize(self, structure: Mapping[str, Value]) -> None:
        """Give structural parameters values. Raises InputError for sizes that cannot be."""
        sizes = {name: int(value) for name, value in structure.items()}
        try:
            self.fmu = load_fmu(self.fmu.path, replace(self.fmu.options, structure=sizes))
        except InputError as error:
            raise InputError(f"{self.where}: {error}") from None

    def bind(self, connector: str, parameter: Parameter, notes: Notes) -> None:
        """Give the variables of a connector the values of a parameter. Raises InputError."""
        names = list(self.scalars(connector).values())
        if len(names) != len(parameter.values):
            raise InputError(
                f"{parameter.where}: {parameter.name} has {len(parameter.values)} values, "
                f"{len(names)} are needed"
            )
        for name, value in zip(names, parameter.values, strict=True):
            self.start(name, self._resolved(parameter, value, name), parameter.where, notes)

    def start(self, name: str, value: Value, place: str, notes: Notes) -> None:
        """Let a variable start from a value in its own unit. Raises InputError."""
        variable = self.fmu.variables[name]
        if not is_settable(variable) and variable.causality != "structuralParameter":
            notes.pass_over(
                place.rpartition(": line")[0],
                f"values of variables that are calculated are not used: {'.'.join(self.path)}."
                f"{name} is {variable.causality}",
            )
            return
        self.values[name] = (fitting(value, variable, f"{place}: {name}"), place)

    def _resolved(self, parameter: Parameter, value: Value | Item, name: str) -> Value:
        variable = self.fmu.variables[name]
        place = f"{parameter.where}: {name}"
        plain = numbered(value, variable.items, place) if isinstance(value, Item) else value
        if variable.type is float:
            plain = fitting(plain, variable, place)
        if isinstance(plain, float):
            unit = parameter.unit if parameter.converts else None
            if unit is not None and variable.unit:
                factor, offset = converted(unit, variable.measure, parameter.where)
                if (factor, offset) != (1.0, 0.0):
                    plain = factor * plain + offset
            if (parameter.factor, parameter.offset) != (1.0, 0.0):
                plain = parameter.factor * plain + parameter.offset
        return plain


class SizesOnly(Leaf):
    """The same FMU, which takes values of structural parameters and passes over all others."""

    @classmethod
    def of(cls, leaf: Leaf) -> SizesOnly:
        """Return one without values."""
        return cls(leaf.path, leaf.fmu, leaf.isolated, leaf.step, leaf.where)

    def bind(self, connector: str, parameter: Parameter, notes: Notes) -> None:
        """Give a structural parameter its value. Raises InputError."""
        if connector in self.structural:
            super().bind(connector, parameter, notes)


def fitting(value: Value, variable: Variable, place: str) -> Value:
    """Return a value as one of the variable's type. Raises InputError if it is none."""
    if type(value) is int and variable.type is float:
        try:
            return float(value)
        except OverflowError:
            raise InputError(f"{place}: beyond the range of doubles") from None
    if type(value) is not variable.type:
        raise InputError(
            f"{place} is of type {type(value).__name__}, "
            f"its variable is of type {variable.type.__name__}"
        )
    return value


def numbered(item: Item, items: Mapping[str, int], place: str) -> int:
    """Return the number of an item: as the variable, else as the file says. Raises InputError."""
    number = items.get(item.name, item.number)
    if number is None:
        raise InputError(
            f"{place}: item {item.name!r} is of no enumeration that the file or the FMU defines"
        )
    return number


def connectors_of(leaf: Leaf, component: Component, notes: Notes) -> dict[str, Connector]:
    """Return the connectors of an FMU, kinds and items as the FMU has them.

    One in another unit than the FMU's variable has this as its problem.
    """
    found = {}
    for name, connector in component.connectors.items():
        scalars = leaf.scalars(name)
        if not scalars:
            notes.pass_over(connector.where, f"connector {name!r} is no variable of the FMU")
            continue
        variable = leaf.fmu.variables[next(iter(scalars.values()))]
        if variable.causality == "local":
            leaf.locals.update(dict.fromkeys(scalars.values()))
        if connector.type not in (None, variable.type):
            notes.pass_over(
                connector.where,
                f"connector {name!r} is not of the type of the FMU's variable, "
                f"{variable.type.__name__}, which holds",
            )
        if connector.kind not in (variable.causality, *_OPEN_KINDS):
            notes.pass_over(
                connector.where,
                f"connector {name!r} is not of the kind of the FMU's variable, "
                f"{variable.causality}, which holds",
            )
        sizes = [size for size in connector.sizes if size is not None]
        if len(sizes) == len(connector.sizes) > 0 and math.prod(sizes) != len(scalars):
            notes.pass_over(
                connector.where,
                f"connector {name!r} has other dimensions than the FMU's variable, which hold",
            )
        problem = _other_unit(variable, connector)
        if problem:
            notes.pass_over(connector.where, problem)
        found[name] = replace(as_variable(connector, variable), problem=problem)
    return found


def as_variable(connector: Connector, variable: Variable) -> Connector:
    """Return a connector with what its variable says better."""
    unit = variable.measure if variable.type is float and variable.unit else connector.unit
    items = variable.items or connector.items
    return replace(connector, kind=variable.causality, type=variable.type, unit=unit, items=items)


def _other_unit(variable: Variable, connector: Connector) -> str:
    """Return why a connector cannot be connected, if it is in another unit than its variable."""
    if variable.type is not float or not variable.unit or connector.unit is None:
        return ""
    text = f"connector {connector.name!r} is in another unit than the FMU's variable, which is in"
    try:
        same = converted(connector.unit, variable.measure, connector.where) == (1.0, 0.0)
    except InputError:
        same = False
    return "" if same else f"{text} {variable.unit}"
