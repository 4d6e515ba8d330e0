"""Descriptions of packages: the XML of systems, components and connections."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from lxml import etree

from seatrial import __version__
from seatrial.errors import InputError
from seatrial.fmi.instance import Variable
from seatrial.model.component import seconds
from seatrial.model.units import Unit, conversion, unit
from seatrial.system.part import Part
from seatrial.system.paths import joined
from seatrial.system.system import Connection, System

from .annotations import write_oms, write_osp
from .definitions import write_enumerations, write_units
from .documents import NAMESPACES
from .layout import End, Level
from .model import FMU, Indices
from .shapes import Shapes, Version
from .transformations import write_table

_PREFIXES = ("ssd", "ssc", "ssv", "osp", "oms")


@dataclass(frozen=True)
class Experiment:
    """What a package says besides its system: a name and the times of a run, s."""

    name: str
    start: float
    stop: float


class Describer:
    """Describes a rig whose components are connected by ``connections``.

    ``shapes`` says what the version of SSP can say of each component.
    ``notes`` has what could not be written. Raises InputError for texts that XML cannot hold.
    """

    def __init__(
        self, system: System, connections: Sequence[Connection], shapes: Mapping[str, Shapes]
    ) -> None:
        self.notes: list[str] = []
        self._shapes = shapes
        self._system = system
        self._defined: dict[str, Unit] = {}
        ends = {end for connection in connections for end in (connection.source, connection.target)}
        self._declared = {
            name: [v for v in _declared(part, ends) if v.name not in shapes[name].unsaid]
            for name, part in system.parts.items()
        }
        self._enumerations: dict[str, Mapping[str, int]] = {}
        self._measures = {
            (name, variable.name): self._unit(name, variable) or self._enumeration(name, variable)
            for name, variables in self._declared.items()
            for variable in variables
        }
        """The attribute that names the unit of a connector, or its enumeration."""

    def document(self, top: Level, experiment: Experiment, version: Version) -> Any:
        """Return the whole description of a package with the system ``top``."""
        prefixes: Any = {prefix: NAMESPACES[prefix] for prefix in _PREFIXES}
        document = etree.Element(
            _name("ssd", "SystemStructureDescription"),
            {
                "name": re.sub(r"[^A-Za-z0-9_]", "_", re.sub(r"^(?=\d)", "_", experiment.name)),
                "version": version,
                "generationTool": f"seatrial {__version__}",
            },
            nsmap=prefixes,
        )
        step = seconds(self._system.rig.step_ns)
        write_oms(self._add_system(document, top, ""), step)
        write_enumerations(document, self._enumerations)
        write_units(document, self._defined)
        times = {"startTime": repr(experiment.start), "stopTime": repr(experiment.stop)}
        default = _add(document, "ssd", "DefaultExperiment", **times)
        write_osp(default, "FixedStepAlgorithm", {"baseStepSize": repr(step)}, around="Algorithm")
        return document

    def _add_system(self, parent: Any, level: Level, path: str) -> Any:
        system = _add(parent, "ssd", "System", name=level.name)
        if level.connectors:
            connectors = _add(system, "ssd", "Connectors")
            for name, (kind, (component, output)) in level.connectors.items():
                variable = self._system.parts[component].instance.variables[output]
                self._add_connector(connectors, name, kind, component, variable)
        elements = _add(system, "ssd", "Elements")
        for name, element in level.elements.items():
            if isinstance(element, Level):
                self._add_system(elements, element, joined(path, name))
            else:
                self._add_component(elements, name, element, f"resources/{joined(path, name)}")
        if level.connections:
            connections = _add(system, "ssd", "Connections")
            for (start, end), connection in level.connections.items():
                attributes = {**self._end(level, "start", start), **self._end(level, "end", end)}
                self._add_connection(connections, attributes, connection)
        return system

    def _add_component(self, elements: Any, name: str, part: Part, file: str) -> None:
        component = _add(elements, "ssd", "Component", name=name, type=FMU, source=f"{file}.fmu")
        variables = self._declared[part.name]
        if variables:
            connectors = _add(component, "ssd", "Connectors")
            shapes = self._shapes[part.name]
            for name, variable in {shapes.connector(v.name)[0]: v for v in variables}.items():
                sizes = shapes.sizes.get(name, ())
                kind = shapes.kind(variable)
                self._add_connector(connectors, name, kind, part.name, variable, sizes)
        if part.given:
            _add(
                _add(component, "ssd", "ParameterBindings"),
                "ssd",
                "ParameterBinding",
                type="application/x-ssp-parameter-set",
                source=f"{file}.ssv",
            )
        if part.every > 1:
            own = seconds(part.every * self._system.rig.step_ns)
            write_osp(component, "StepSizeHint", {"value": repr(own)})

    def _add_connector(
        self,
        connectors: Any,
        name: str,
        kind: str,
        component: str,
        variable: Variable,
        sizes: Indices = (),
    ) -> None:
        """Add a connector for values of a component's variable."""
        connector = _add(connectors, "ssd", "Connector", name=name, kind=kind)
        kind = self._shapes[component].type(variable)
        _add(connector, "ssc", kind, **self._measures[component, variable.name])
        for size in sizes:
            _add(connector, "ssc", "Dimension", size=str(size))

    def _end(self, level: Level, side: str, end: End) -> dict[str, str]:
        """Return the attributes of one end of a connection."""
        element, connector = end
        if not element:
            return {f"{side}Connector": connector}
        part, indices = level.elements[element], None
        if isinstance(part, Part):
            connector, indices = self._shapes[part.name].connector(connector)
        attributes = {f"{side}Element": element, f"{side}Connector": connector}
        if indices is not None:
            attributes[f"{side}Indices"] = " ".join(map(str, indices))
        return attributes

    def _add_connection(
        self, connections: Any, attributes: dict[str, str], made: Connection | None
    ) -> None:
        """Add a connection; one that passes a value on has nothing ``made`` of it."""
        plain = made is None or (made.factor, made.offset) == (1.0, 0.0)
        # Not every tool converts units: the transformation says all, for all of them.
        if made is not None and not (plain and self._alike(made)):
            attributes["suppressUnitConversion"] = "true"
        element = _add(connections, "ssd", "Connection", **attributes)
        if made is not None and made.mapping:
            write_table(element, made.mapping)
        if made is None or plain:
            return
        numbers = {"factor": repr(made.factor), "offset": repr(made.offset)}
        _add(element, "ssc", "LinearTransformation", **numbers)

    def _alike(self, connection: Connection) -> bool:
        """Say if a tool that converts units takes a connection's values as they are."""
        source, target = (
            self._system.parts[name].instance.variables[port]
            for name, port in (connection.source, connection.target)
        )
        if not (source.type is target.type is float and source.unit and target.unit):
            return True
        try:
            return conversion(source.measure, target.measure) == (1.0, 0.0)
        except InputError:
            return False

    def _unit(self, component: str, variable: Variable) -> dict[str, str]:
        """Return the attribute that names a unit, and keep what the FMU means by it."""
        if variable.type is not float or not variable.unit:
            return {}
        where = f"{component}.{variable.name}: unit {variable.unit!r} is not written"
        try:
            meant = variable.definition or unit(variable.unit)
        except InputError:
            self.notes.append(where)
            return {}
        if self._defined.setdefault(variable.unit, meant) != meant:
            self.notes.append(f"{where}: another FMU defines it otherwise")
            return {}
        return {"unit": variable.unit}

    def _enumeration(self, component: str, variable: Variable) -> dict[str, str]:
        """Return the attribute that names an enumeration, one of its own where two differ."""
        found = self._shapes[component].enumerations.get(variable.name)
        if found is None:
            return {}
        name = found.name
        if self._enumerations.get(name, found.items) != found.items:
            name = f"{component}.{name}"
        self._enumerations[name] = found.items
        return {"name": name}


def _declared(part: Part, ends: set[tuple[str, str]]) -> list[Variable]:
    """Return the connectors of a component: connected inputs, and outputs.

    FMPy feeds 0 to inputs that nothing feeds, and cannot record texts.
    """
    return [
        variable
        for variable in part.instance.variables.values()
        if (part.name, variable.name) in ends
        or (variable.causality == "output" and variable.type in (float, int, bool))
    ]


def as_xml(root: Any) -> bytes:
    """Return a document as it is written to a file."""
    text: bytes = etree.tostring(root, encoding="UTF-8", xml_declaration=True, pretty_print=True)
    return text


def _add(parent: Any, prefix: str, element: str, /, **attributes: str) -> Any:
    try:
        return etree.SubElement(parent, _name(prefix, element), attributes)
    except ValueError:
        raise InputError(f"XML cannot hold one of the texts {list(attributes.values())}") from None


def _name(prefix: str, name: str) -> str:
    return f"{{{NAMESPACES[prefix]}}}{name}"
