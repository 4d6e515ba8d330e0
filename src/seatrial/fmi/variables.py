"""The variables of a model description as scalars: arrays by element, types, units, limits."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from fmpy.model_description import ModelDescription

from ..errors import InputError
from ..ports import VIEWS
from ..units import Unit, defined_unit
from .instance import Value, Variable, Variables

INTEGERS = {
    f"{sign}Int{bits}": (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for bits in (8, 16, 32, 64)
    for sign in ("", "U")
}
"""Least and greatest value of FMI 3's types of integers."""

_TYPES = {
    **dict.fromkeys(("Real", "Float32", "Float64"), float),
    **dict.fromkeys(("Integer", "Enumeration", *INTEGERS), int),
    "Boolean": bool,
    "String": str,
    "Binary": bytes,
}
_TRUTH = {"true": True, "1": True, "false": False, "0": False}
_MOST_SCALARS = 1_000_000
_LARGEST_REFERENCE = 2**32 - 1


@dataclass(frozen=True)
class Array:
    """What one value reference of FMI 3 stands for; a scalar is an array of one element."""

    fmi_type: str
    elements: tuple[Variable, ...]

    @property
    def start(self) -> list[Any] | None:
        """The start values of all elements; None if the FMU gives none."""
        values = [variable.start for variable in self.elements]
        return None if None in values else values


@dataclass(frozen=True)
class Described:
    """All signals of a model description."""

    variables: Variables
    arrays: dict[int, Array]
    """By value reference; in FMI 2.0 equal references of two types are two variables."""
    feedthrough: dict[str, Sequence[str]]
    notes: tuple[str, ...]
    """What this FMU has that cannot be used here."""


def described(
    description: ModelDescription, root: Any, structure: Mapping[str, int] | None = None
) -> Described:
    """Return the signals of ``description``, read from the XML element ``root``.

    ``structure`` has structural parameters that are to differ from their start values. Raises
    InputError, without the file's name, for a variable that cannot be used.
    """
    ambiguous = _ambiguous_names(description)
    reading = _Reading(description, root, structure or {})
    variables, clocked = Variables(), []
    arrays: dict[int, Array] = {}
    by_name: dict[str, list[str]] = {}
    for v in description.modelVariables:
        if v.name in ambiguous:
            continue
        if v.type == "Clock" or v.clocks:
            clocked.append(v.name)
            continue
        try:
            scalars = reading.scalars(v)
        except (InputError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"variable {v.name!r} (line {v.sourceline}): {error}") from None
        for scalar in scalars:
            if scalar.name in variables:
                raise InputError(f"two variables are called {scalar.name!r}")
            variables[scalar.name] = scalar
        if len(variables) > _MOST_SCALARS:
            raise InputError(f"more than {_MOST_SCALARS} scalar variables")
        arrays.setdefault(v.valueReference, Array(v.type, tuple(scalars)))
        by_name[v.name] = [scalar.name for scalar in scalars]
    feedthrough = _feedthrough(description, root, by_name)
    return Described(variables, arrays, feedthrough, _notes(clocked, ambiguous))


class _Reading:
    """What has to be known of a whole model description to read one of its variables."""

    def __init__(
        self, description: ModelDescription, root: Any, structure: Mapping[str, int]
    ) -> None:
        self._structure = structure
        self._elements = {e.get("name"): e for e in root.find("ModelVariables")}
        self._units = {u.name: u.baseUnit for u in description.unitDefinitions}
        self._definitions: dict[str, Unit | None] = {"": None}
        enumeration = "Int64" if description.fmiMajorVersion == 3 else "Int32"
        self._integers = {**INTEGERS, "Enumeration": INTEGERS[enumeration]}

    def scalars(self, v: Any) -> list[Variable]:
        """Return a variable's elements, or itself if it is a scalar."""
        if not v.name:
            raise InputError("it has no name")
        if not 0 <= v.valueReference <= _LARGEST_REFERENCE:
            raise InputError(f"value reference {v.valueReference} is not from 0 to 2^32 - 1")
        element = self._elements[(v.alias or v).name]
        if element.tag == "ScalarVariable" and element.find(v.type) is None:
            raise InputError("it has no type")  # FMPy takes that of the one before
        kind, declared, names = _TYPES[v.type], v.declaredType, self._element_names(v)
        inherited = {a: getattr(v, a) or getattr(declared, a, None) for a in _INHERITED}
        limits = {a: _number(inherited[a]) if kind in (int, float) else None for a in _LIMITS}
        unit = (inherited["unit"] or "") if kind is float else ""
        port = element.find("Annotations/Tool[@name='seatrial']/port")
        said = {} if port is None else port.attrib
        starts = self._starts(v, element, len(names))
        return [
            Variable(
                name=name,
                causality=v.causality,
                variability=_variability(v.variability, kind),
                type=kind,
                reference=v.valueReference,
                unit=unit,
                start=starts[place],
                minimum=limits["min"],
                maximum=limits["max"],
                nominal=limits["nominal"],
                description=v.description or "",
                definition=self._definition(unit),
                integers=self._integers.get(v.type, INTEGERS["Int32"]),
                items={item.name: int(item.value) for item in getattr(declared, "items", ())},
                element=place,
                negated=element.get("alias") == "negatedAlias",
                optional=said.get("optional") == "true",
                frame=said.get("frame", ""),
                term_of=said.get("term_of", ""),
                role=said.get("role", ""),
            )
            for place, name in enumerate(names)
        ]

    def _shape(self, v: Any) -> tuple[int, ...]:
        """Return an array's sizes, as the structural parameters have them."""
        return tuple(
            size if d.variable is None else self._structure.get(d.variable.name, size)
            for size, d in zip(v.shape, v.dimensions, strict=True)
        )

    def _element_names(self, v: Any) -> list[str]:
        if not v.dimensions:
            return [v.name]
        shape = self._shape(v)
        if min(shape) < 0 or math.prod(shape) > _MOST_SCALARS:
            raise InputError(f"an array of {' by '.join(map(str, shape))}")
        indices = product(*(range(1, size + 1) for size in shape))
        return [f"{v.name}[{','.join(map(str, index))}]" for index in indices]

    def _starts(self, v: Any, element: Any, count: int) -> Sequence[Value | None]:
        """Return one start value per element; one that is given alone holds for all."""
        kind = _TYPES[v.type]
        if v.name in self._structure:
            return [self._structure[v.name]]
        if element.tag in ("String", "Binary"):  # FMI 3; FMPy knows the first one only
            texts = [start.get("value") for start in element.findall("Start")]
        elif v.start is None or kind is str or not v.dimensions:
            texts = [] if v.start is None else [v.start]
        else:
            texts = v.start.split()
        if v.dimensions and self._shape(v) != v.shape and len(texts) > 1:
            return [None] * count  # the description has those of its own size
        if len(texts) not in (0, 1, count):
            raise InputError(f"{len(texts)} start values for {count} elements")
        values: list[Value | None] = [_parsed(text, kind) for text in texts]
        return values if len(values) == count else (values or [None]) * count

    def _definition(self, name: str) -> Unit | None:
        """Return a unit's definition where its name alone does not say the same."""
        if name not in self._definitions:
            base, unit = self._units.get(name), None
            if base is not None:
                powers = {n: getattr(base, n) for n in _BASE_UNITS}
                unit = defined_unit(name, powers, base.factor, base.offset)
            self._definitions[name] = None if unit is None or unit.by_name else unit
        return self._definitions[name]


_BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_LIMITS = ("min", "max", "nominal")
_INHERITED = ("unit", *_LIMITS)
"""What a variable has from its declared type if it does not say it itself."""


def _variability(written: str | None, kind: type) -> str:
    if kind is not float and written in (None, "continuous"):  # FMI 2.0's default is for Real
        return "discrete"
    return written or "continuous"


def _number(text: str | None) -> float | None:
    return None if text is None else float(text)


def _parsed(text: str, kind: type) -> Value:
    if kind is bool:
        if text not in _TRUTH:
            raise InputError(f"start value {text!r} is not true or false")
        return _TRUTH[text]
    if kind is bytes:
        return bytes.fromhex(text)
    return kind(text)  # type: ignore[no-any-return]


def _feedthrough(
    description: ModelDescription, root: Any, by_name: dict[str, list[str]]
) -> dict[str, Sequence[str]]:
    """Return the inputs each output depends on; on all, where the FMU says nothing."""
    inputs = [v for v in description.modelVariables if v.causality == "input"]
    all_inputs = [name for v in inputs for name in by_name.get(v.name, ())]
    said = {unknown.variable.name: unknown.dependencies for unknown in description.outputs}
    if description.fmiMajorVersion == 1:
        said = _direct_dependencies(description, root)
    result: dict[str, Sequence[str]] = {}
    for v in description.modelVariables:
        if v.causality != "output":
            continue
        dependencies = said.get((v.alias or v).name)
        names = all_inputs
        if dependencies is not None:
            known = [d for d in dependencies if d.causality == "input"]
            names = [name for d in known for name in by_name.get(d.name, ())]
        if names:
            result.update(dict.fromkeys(by_name.get(v.name, ()), names))
    return result


def _direct_dependencies(description: ModelDescription, root: Any) -> dict[str, list[Any]]:
    """Return what an FMI 1.0 description says, which FMPy leaves out."""
    variables = {v.name: v for v in description.modelVariables}
    return {
        element.get("name"): [
            variables[name.text] for name in through.iterfind("Name") if name.text in variables
        ]
        for element in root.find("ModelVariables")
        if (through := element.find("DirectDependency")) is not None
    }


def _ambiguous_names(description: ModelDescription) -> list[str]:
    """Return names of several local variables each: FMI forbids them, tools write them.

    Raises InputError for a name that a signal or a parameter shares.
    """
    counts = Counter(v.name for v in description.modelVariables)
    for v in description.modelVariables:
        if counts[v.name] > 1 and v.causality != "local":
            raise InputError(f"two variables are called {v.name!r}")
    return [name for name, count in counts.items() if count > 1]


def _notes(clocked: list[str], ambiguous: list[str]) -> tuple[str, ...]:
    notes = []
    if clocked:
        notes.append(
            f"clocks, and variables that belong to one, are no signals here: {_shown(clocked)}"
        )
    if ambiguous:
        notes.append(
            "local variables that share a name with another are left out: " + _shown(ambiguous)
        )
    return tuple(notes)


def _shown(names: list[str]) -> str:
    return ", ".join(names[:10]) + (", ..." if len(names) > 10 else "")


def views_of(root: Any) -> dict[str, dict[str, str]]:
    """Return the views that a model description declares, without those unknown here."""
    found = {}
    for element in root.iterfind("VendorAnnotations/Tool[@name='seatrial']/view"):
        ports = {str(key): str(value) for key, value in element.attrib.items()}
        kind = ports.pop("kind", "")
        if set(ports) == set(VIEWS.get(kind, ())):
            found[kind] = ports
    return found
