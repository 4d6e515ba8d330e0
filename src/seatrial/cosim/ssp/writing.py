"""Assembled rigs as SSP 1.0 packages, in the subset that other tools read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from ... import __version__
from ...component import seconds
from ...errors import InputError
from ...fmi.cache import write_whole
from ...fmi.export import fmu_bytes, zipped
from ...fmi.instance import Variable
from ...fmi.source import find_source
from ...units import Unit, conversion, unit
from ..part import Part
from ..system import Connection, System
from .annotations import write_oms, write_osp
from .definitions import write_units
from .documents import NAMESPACES
from .package import DEFAULT
from .parameters import Value, parameter_set, type_name
from .structure import FMU

_PREFIXES = ("ssd", "ssc", "ssv", "osp", "oms")


@dataclass(frozen=True)
class Experiment:
    """What a package says besides its system: a name and the times of a run, s."""

    name: str
    start: float
    stop: float


def write_ssp(system: System, experiment: Experiment, path: Path) -> list[str]:
    """Write ``system`` as an SSP package and return what other tools must know of it.

    Every value set is in a parameter set of its component and, where the FMU is built here,
    its start value too. The same input gives the same bytes. Raises InputError for what SSP
    cannot hold; nothing is written then.
    """
    _refuse_fed_parameters(system)
    notes: list[str] = []
    files: dict[str, bytes] = {}
    for part in system.parts.values():
        values = {name: given.value for name, given in part.given.items()}
        files[f"resources/{part.name}.fmu"] = _fmu(system, part, values, notes)
        if values:
            files[f"resources/{part.name}.ssv"] = _xml(parameter_set(part.name, values))
    files[DEFAULT] = _xml(_description(system, experiment, notes))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, zipped(files))
    return [*notes, *_unsaid(system)]


def _refuse_fed_parameters(system: System) -> None:
    for connection in system.connections:
        target = system.parts[connection.target[0]].instance.variables[connection.target[1]]
        if target.causality == "parameter":
            raise InputError(
                f"{'.'.join(connection.source)} feeds the parameter "
                f"{'.'.join(connection.target)}, for which SSP has no connection"
            )


def _fmu(system: System, part: Part, values: Mapping[str, Value], notes: list[str]) -> bytes:
    source = find_source(part.fmu, system.rig.components[part.name].scope.folder)
    if not isinstance(source, Path):
        return fmu_bytes(source, values)
    if values:
        notes.append(
            f"{part.name}: {source.name} is copied as it is: its values are in its parameter "
            "set only, for tools that read it"
        )
    return source.read_bytes()


def _unsaid(system: System) -> list[str]:
    """Return what SSP cannot say of a rig."""
    notes = []
    file = system.rig.file
    if file.algorithm != "plain-jacobi":
        notes.append(
            f"the algorithm {file.algorithm!r} cannot be said: other tools couple by plain Jacobi, "
            "one step of delay per connection"
        )
    if any(placed.entry.isolated for placed in system.rig.components.values()):
        notes.append("isolated = true cannot be said: other tools choose their processes")
    return notes


def _description(system: System, experiment: Experiment, notes: list[str]) -> Any:
    prefixes: Any = {prefix: NAMESPACES[prefix] for prefix in _PREFIXES}
    document = etree.Element(
        _name("ssd", "SystemStructureDescription"),
        {
            "name": re.sub(r"[^A-Za-z0-9_]", "_", re.sub(r"^(?=\d)", "_", experiment.name)),
            "version": "1.0",
            "generationTool": f"seatrial {__version__}",
        },
        nsmap=prefixes,
    )
    top = _add(document, "ssd", "System", name="root")
    elements = _add(top, "ssd", "Elements")
    used: dict[str, Unit] = {}
    for part in system.parts.values():
        _add_component(elements, system, part, used, notes)
    if system.connections:
        connections = _add(top, "ssd", "Connections")
        for connection in system.connections:
            _add_connection(connections, system, connection)
    step = seconds(system.rig.step_ns)
    write_oms(top, step)
    write_units(document, used)
    times = {"startTime": repr(experiment.start), "stopTime": repr(experiment.stop)}
    default = _add(document, "ssd", "DefaultExperiment", **times)
    write_osp(default, "FixedStepAlgorithm", {"baseStepSize": repr(step)}, around="Algorithm")
    return document


def _add_component(
    elements: Any, system: System, part: Part, used: dict[str, Unit], notes: list[str]
) -> None:
    source = f"resources/{part.name}.fmu"
    component = _add(elements, "ssd", "Component", name=part.name, type=FMU, source=source)
    variables = _declared(system, part)
    if variables:
        connectors = _add(component, "ssd", "Connectors")
        for variable in variables:
            connector = _add(
                connectors, "ssd", "Connector", name=variable.name, kind=variable.causality
            )
            _add(connector, "ssc", type_name(variable.type), **_unit(part, variable, used, notes))
    if part.given:
        _add(
            _add(component, "ssd", "ParameterBindings"),
            "ssd",
            "ParameterBinding",
            type="application/x-ssp-parameter-set",
            source=f"resources/{part.name}.ssv",
        )
    if part.every > 1:
        own = seconds(part.every * system.rig.step_ns)
        write_osp(component, "StepSizeHint", {"value": repr(own)})


def _declared(system: System, part: Part) -> list[Variable]:
    """Return the connectors: connected inputs, and outputs.

    FMPy feeds 0 to inputs that nothing feeds, and cannot record texts.
    """
    ends = {
        end for connection in system.connections for end in (connection.source, connection.target)
    }
    return [
        variable
        for variable in part.instance.variables.values()
        if (part.name, variable.name) in ends
        or (variable.causality == "output" and variable.type in (float, int, bool))
    ]


def _unit(
    part: Part, variable: Variable, used: dict[str, Unit], notes: list[str]
) -> dict[str, str]:
    """Return the attribute that names a unit; ``used`` gets what the FMU means by it."""
    if variable.type is not float or not variable.unit:
        return {}
    where = f"{part.name}.{variable.name}: unit {variable.unit!r} is not written"
    try:
        meant = variable.definition or unit(variable.unit)
    except InputError:
        notes.append(where)
        return {}
    if used.setdefault(variable.unit, meant) != meant:
        notes.append(f"{where}: another FMU defines it otherwise")
        return {}
    return {"unit": variable.unit}


def _unlike(system: System, connection: Connection) -> bool:
    """Say if a tool that converts units would change the values of a connection, or refuse it."""
    source, target = (
        system.parts[name].instance.variables[port]
        for name, port in (connection.source, connection.target)
    )
    if not (source.type is target.type is float and source.unit and target.unit):
        return False
    try:
        return conversion(source.measure, target.measure) != (1.0, 0.0)
    except InputError:
        return True


def _add_connection(connections: Any, system: System, connection: Connection) -> None:
    attributes = {
        "startElement": connection.source[0],
        "startConnector": connection.source[1],
        "endElement": connection.target[0],
        "endConnector": connection.target[1],
    }
    plain = (connection.factor, connection.offset) == (1.0, 0.0)
    # Not every tool converts units: the transformation says all, for all of them.
    if not plain or _unlike(system, connection):
        attributes["suppressUnitConversion"] = "true"
    element = _add(connections, "ssd", "Connection", **attributes)
    if plain:
        return
    numbers = {"factor": repr(connection.factor), "offset": repr(connection.offset)}
    _add(element, "ssc", "LinearTransformation", **numbers)


def _add(parent: Any, prefix: str, element: str, /, **attributes: str) -> Any:
    try:
        return etree.SubElement(parent, _name(prefix, element), attributes)
    except ValueError:
        raise InputError(f"XML cannot hold one of the texts {list(attributes.values())}") from None


def _name(prefix: str, name: str) -> str:
    return f"{{{NAMESPACES[prefix]}}}{name}"


def _xml(root: Any) -> bytes:
    text: bytes = etree.tostring(root, encoding="UTF-8", xml_declaration=True, pretty_print=True)
    return text
