"""The modelDescription.xml of a component: pythonfmu's, with all that it leaves out."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu.default_experiment import DefaultExperiment
from pythonfmu.enums import Fmi2Causality, Fmi2Initial, Fmi2Variability
from pythonfmu.variables import Boolean, Integer, Real, String

from ..errors import InputError
from ..model.component import Component, Input, Parameter
from ..model.ports import Port, ScalarPort
from ..model.units import unit
from .dependencies.found import feedthrough_of
from .slave import Slave

_VARIABLES = {float: Real, int: Integer, bool: Boolean, str: String}
_CAUSALITY = {
    "parameter": Fmi2Causality.parameter,
    "input": Fmi2Causality.input,
    "output": Fmi2Causality.output,
}


def describe(cls: type[Component], name: str, start_values: Mapping[str, Any]) -> Element:
    """Return the model description of a component class, as the FMU ``name``.

    ``start_values`` (by port name, SI) replace start values of the class. pythonfmu writes the
    description; added are units, min, max, nominal, exact start values, variability, output
    dependencies, InitialUnknowns, annotations of roles, of optional inputs and of terms of sums,
    and the capabilities that the component really has.

    Raises InputError for a start value that does not fit, or a unit that cannot be written in
    FMI's base units.
    """
    slave = type(cls.__name__, (Slave,), {"component_class": cls})(instance_name=name, resources="")
    component = slave.component
    for port, value in start_values.items():
        component.set(port, value)
    component.check_parameters()
    _register(slave)
    able = str(component.rolls_back).lower()
    any_step = str(not component.fixed_step).lower()
    root: Element = slave.to_xml(
        {
            "canGetAndSetFMUstate": able,
            "canSerializeFMUstate": able,
            "canHandleVariableCommunicationStepSize": any_step,
        }
    )
    root.set("modelName", name)
    root.attrib.pop("generationDateAndTime", None)
    variables = root.find("ModelVariables")
    assert variables is not None
    for scalar, element in zip(component.scalars, variables, strict=True):
        _complete_variable(component, scalar, element[0])
        _annotate(element, scalar.port)
    _insert_units(root, component)
    _insert_views(root, cls)
    structure = root.find("ModelStructure")
    assert structure is not None
    structure.clear()
    _add_unknowns(structure, component)
    return root


def _insert_views(root: Element, cls: type[Component]) -> None:
    """Write the views as an annotation of the vendor, where `variables` reads them.

    In one element: FMI 2.0's schema allows a tool one.
    """
    if cls.views:
        annotations = Element("VendorAnnotations")
        tool = SubElement(annotations, "Tool", {"name": "seatrial"})
        views = SubElement(tool, "views")
        for kind, ports in cls.views.items():
            SubElement(views, "view", {"kind": kind, **ports})
        places = [child.tag for child in root]
        root.insert(places.index("ModelVariables"), annotations)


def _annotate(element: Element, port: Port) -> None:
    optional, term_of = (port.optional, port.term_of) if isinstance(port, Input) else (False, "")
    annotate(element, role=port.role, frame=port.frame, optional=optional, term_of=term_of)


def annotate(element: Element, *, role: str, frame: str, optional: bool, term_of: str) -> None:
    """Write of a variable what FMI has no attribute for, where `variables` reads it.

    In one element: FMI 2.0's schema allows a tool one, and names a tool once.
    """
    said = {"role": role, "frame": frame, "term_of": term_of}
    said["optional"] = "true" if optional else ""
    given = {name: text for name, text in said.items() if text}
    if given:
        tool = SubElement(SubElement(element, "Annotations"), "Tool", {"name": "seatrial"})
        SubElement(tool, "port", given)


def summary(component: type[Component]) -> str:
    """Return the first line of a component's description, empty if it has none."""
    return (component.__doc__ or "").strip().partition("\n")[0].strip()


def _register(slave: Slave) -> None:
    component = slave.component
    slave.description = summary(type(component))
    step = component.fixed_step or 0.01
    slave.default_experiment = DefaultExperiment(start_time=0.0, stop_time=10.0, step_size=step)
    slave.vars.clear()
    for scalar in component.scalars:
        port, reference = scalar.port, scalar.reference
        output = port.kind == "output"
        variable = _VARIABLES[port.type](
            scalar.name,
            causality=_CAUSALITY[port.kind],
            variability=variability(component, scalar),
            initial=Fmi2Initial.calculated if output else None,
            description=_text(port.description),
            getter=lambda reference=reference: component.values[reference],
        )
        slave.register_variable(variable, nested=False)


def variability(component: Component, scalar: ScalarPort) -> Fmi2Variability:
    """Return the variability of a variable in FMI."""
    port = scalar.port
    if isinstance(port, Parameter):
        return Fmi2Variability.tunable if port.tunable else Fmi2Variability.fixed
    continuous = port.type is float and not component.discrete
    return Fmi2Variability.continuous if continuous else Fmi2Variability.discrete


def _complete_variable(component: Component, scalar: ScalarPort, element: Element) -> None:
    port = scalar.port
    value = component.values[scalar.reference]
    if "start" in element.attrib:
        element.set("start", str(value).lower() if port.type is bool else _text(value))
    if port.type is float:
        if scalar.unit:
            try:
                element.set("unit", unit(scalar.unit).text)
            except InputError as error:
                raise InputError(f"{type(component).__name__}.{port.name}: {error}") from None
        for name in ("min", "max", "nominal"):
            limit = port.limit(name, scalar.index)
            if limit is not None and math.isfinite(limit):
                element.set(name, repr(float(limit)))


def _text(value: Any) -> str:
    if isinstance(value, str) and any(ord(c) < 32 and c not in "\t\n\r" for c in value):
        raise InputError(f"the text {value!r} has a character that XML cannot hold")
    return value if isinstance(value, str) else repr(value)


def _insert_units(root: Element, component: Component) -> None:
    definitions = unit_definitions(s.unit for s in component.scalars if s.port.type is float)
    if definitions is not None:
        root.insert(1, definitions)  # the schema wants it right after CoSimulation


def unit_definitions(units: Iterable[str]) -> Element | None:
    """Return the definitions of the units of variables, None if none of them has one."""
    used = {unit(text).text: unit(text) for text in units if text}
    if not used:
        return None
    definitions = Element("UnitDefinitions")
    for text, one in sorted(used.items()):
        definition = SubElement(definitions, "Unit", {"name": text})
        attributes = {name: str(power) for name, power in one.exponents.items()}
        if one.factor != 1.0:
            attributes["factor"] = repr(one.factor)
        if one.offset != 0.0:
            attributes["offset"] = repr(one.offset)
        SubElement(definition, "BaseUnit", attributes)
    return definitions


def _add_unknowns(structure: Element, component: Component) -> None:
    outputs = [s for s in component.scalars if s.port.kind == "output"]
    if not outputs:
        return
    fixed = [s for s in component.scalars if s.port.kind == "parameter"]
    listed = SubElement(structure, "Outputs")
    initial = SubElement(structure, "InitialUnknowns")
    through = feedthrough_of(type(component))
    for scalar in outputs:
        ports = through[scalar.port.name]
        acting = [s for s in component.scalars if s.port.kind == "input" and s.port.name in ports]
        _add_unknown(listed, scalar, acting)
        _add_unknown(initial, scalar, [*fixed, *acting])


def _add_unknown(parent: Element, scalar: ScalarPort, known: list[ScalarPort]) -> None:
    # Index in ModelVariables counts from one; references follow the same order from zero.
    dependencies = " ".join(str(k.reference + 1) for k in known)
    SubElement(
        parent, "Unknown", {"index": str(scalar.reference + 1), "dependencies": dependencies}
    )
