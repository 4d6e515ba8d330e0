"""XML elements of variables as scalars: types, limits, units, start values, arrays by element."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from sys import intern
from typing import Any

from fmpy.model_description import ModelDescription

from ...errors import InputError, unknown
from ...links.text import unpacked
from ...model.ports import BYTES
from ...model.units import Unit, defined_unit
from ..clocks import Clock, clock_types, read_clock
from ..instance import Value, Variable
from .terminals import TOOL

INTEGERS = {
    f"{sign}Int{bits}": (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for bits in (8, 16, 32, 64)
    for sign in ("", "U")
}
"""Least and greatest value of FMI 3's types of integers."""

MOST_SCALARS = 1_000_000
_TYPES: dict[str, type] = {
    **dict.fromkeys(("Real", "Float32", "Float64"), float),
    **dict.fromkeys(("Integer", "Enumeration", *INTEGERS), int),
    **dict.fromkeys(("Boolean", "Clock"), bool),
    "String": str,
    "Binary": bytes,
}
_NESTED = ("Real", "Integer", "Boolean", "String", "Enumeration")
_TRUTH = {"true": True, "1": True, "false": False, "0": False}
_LARGEST_REFERENCE = 2**32 - 1
_BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_PARAMETERS = ("structuralParameter", "parameter", "calculatedParameter")
_ALLOWED = {
    "constant": ("output", "local"),
    "fixed": (*_PARAMETERS, "local"),
    "tunable": (*_PARAMETERS, "local"),
    "discrete": ("input", "output", "local"),
    "continuous": ("input", "output", "local", "independent"),
}
"""Causalities that FMI allows for each variability."""
_CAUSALITIES = {causality for allowed in _ALLOWED.values() for causality in allowed}


@dataclass(slots=True)
class Entry:
    """A variable of a description that is an array, a clock, or belongs to clocks."""

    like: Variable
    """What all elements have in common."""
    fmi_type: str
    clock: Mapping[str, str] | None
    """What its element and its type say, if it is a clock."""
    clocks: tuple[int, ...]
    """Value references of those that it belongs to."""
    dimensions: Sequence[tuple[int | None, int | None]]
    """A size each, or the value reference of the structural parameter that has it."""
    texts: Sequence[str]
    """Start values as written."""
    axes: tuple[str, ...]
    """Names of the elements of an array of ours: then it is ``x.north``, not ``x[1]``."""
    line: int
    elements: list[Variable] = field(default_factory=list)

    @property
    def name(self) -> str:
        """As the description has it."""
        return self.like.name

    @property
    def causality(self) -> str:
        """As the description has it."""
        return self.like.causality


class ScalarReader:
    """Reads the variables of one model description, each from its XML element."""

    def __init__(self, header: ModelDescription, root: Any) -> None:
        self.version = int(header.fmiMajorVersion)
        self._clock_types = clock_types(root)
        self._types = {one.name: one for one in header.typeDefinitions}
        self._items = {
            one.name: {item.name: int(item.value) for item in one.items}
            for one in header.typeDefinitions
        }
        self._units = {u.name: u.baseUnit for u in header.unitDefinitions}
        self._definitions: dict[str, Unit | None] = {"": None}
        enumeration = "Int64" if self.version == 3 else "Int32"
        self._integers = {**INTEGERS, "Enumeration": INTEGERS[enumeration]}
        self.unusual: list[str] = []
        """Variables with a causality and a variability that FMI does not allow together."""

    def read(self, element: Any) -> tuple[Variable | Entry, str]:
        """Return a scalar, or what is to be made into scalars; and its type of FMI.

        Raises InputError, naming the variable and its line.
        """
        try:
            return self._read(element)
        except (InputError, ValueError, KeyError, TypeError) as error:
            raise _named(element.get("name"), element.sourceline, error) from None

    def _read(self, element: Any) -> tuple[Variable | Entry, str]:
        name, reference = element.get("name"), _whole(element, "valueReference")
        if not name:
            raise InputError("it has no name")
        if reference is None:
            raise InputError("it has no valueReference")
        if not 0 <= reference <= _LARGEST_REFERENCE:
            raise InputError(f"value reference {reference} is not from 0 to 2^32 - 1")
        value, annotations, dimensions = element, None, []
        for child in element:
            if child.tag == "Annotations":
                annotations = child
            elif child.tag == "Dimension":
                dimensions.append(child)
            elif self.version < 3 and child.tag in _NESTED and value is element:
                value = child
        if self.version < 3 and value is element:
            raise InputError("it has no type")
        fmi_type = intern(value.tag)
        kind = _TYPES[fmi_type]
        causality, variability = self._varying(element, name, fmi_type)
        declared = value.get("declaredType")
        types = self._clock_types if fmi_type == "Clock" else self._types
        if declared is not None and declared not in types:
            raise InputError(f"its declared type {declared!r} is not defined")
        said = self._inherited(value, self._types.get(declared), kind)
        ours = _ours(annotations)
        if fmi_type == "Binary" and ours.get("role") in BYTES:
            kind = str  # as our components have it
        texts = _starts(element, value, kind, bool(dimensions))
        if fmi_type == "Binary" and kind is str:
            texts = [unpacked(bytes.fromhex(start)) for start in texts]
        clocks = tuple(int(one) for one in element.get("clocks", "").split())
        variable = Variable(
            name=name,
            causality=causality,
            variability=variability,
            type=kind,
            reference=reference,
            unit=said["unit"],
            start=None if dimensions else _start(texts, kind),
            minimum=said["min"],
            maximum=said["max"],
            nominal=said["nominal"],
            description=element.get("description") or "",
            definition=self._definition(said["unit"]),
            integers=self._integers.get(fmi_type, INTEGERS["Int32"]),
            items=self._items.get(declared, _NO_ITEMS),
            negated=element.get("alias") == "negatedAlias",
            optional=ours.get("optional") == "true",
            frame=ours.get("frame", ""),
            term_of=ours.get("term_of", ""),
            role=ours.get("role", ""),
        )
        clock = None
        if fmi_type == "Clock":
            inherited = self._clock_types.get(declared, {})
            clock = {**inherited, **element.attrib}
        elif not (dimensions or clocks):
            return variable, fmi_type
        sizes = [(_whole(d, "start"), _whole(d, "valueReference")) for d in dimensions]
        axes = tuple(ours.get("axes", "").split())
        entry = Entry(variable, fmi_type, clock, clocks, sizes, texts, axes, element.sourceline)
        return entry, fmi_type

    def _varying(self, element: Any, name: str, fmi_type: str) -> tuple[str, str]:
        """Return causality and variability, with the defaults of the version of FMI."""
        causality = intern(element.get("causality", "local"))
        variability: str | None = element.get("variability")
        if self.version == 1:
            if variability == "parameter":
                return "parameter", "fixed"
            causality = "local" if causality == "internal" else causality
            return causality, _variability(variability, _TYPES[fmi_type])
        if variability is None and self.version == 3 and causality in _PARAMETERS:
            variability = "fixed"
        if causality not in _CAUSALITIES:
            raise InputError(unknown("causality", causality, _CAUSALITIES))
        if variability is not None and variability not in _ALLOWED:
            raise InputError(unknown("variability", variability, _ALLOWED))
        # FMI 2.0's default holds whatever the causality is.
        if causality not in _ALLOWED[variability or "continuous"] and fmi_type != "Clock":
            self.unusual.append(f"{name} ({causality}, {variability or 'continuous'})")
        return causality, _variability(variability, _TYPES[fmi_type])

    @staticmethod
    def _inherited(value: Any, declared: Any, kind: type) -> dict[str, Any]:
        """Return unit and limits, from the declared type where a variable does not say them."""
        said: dict[str, Any] = {"unit": "", "min": None, "max": None, "nominal": None}
        if kind is not float and kind is not int:
            return said
        for name in said if kind is float else ("min", "max"):
            text = value.get(name) or getattr(declared, name, None)
            if text is not None:
                said[name] = intern(text) if name == "unit" else float(text)
        return said

    def _definition(self, name: str) -> Unit | None:
        """Return a unit's definition where its name alone does not say the same."""
        if name not in self._definitions:
            base, unit = self._units.get(name), None
            if base is not None:
                powers = {n: getattr(base, n) for n in _BASE_UNITS}
                unit = defined_unit(name, powers, base.factor, base.offset)
            self._definitions[name] = None if unit is None or unit.by_name else unit
        return self._definitions[name]


_NO_ITEMS: dict[str, int] = {}
_NOTHING: dict[str, str] = {}


def ticking(entry: Entry) -> Clock | None:
    """Return the clock that an entry is, if it is one. Raises InputError."""
    if entry.clock is None:
        return None
    try:
        return read_clock(entry.like, entry.clock, entry.clocks)
    except InputError as error:
        raise _named(entry.name, entry.line, error) from None


def elements(
    entry: Entry, parameters: Mapping[int, Variable], structure: Mapping[str, int]
) -> list[Variable]:
    """Return the scalars of an entry. ``parameters`` has structural ones by value reference.

    ``structure`` has those that differ from their start values. Raises InputError.
    """
    if not entry.dimensions:
        return [entry.like]
    try:
        return _elements(entry, parameters, structure)
    except (InputError, ValueError, KeyError, TypeError) as error:
        raise _named(entry.name, entry.line, error) from None


def _elements(
    entry: Entry, parameters: Mapping[int, Variable], structure: Mapping[str, int]
) -> list[Variable]:
    own, shape = [], []
    for size, reference in entry.dimensions:
        if size is None:
            if reference is None or reference not in parameters:
                needed = "a start or the valueReference of a structural parameter"
                raise InputError(f"Dimension: {needed} is needed, found {reference}")
            parameter = parameters[reference]
            size = int(parameter.start or 0)
            shape.append(structure.get(parameter.name, size))
        else:
            shape.append(size)
        own.append(size)
    if min(shape) < 0 or math.prod(shape) > MOST_SCALARS:
        raise InputError(f"an array of {' by '.join(map(str, shape))}")
    count = math.prod(shape)
    starts: list[Value | None] = [_parsed(text, entry.like.type) for text in entry.texts]
    if shape != own and len(starts) > 1:  # the description has those of its own size
        starts = [None]
    if len(starts) not in (0, 1, count):
        raise InputError(f"{len(starts)} start values for {count} elements")
    if len(starts) != count:
        starts = (starts or [None]) * count
    indices = product(*(range(1, size + 1) for size in shape))
    names = [f"{entry.name}[{','.join(map(str, index))}]" for index in indices]
    array = ""
    if shape == [len(entry.axes)]:
        names, array = [f"{entry.name}.{axis}" for axis in entry.axes], entry.name
    return [
        replace(entry.like, name=name, start=start, element=place, array=array)
        for place, (name, start) in enumerate(zip(names, starts, strict=True))
    ]


def _ours(annotations: Any) -> Mapping[str, str]:
    """Return what an FMU of ours says of a variable; FMI 3.0 calls the element otherwise."""
    if annotations is None:
        return _NOTHING
    port = annotations.find(f"Tool[@name='{TOOL}']/port")
    if port is None:
        port = annotations.find(f"Annotation[@type='{TOOL}']/port")
    return _NOTHING if port is None else port.attrib


def _named(name: str, line: int, error: Exception) -> InputError:
    return InputError(f"variable {name!r} (line {line}): {error}")


def _whole(element: Any, attribute: str) -> int | None:
    text = element.get(attribute)
    return None if text is None else int(text)


def _starts(element: Any, value: Any, kind: type, is_array: bool) -> Sequence[str]:
    """Return the start values as written; one that is given alone holds for all elements."""
    if element.tag in ("String", "Binary"):  # FMI 3
        return [start.get("value") for start in element.findall("Start")]
    text = value.get("start")
    if text is None:
        return ()
    return text.split() if is_array and kind is not str else (text,)


def _start(texts: Sequence[str], kind: type) -> Value | None:
    """Return the start value of a scalar."""
    if len(texts) > 1:
        raise InputError(f"{len(texts)} start values for 1 elements")
    return _parsed(texts[0], kind) if texts else None


def _variability(written: str | None, kind: type) -> str:
    if kind is not float and written in (None, "continuous"):  # FMI 2.0's default is for Real
        return "discrete"
    return intern(written or "continuous")


def _parsed(text: str, kind: type) -> Value:
    if kind is bool:
        if text not in _TRUTH:
            raise InputError(f"start value {text!r} is not true or false")
        return _TRUTH[text]
    if kind is bytes:
        return bytes.fromhex(text)
    return kind(text)  # type: ignore[no-any-return]
