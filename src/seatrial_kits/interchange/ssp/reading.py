"""SSP packages as rigs."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.fmi.files.archive import content_hash
from seatrial.model.component import NS, seconds
from seatrial.model.ports import Scalar
from seatrial.system.files import Source
from seatrial.system.flattening import rig_of
from seatrial.system.packages import PackagedSystem
from seatrial.system.paths import joined
from seatrial.system.references.values import storable

from .flat import Flat, FlatConnection
from .graph import Node, Path_
from .layout import unused
from .leaf import Leaf
from .model import Structure
from .notes import Notes
from .package import open_package
from .structure import read_structure

_USUAL_STEP = "10 ms"


def read_ssp(path: Path, step: Any = None, *, strict: bool = False) -> PackagedSystem:
    """Read the SSP package at ``path``, version 1.0 or 2.0: an archive, a folder or its .ssd.

    ``step`` is a communication step that replaces the package's. Raises InputError naming file
    and line for what is wrong, and for what could change the result and is not supported; if
    ``strict``, for all that is not used.
    """
    notes = Notes(strict)
    package = open_package(path, path.name, notes)
    folder = package.folder
    structure = read_structure(package.description, package, notes)
    flat = Flat.of(structure, package, notes)
    if not flat.leaves:
        raise InputError(f"{path}: {package.description.name} has no component")
    names = _names(flat, notes)
    connections = flat.connections()
    components = _components(flat, folder, names, connections, notes)
    content = {
        "title": structure.name,
        "step": step or _step(structure, list(flat.leaves.values()), notes),
        "components": components[()],
        "connections": _connections(connections, names),
    }
    inside = {names[place]: {"components": listed} for place, listed in components.items()}
    rig = rig_of(
        content,
        Source(path.stem, path, content_hash(package.description if package.loose else path)),
        folder,
        inside,
    )
    start = None if structure.start is None else f"{structure.start!r} s"
    stop = None if structure.stop is None else f"{structure.stop!r} s"
    return PackagedSystem(structure.name, rig, start, stop, notes.texts)


def _names(flat: Flat, notes: Notes) -> dict[Path_, str]:
    """Return the paths of systems and components in the rig: identifiers, joined by dots."""
    names: dict[Path_, str] = {(): ""}
    for place, elements in flat.elements.items():
        taken: set[str] = set()
        for element in elements:
            name = unused(element, taken)
            taken.add(name)
            inside = (*place, element)
            names[inside] = joined(names[place], name)
            if element != name:
                notes.add(f"{'.'.join(inside)} is called {names[inside]} here")
    return names


def _components(
    flat: Flat,
    folder: Path,
    names: dict[Path_, str],
    connections: list[FlatConnection],
    notes: Notes,
) -> dict[Path_, dict[str, Any]]:
    """Return the components of every system, as the file of a rig would have them."""
    fed = {connection.target for connection in connections}
    found: dict[Path_, dict[str, Any]] = {}
    for place, elements in flat.elements.items():
        found[place] = listed = {}
        for path in ((*place, element) for element in elements):
            leaf = flat.leaves.get(path)
            entry = {"rig": names[path]} if leaf is None else _component(leaf, folder, fed, notes)
            listed[names[path].rpartition(".")[2]] = entry
    return found


def _component(leaf: Leaf, folder: Path, fed: set[Node], notes: Notes) -> dict[str, Any]:
    values: dict[str, Scalar] = {}
    for variable, (value, where) in leaf.values.items():
        if (leaf.path, variable) in fed:
            notes.add(f"{where}: {variable!r} is fed by a connection; its start value is not used")
        else:
            values[variable] = storable(value)
    entry: dict[str, Any] = {"fmu": os.path.relpath(leaf.fmu.path, folder), "set": values}
    if leaf.fmu.options.interface is not None:
        entry["interface"] = leaf.fmu.options.interface
    if leaf.locals:
        entry["locals"] = list(leaf.locals)
    if leaf.isolated:
        entry["isolated"] = True
    if leaf.step is not None:
        entry["step"] = f"{leaf.step!r} s"
    return entry


def _connections(flat: list[FlatConnection], names: dict[Path_, str]) -> dict[str, Any]:
    connections: dict[str, Any] = {}
    for connection in flat:
        (source, output), (target, variable) = connection.source, connection.target
        entry = {
            "to": f"{names[target]}.{variable}",
            "factor": connection.way.factor,
            "offset": connection.way.offset,
            "mapping": [[one, other] for one, other in connection.way.table.items()],
            "convert": False,  # what units need is in factor and offset already
        }
        connections.setdefault(f"{names[source]}.{output}", []).append(entry)
    return connections


def _step(structure: Structure, leaves: list[Leaf], notes: Notes) -> str:
    """Return the communication step: OSP's, OMSimulator's, the components', or a usual one."""
    steps = structure.steps
    hints = [round(leaf.step * NS) for leaf in leaves if leaf.step is not None]
    if steps.osp is not None:
        if steps.oms not in (None, steps.osp):
            notes.add(
                f"OMSimulator's step of {steps.oms!r} s is not used: OSP's is {steps.osp!r} s"
            )
        return f"{steps.osp!r} s"
    if steps.oms is not None:
        return f"{steps.oms!r} s"
    if hints and all(hints):
        step = seconds(math.gcd(*hints))
        notes.add(f"the components' step size hints give a communication step of {step!r} s")
        return f"{step!r} s"
    notes.add(f"the package names no step size: {_USUAL_STEP} is taken; change it with --set step")
    return _USUAL_STEP
