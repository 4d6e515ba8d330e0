"""Signals that move the parts of a rig's vehicles, found through the connections."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...errors import InputError, unknown
from ..part import Part
from ..shape import FORMATS, mesh_file, written
from ..system import System

MESHES = "meshes"
"""Folder of a run that has the files its vehicles' shapes show."""


def resolve_shapes(system: System) -> None:
    """Give every part of a system that has a shape what manifests say of it.

    A port is one of the component itself, or ``TABLE.port`` of the component with that table of
    the same vehicle in the same rig. What stands for it is a signal, of which ``factor`` times
    the value plus ``offset`` is the port's; an input has that of the output that feeds it. What
    is not in the rig, or not fed, moves nothing. Raises InputError for a port that there is not,
    and for a mesh that cannot be read.
    """
    for part in system.parts.values():
        if part.shape is None:
            continue
        if "motion" not in part.instance.terminals:
            part.shape = None  # a law that has the same parameters is no body
            continue
        content = written(part.shape.parts)
        for number, entry in enumerate(content):
            where = f"{part.shape.path}: shape.{part.shape.table}.{number}"
            if "file" in entry:
                path, sha256 = mesh_file(entry["file"], part.shape.path.parent, f"{where}.file")
                entry["file"], entry["sha256"] = path.name, sha256
                part.meshes[mesh_name(path.name, sha256)] = path
            for kind in ("turn", "stretch", "slide"):
                if kind in entry:
                    found = _signal(system, part, entry[kind].pop("port"), f"{where}.{kind}.port")
                    if found is None:
                        del entry[kind]
                    else:
                        entry[kind].update(found)
        part.drawn = content


def mesh_name(file: str, sha256: str) -> str:
    """Return the name of a mesh in a run's folder."""
    suffix = Path(file).suffix.lower()
    return f"{sha256[:16]}{suffix if suffix in FORMATS else ''}"


def _signal(system: System, body: Part, written: str, where: str) -> dict[str, Any] | None:
    """Return the signal of a port, its factor and its offset; None if nothing feeds it."""
    part, port = body, written
    assert body.shape is not None
    table, dot, rest = written.partition(".")
    if dot and table in body.shape.tables:
        sibling = _sibling(system, body, table)
        if sibling is None:
            return None
        part, port = sibling, rest
    variable = part.instance.variables.get(port)
    if variable is None or variable.causality not in ("input", "output"):
        known = [v.name for v in part.instance.variables.values() if v.causality != "parameter"]
        raise InputError(f"{where}: {unknown('port', port, [*known, *body.shape.tables])}")
    if variable.causality == "output":
        return {"signal": f"{part.name}.{port}"}
    for connection in system.connections:
        if connection.target == (part.name, port):
            source = ".".join(connection.source)
            return {"signal": source, "gain": connection.factor, "offset": connection.offset}
    return None


def _sibling(system: System, body: Part, table: str) -> Part | None:
    """Return the first component with a table of the same vehicle beside a body, if any."""
    scope = body.name.rpartition(".")[0]
    assert body.vehicle is not None
    wanted = (body.vehicle[0], table)
    for name, part in system.parts.items():
        if part.vehicle == wanted and name.rpartition(".")[0] == scope:
            return part
    return None
