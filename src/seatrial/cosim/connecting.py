"""Connections of a rig: from ports as written to scalars, with units converted."""

from __future__ import annotations

from collections.abc import Iterator

from ..errors import InputError, unknown
from ..fmi.instance import Variable, Variables
from ..units import conversion
from .rig import ConnectionEntry
from .system import Connection, System
from .values import port_names, port_scalars


def connect(system: System) -> list[Connection]:
    """Return the connections of a system's rig, scalar by scalar. Raises InputError."""
    connections: list[Connection] = []
    feeders: dict[tuple[str, str], str] = {}
    for written, entry in system.rig.connections():
        where = f'{system.rig.read_from.path}: connections."{written}"'
        for connection in _between(system, written, entry, where):
            target = connection.target
            if target in feeders:
                raise InputError(
                    f"{where}: {'.'.join(target)} is already fed by {feeders[target]}; "
                    "an input takes one connection"
                )
            feeders[target] = written
            connections.append(connection)
    return connections


def _between(
    system: System, written: str, entry: ConnectionEntry, where: str
) -> Iterator[Connection]:
    """Yield the connections between two ports, or two scalars, as written."""
    sources = _end(system, written, ("output",), where)
    targets = _end(system, entry.to, ("input", "tunable parameter"), where)
    if len(sources) != len(targets):
        raise InputError(
            f"{where}: {written} has {len(sources)} scalars, {entry.to} has {len(targets)}"
        )
    from_, to = (end.partition(".")[0] for end in (written, entry.to))
    for source, target in zip(sources, targets, strict=True):
        factor, offset = _transformed(*_converting(source, target, entry, where), entry)
        if (factor, offset) != (1.0, 0.0) and target.type is not float:
            raise InputError(f"{where}: {entry.to} is no real number to transform")
        to_real = (source.type, target.type) == (int, float)
        yield Connection((from_, source.name), (to, target.name), factor, offset, to_real)


def _end(system: System, written: str, wanted: tuple[str, ...], where: str) -> list[Variable]:
    """Return the scalars at one end of a connection, which must be of a wanted kind."""
    name, _, port = written.partition(".")
    if name not in system.parts:
        raise InputError(f"{where}: {unknown('component', name, system.parts)}")
    variables = system.parts[name].instance.variables
    scalars, needed = port_scalars(variables, port), " or ".join(wanted)
    if not scalars:
        fitting = Variables({n: v for n, v in variables.items() if _kind(v) in wanted})
        raise InputError(f"{where}: {name}: {unknown(needed, port, port_names(fitting))}")
    for variable in scalars:
        if _kind(variable) not in wanted:
            raise InputError(f"{where}: {written} is {_kind(variable)}, {needed} is needed")
    return scalars


def _kind(variable: Variable) -> str:
    """Return a variable's causality; of a parameter, its variability too."""
    if variable.causality != "parameter":
        return variable.causality
    return f"{variable.variability} parameter"


def _transformed(factor: float, offset: float, entry: ConnectionEntry) -> tuple[float, float]:
    """Return a conversion of units followed by a connection's own linear transformation."""
    if (entry.factor, entry.offset) == (1.0, 0.0):
        return factor, offset
    return entry.factor * factor, entry.factor * offset + entry.offset


def _converting(
    source: Variable, target: Variable, entry: ConnectionEntry, where: str
) -> tuple[float, float]:
    """Return the factor and offset between two ends; raise InputError if they do not fit."""
    if source.type is not target.type and (source.type, target.type) != (int, float):
        raise InputError(
            f"{where}: {source.name} is {source.type.__name__}, "
            f"{target.name} is {target.type.__name__}"
        )
    if not (entry.convert and source.unit and target.unit and target.type is float):
        return 1.0, 0.0
    try:
        return conversion(source.measure, target.measure)
    except InputError as error:
        raise InputError(f"{where}: {source.name} to {target.name}: {error}") from None
