"""Assembled rigs as SSP 1.0 packages, in the subset that other tools read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ...errors import InputError
from ...fmi.cache import write_named
from ...fmi.export import fmu_bytes, zipped
from ...fmi.source import find_source
from ..part import Part
from ..system import Connection, System
from .describing import Describer, Experiment, as_xml
from .layout import flat, nested
from .package import DEFAULT
from .parameters import Value, parameter_set


def write_ssp(
    system: System, experiment: Experiment, path: Path, *, in_one: bool = False
) -> list[str]:
    """Write ``system`` as an SSP package and return what other tools must know of it.

    A rig inside a rig is a system inside a system; ``in_one`` puts all components into one.
    Every value set is in a parameter set of its component and, where the FMU is built here,
    its start value too. The same input gives the same bytes. Raises InputError for what SSP
    cannot hold; nothing is written then.
    """
    tuned = system.tuned
    connections = [one for one in system.connections if one.target not in tuned]
    _refuse_fed_parameters(system, connections)
    top = (flat if in_one else nested)(system, connections)
    notes: list[str] = []
    files: dict[str, bytes] = {}
    for name, part in top.parts():
        values = {variable: given.value for variable, given in part.given.items()}
        files[f"resources/{name}.fmu"] = _fmu(system, part, values, notes)
        if values:
            files[f"resources/{name}.ssv"] = as_xml(parameter_set(name, values))
    describer = Describer(system, connections)
    files[DEFAULT] = as_xml(describer.document(top, experiment))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_named(path, zipped(files))
    return [*notes, *describer.notes, *_unsaid(system)]


def _refuse_fed_parameters(system: System, connections: Sequence[Connection]) -> None:
    for connection in connections:
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
    if system.tunings:
        links = " and ".join(tuning.link for tuning in system.tunings)
        notes.append(
            f"tunables of {links} cannot be said: the parameters that they set stay at their start"
        )
    return notes
