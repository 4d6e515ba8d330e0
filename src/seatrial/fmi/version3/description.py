"""The modelDescription.xml of FMI 3.0, from that of FMI 2.0.

A port with axes is one array, if unit, limits and nominal value are those of all its elements;
others are scalars, named as in FMI 2.0. A port of bytes is a Binary.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from xml.etree.ElementTree import Element, SubElement

from ...links.text import packed
from ...model.ports import BYTES, Port, ScalarPort
from ..files.osp import QUANTITIES
from ..files.terminals import TOOL, xml_text
from .buses import CanTerminal, add_bus_outputs, bus_variables

MORE_THAN_ONE = 1 << 20
"""Part of a value reference for each element that follows the first; see ``front.h``."""
_TIME = MORE_THAN_ONE - 1
_MOST_ELEMENTS = 4095
"""Of an array; the references of more are those of buses."""

BINARY = "application/vnd.seatrial.chunks"
"""Type of the content of a Binary; see ``chunks.c``."""

_TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "String": "String"}
_SHARED = ("unit", "min", "max", "nominal")
_CATEGORIES = ("logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal")


def version3(
    root: Element, scalars: Sequence[ScalarPort], buses: Sequence[CanTerminal] = ()
) -> Element:
    """Return the model description of FMI 3.0 that says what ``root`` does in FMI 2.0.

    ``scalars`` are its variables, in their order; ``buses`` its CAN terminals, with which it has
    event mode.
    """
    variables = root.find("ModelVariables")
    assert variables is not None
    groups = _groups(scalars, list(variables))
    simulation = root.find("CoSimulation")
    assert simulation is not None
    result = Element("fmiModelDescription", {"fmiVersion": "3.0", **_of_model(root)})
    result.append(_co_simulation(simulation))
    if buses:
        result[-1].set("hasEventMode", "true")
    units = root.find("UnitDefinitions")
    if units is not None:
        result.append(units)
        result.extend(_types(units))
    categories = SubElement(result, "LogCategories")
    for name in _CATEGORIES:
        SubElement(categories, "Category", {"name": name})
    experiment = root.find("DefaultExperiment")
    if experiment is not None:
        result.append(experiment)
    listed = SubElement(result, "ModelVariables")
    for group in groups:
        listed.append(_variable(group))
    listed.extend(bus_variables(buses))
    _add_time(listed, "s" in {u.get("name") for u in units} if units is not None else False)
    structure = _structure(root, groups)
    add_bus_outputs(structure, buses)
    result.append(structure)
    views = root.find("VendorAnnotations/Tool")
    if views is not None:
        note = SubElement(SubElement(result, "Annotations"), "Annotation", {"type": TOOL})
        note.extend(list(views))
    return result


def arrays(scalars: Sequence[ScalarPort], root: Element) -> set[str]:
    """Return the ports that are one variable each, of the model description of FMI 2.0."""
    variables = root.find("ModelVariables")
    assert variables is not None
    groups = _groups(scalars, list(variables))
    return {group.port.name for group in groups if group.is_array}


class _Group:
    """Scalars of FMI 2.0 that are one variable: a port, or one of its elements."""

    def __init__(self, scalars: Sequence[tuple[ScalarPort, Element]], is_array: bool) -> None:
        self.scalars = [scalar for scalar, _ in scalars]
        self.elements = [element for _, element in scalars]
        self.is_array = is_array
        self.port: Port = self.scalars[0].port
        size = len(self.scalars)
        self.reference = self.scalars[0].reference + (size - 1) * MORE_THAN_ONE

    @property
    def name(self) -> str:
        return self.port.name if self.is_array else self.scalars[0].name


def _groups(scalars: Sequence[ScalarPort], elements: Sequence[Element]) -> list[_Group]:
    pairs = zip(scalars, elements, strict=True)
    groups = []
    for _, grouped in groupby(pairs, lambda pair: pair[0].port.name):
        members = list(grouped)
        shared = {tuple(map(element[0].get, _SHARED)) for _, element in members}
        has_axes = members[0][0].port.axes is not None
        if has_axes and len(shared) == 1 and len(members) <= _MOST_ELEMENTS:
            groups.append(_Group(members, True))
        else:
            groups += [_Group([one], False) for one in members]
    return groups


def _of_model(root: Element) -> dict[str, str]:
    said = {name: root.get(name, "") for name in ("modelName", "description", "generationTool")}
    said["variableNamingConvention"] = "structured"
    said["instantiationToken"] = root.get("guid", "")
    return {name: text for name, text in said.items() if text}


def _co_simulation(simulation: Element) -> Element:
    old = simulation.attrib
    said = {
        "modelIdentifier": old["modelIdentifier"],
        "canHandleVariableCommunicationStepSize": old["canHandleVariableCommunicationStepSize"],
    }
    said |= {
        name: old[name]
        for name in ("needsExecutionTool", "canBeInstantiatedOnlyOncePerProcess")
        if name in old
    }
    for name in ("canGetAndSetFMUState", "canSerializeFMUState"):
        said[name] = old.get(name.replace("FMUState", "FMUstate"), "false")
    if old.get("providesDirectionalDerivative") == "true":
        said |= {"providesDirectionalDerivatives": "true", "providesAdjointDerivatives": "true"}
    return Element("CoSimulation", said)


def _types(units: Element) -> list[Element]:
    """Return the quantities that have a name as types of the variables with their units."""
    types = Element("TypeDefinitions")
    for name in (unit.get("name", "") for unit in units):
        if name in QUANTITIES:
            quantity = QUANTITIES[name]
            SubElement(types, "Float64Type", {"name": quantity, "quantity": quantity, "unit": name})
    return [types] if len(types) else []


def _variable(group: _Group) -> Element:
    outer, inner = group.elements[0], group.elements[0][0]
    is_binary = group.port.role in BYTES and group.port.type is str
    fmi_type = "Binary" if is_binary else _TYPES[inner.tag]
    said = {"name": group.name, "valueReference": str(group.reference)}
    for name in ("description", "causality", "variability", "initial"):
        if name in outer.attrib and (name, outer.get("causality")) != ("initial", "input"):
            said[name] = outer.attrib[name]
    said |= {name: inner.attrib[name] for name in _SHARED if name in inner.attrib}
    if said.get("unit", "") in QUANTITIES:
        said["declaredType"] = QUANTITIES[said["unit"]]
    starts = [e[0].get("start") for e in group.elements]
    has_starts = None not in starts
    if is_binary:
        said["mimeType"] = BINARY
    elif has_starts and fmi_type != "String":
        said["start"] = " ".join(map(str, starts))
    variable = Element(fmi_type, said)
    _annotate(variable, group, outer)
    if group.is_array:
        SubElement(variable, "Dimension", {"start": str(len(group.scalars))})
    if has_starts and fmi_type in ("String", "Binary"):
        for start in starts:
            text = str(start)
            SubElement(variable, "Start", {"value": packed(text).hex() if is_binary else text})
    return variable


def _annotate(variable: Element, group: _Group, element: Element) -> None:
    said: dict[str, str] = {}
    port = element.find("Annotations/Tool/port")
    if port is not None:
        said |= port.attrib
    if group.is_array:
        said["axes"] = " ".join(group.port.axes or ())
    if said:
        note = SubElement(SubElement(variable, "Annotations"), "Annotation", {"type": TOOL})
        SubElement(note, "port", said)


def _add_time(listed: Element, has_seconds: bool) -> None:
    names = {variable.get("name") for variable in listed}
    name = "time" if "time" not in names else "simulation_time"
    said = {"name": name, "valueReference": str(_TIME), "description": "simulation time"}
    said |= {"causality": "independent", "variability": "continuous"}
    listed.append(Element("Float64", {**said, **({"unit": "s"} if has_seconds else {})}))


def _structure(root: Element, groups: Sequence[_Group]) -> Element:
    """Return outputs and initial unknowns; an array depends on all that its elements do."""
    references = {s.reference + 1: g.reference for g in groups for s in g.scalars}
    structure = Element("ModelStructure")
    for place, tag in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        known: dict[int, dict[int, None]] = {}
        for unknown in root.iterfind(f"ModelStructure/{place}/Unknown"):
            own = known.setdefault(references[int(unknown.get("index", ""))], {})
            own |= {references[int(i)]: None for i in unknown.get("dependencies", "").split()}
        for reference, dependencies in known.items():
            said = {
                "valueReference": str(reference),
                "dependencies": " ".join(map(str, dependencies)),
            }
            SubElement(structure, tag, said)
    return structure


def build_description(identifier: str, sources: Sequence[str], options: Sequence[str]) -> bytes:
    """Return ``sources/buildDescription.xml``: what a compiler has to do."""
    root = Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = SubElement(root, "BuildConfiguration", {"modelIdentifier": identifier})
    said = {"language": "C99", "compilerOptions": " ".join(options)}
    files = SubElement(configuration, "SourceFileSet", said)
    for name in sources:
        SubElement(files, "SourceFile", {"name": name})
    SubElement(configuration, "Library", {"name": "m", "external": "true"})
    return xml_text(root)
