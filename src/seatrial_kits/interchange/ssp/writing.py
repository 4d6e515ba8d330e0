"""Assembled rigs as SSP packages, in the subset that other tools read."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from seatrial.errors import InputError
from seatrial.fmi.building.export import fmu_bytes
from seatrial.fmi.building.packing import zipped
from seatrial.fmi.cache import write_named
from seatrial.fmi.components.source import find_source
from seatrial.system.packages import SSP_FILE
from seatrial.system.part import Part
from seatrial.system.system import Connection, System

from .describing import Describer, Experiment, as_xml
from .layout import flat, nested
from .parameters import Value, Written, parameter_set
from .shapes import Shapes, Version, shapes_of


def write_ssp(
    system: System,
    experiment: Experiment,
    path: Path,
    *,
    in_one: bool = False,
    version: Version = "1.0",
) -> list[str]:
    """Write ``system`` as an SSP package and return what other tools must know of it.

    A rig inside a rig is a system inside a system; ``in_one`` puts all components into one.
    Version 2.0 has the types and arrays of FMI 3.
    Every value set is in a parameter set of its component and, where the FMU is built here,
    its start value too. The same input gives the same bytes. Raises InputError for what SSP
    cannot hold; nothing is written then.
    """
    tuned = system.tuned
    connections = [one for one in system.connections if one.target not in tuned]
    _refuse_unsayable(system, connections)
    shapes = {name: shapes_of(system, part, version) for name, part in system.parts.items()}
    for component, output in (connection.source for connection in connections):
        if output in shapes[component].unsaid:
            raise InputError(
                f"{component}.{output} is a local variable, from which version {version} of SSP "
                "has no connections; write version 2.0"
            )
    connections += system.initial
    top = (flat if in_one else nested)(system, connections)
    notes = _beyond_version_1(system) if version == "1.0" else []
    files: dict[str, bytes] = {}
    for name, part in top.parts():
        values = {variable: given.value for variable, given in part.given.items()}
        files[f"resources/{name}.fmu"] = _fmu(system, part, values, notes)
        if values:
            to_write = _written(part, values, shapes[part.name])
            files[f"resources/{name}.ssv"] = as_xml(parameter_set(name, to_write, version))
    describer = Describer(system, connections, shapes)
    files[SSP_FILE] = as_xml(describer.document(top, experiment, version))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_named(path, zipped(files))
    return [*notes, *describer.notes, *unsaid(system)]


def _written(part: Part, values: Mapping[str, Value], shapes: Shapes) -> dict[str, Written]:
    """Return the values of a component as its parameter set has them; arrays are whole."""
    found: dict[str, Written] = {}
    variables = part.instance.variables
    for name in values:
        whole, indices = shapes.connector(name)
        if indices is None:
            found[whole] = Written(*shapes.written(variables[name], [values[name]]))
        elif whole not in found:
            elements = [variables[one] for one in variables if shapes.connector(one)[0] == whole]
            listed = [values.get(one.name, one.first) for one in elements]
            kind, texts = shapes.written(variables[name], listed)
            found[whole] = Written(kind, texts, shapes.sizes[whole])
    return found


def _refuse_unsayable(system: System, connections: Sequence[Connection]) -> None:
    for name, part in system.parts.items():
        if part.is_sum:
            raise InputError(f"{name} is a {part.fmu}, which SSP does not have")
    for connection in connections:
        refuse_made(system, connection)
        target = system.parts[connection.target[0]].instance.variables[connection.target[1]]
        if target.causality == "parameter":
            raise InputError(
                f"{'.'.join(connection.source)} feeds the parameter "
                f"{'.'.join(connection.target)}, for which SSP has no connection"
            )


def refuse_made(system: System, connection: Connection) -> None:
    """Raise InputError for a connection of a port that other tools do not find in the FMU."""
    for name, port in (connection.source, connection.target):
        if system.parts[name].instance.variables[port].is_made:
            raise InputError(
                f"{name}.{port} is a port that seatrial makes of a bus terminal: other tools "
                "connect the terminal's data and clocks"
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


def _beyond_version_1(system: System) -> list[str]:
    """Return what only version 2.0 says better. Raises InputError for what only that can say."""
    notes = []
    for name, part in system.parts.items():
        if any(shapes_of(system, part, "2.0").arrays):
            notes.append(
                f"{name}: SSP 1.0 has no arrays: their elements, x[1], stand as connectors; "
                "write version 2.0"
            )
        for variable, given in part.given.items():
            if type(given.value) is int and not -(2**31) <= given.value < 2**31:
                raise InputError(
                    f"{name}.{variable} = {given.value}: integers of SSP 1.0 have 32 bits; "
                    "write version 2.0"
                )
    return notes


def unsaid(system: System, sayable: Collection[str] = ("plain-jacobi",)) -> list[str]:
    """Return what packages of other tools cannot say of a rig; ``sayable`` are algorithms."""
    notes = []
    file = system.rig.file
    if file.algorithm not in sayable:
        notes.append(
            f"the algorithm {file.algorithm!r} cannot be said: other tools couple by plain Jacobi, "
            "one step of delay per connection"
        )
    if any(placed.entry.isolated for placed in system.rig.components.values()):
        notes.append("isolated = true cannot be said: other tools choose their processes")
    if system.tunings:
        links = " and ".join(tuning.link for tuning in system.tunings)
        notes.append(
            f"tunables of {links} cannot be said: the parameters that they set stay at their start"
        )
    return notes
