"""The modelDescription.xml of a rig as one FMU."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import groupby
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from seatrial import __version__
from seatrial.fmi.description import annotate, unit_definitions
from seatrial.fmi.instance import Variable
from seatrial.model.ports import Input, Port, ScalarPort
from seatrial.model.units import unit

from .face import Face

_ELEMENTS = {float: "Real", int: "Integer", bool: "Boolean", str: "String"}


def describe_rig(face: Face, name: str, identifier: str, title: str, step_ns: int) -> Element:
    """Return the model description, without GUID, of a rig that takes whole multiples of a step."""
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": name,
            "guid": "",
            "description": title,
            "generationTool": f"seatrial {__version__}",
            "variableNamingConvention": "structured",
        },
    )
    SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": identifier,
            "needsExecutionTool": "false",
            "canHandleVariableCommunicationStepSize": "false",
            "canBeInstantiatedOnlyOncePerProcess": "false",
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
        },
    )
    units = unit_definitions(v.unit for v in face.variables.values() if v.type is float)
    if units is not None:
        root.append(units)
    experiment = {"startTime": "0.0", "stopTime": "10.0", "stepSize": repr(step_ns / 1e9)}
    SubElement(root, "DefaultExperiment", experiment)
    listed = SubElement(root, "ModelVariables")
    for variable in face.variables.values():
        _add_variable(listed, variable)
    _add_structure(SubElement(root, "ModelStructure"), face)
    return root


def _add_variable(listed: Element, variable: Variable) -> None:
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality == "output":
        attributes["initial"] = "calculated"
    if variable.description:
        attributes["description"] = variable.description
    element = SubElement(listed, "ScalarVariable", attributes)
    typed = SubElement(element, _ELEMENTS[variable.type])
    if variable.type is float:
        if variable.unit:
            typed.set("unit", unit(variable.unit).text)
        limits = {"min": variable.minimum, "max": variable.maximum, "nominal": variable.nominal}
        for name, limit in limits.items():
            if limit is not None and math.isfinite(limit):
                typed.set(name, repr(float(limit)))
    if variable.causality != "output":
        typed.set("start", _text(variable.first))
    annotate(
        element,
        role=variable.role,
        frame=variable.frame,
        optional=variable.optional,
        term_of=variable.term_of,
    )


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else repr(value)


def _add_structure(structure: Element, face: Face) -> None:
    """Add what each output follows at once; at the start it follows all parameters too."""
    outputs = [v for v in face.variables.values() if v.causality == "output"]
    if not outputs:
        return
    listed, initial = SubElement(structure, "Outputs"), SubElement(structure, "InitialUnknowns")
    for variable in outputs:
        index = str(variable.reference + 1)
        through = face.through.get(variable.name, [])
        known = " ".join(str(face.variables[name].reference + 1) for name in through)
        SubElement(listed, "Unknown", {"index": index, "dependencies": known})
        SubElement(initial, "Unknown", {"index": index})


def scalars_of(face: Face) -> list[ScalarPort]:
    """Return the variables with the ports that they are elements of, side by side."""
    found = []
    for port, members in groupby(face.variables.values(), lambda v: face.variables.port_of(v.name)):
        for whole, of_port in _ports(port, list(members), face):
            found += [ScalarPort(v.name, v.reference, whole, i) for i, v in enumerate(of_port)]
    return found


def _ports(port: str, members: list[Variable], face: Face) -> Iterator[tuple[Port, list[Variable]]]:
    """Yield the port of variables that differ in their last names alone, else one for each."""
    axes = [v.name[len(port) + 1 :] for v in members]
    components = {name for names in face.targets.values() for name, _ in names}
    is_port = port not in components and all(axis.isidentifier() for axis in axes)
    kinds = {(v.causality, v.variability, v.type) for v in members}
    if is_port and len(kinds) == 1:
        whole = Input("1", "", axes=axes)
        whole.name = port
        yield whole.placed(members[0].reference), members
        return
    for variable in members:
        alone = Input("1", "")
        alone.name = variable.name
        yield alone.placed(variable.reference), [variable]
