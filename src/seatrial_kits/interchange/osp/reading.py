"""System structures of OSP-IS as rigs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.fmi.files.archive import content_hash
from seatrial.fmi.interfaces.loaded import LoadedFmu
from seatrial.fmi.loading.load import load_fmu
from seatrial.model.component import NS
from seatrial.model.units import conversion
from seatrial.system.files import Source
from seatrial.system.flattening import rig_of
from seatrial.system.packages import OSP_FILE, PackagedSystem
from seatrial.system.rig import duration_ns

from ..ssp.layout import unused
from .ecco import bonds_as_written, read_settings
from .joining import Joining, Link
from .structure import Simulator, Structure, Sum, read_structure

_USUAL_STEP = 0.1
"""Of libcosim, s."""


def read_osp(path: Path, step: Any = None) -> PackagedSystem:
    """Read the OspSystemStructure.xml at ``path``, or in the folder ``path``.

    ``step`` replaces the file's. Raises InputError naming file and line for what is wrong.
    """
    file = path / OSP_FILE if path.is_dir() else path
    structure = read_structure(file)
    title = file.parent.name if file.name == OSP_FILE else file.stem
    notes: list[str] = []
    fmus = {name: _fmu(simulator) for name, simulator in structure.simulators.items()}
    joining = Joining(structure, fmus, file.parent)
    links = joining.links()
    names = _names(structure, notes)
    coupling = _coupling(file, structure, notes)
    step_ns = _step_ns(structure, coupling.get("ecco"), step, notes)
    every = {
        name: 1 if "ecco" in coupling else _every(name, simulator, step_ns, notes)
        for name, simulator in structure.simulators.items()
    }
    content = {
        "title": title,
        "step": f"{step_ns / NS!r} s",
        **coupling,
        "bonds": bonds_as_written(joining.bonds(), names),
        "components": {
            **{
                names[name]: {
                    "fmu": os.path.relpath(fmus[name].path, file.parent),
                    "set": _values(name, simulator, fmus[name], links, notes),
                    **({"isolated": True} if simulator.isolated else {}),
                    **({"step": f"{every[name] * step_ns / NS!r} s"} if every[name] > 1 else {}),
                }
                for name, simulator in structure.simulators.items()
            },
            **{
                names[name]: {"sum": {"inputs": function.inputs, "dimension": function.dimension}}
                for name, function in structure.functions.items()
                if isinstance(function, Sum)
            },
        },
        "connections": _connections(links, names),
    }
    notes += _differing_units(links, fmus) + _unlike_steps(links, every)
    rig = rig_of(content, Source(title, file, content_hash(file)), file.parent)
    return PackagedSystem(
        title, rig, _time(structure.start), _time(structure.stop), tuple(notes), names
    )


def _fmu(simulator: Simulator) -> LoadedFmu:
    try:
        return load_fmu(simulator.source)
    except InputError as error:
        raise InputError(f"{simulator.where}: {error}") from None


def _names(structure: Structure, notes: list[str]) -> dict[str, str]:
    """Return the components' names, identifiers, by those of simulators and functions."""
    names: dict[str, str] = {}
    sums = [name for name, one in structure.functions.items() if isinstance(one, Sum)]
    for name in [*structure.simulators, *sums]:
        names[name] = unused(name, set(names.values()))
        if names[name] != name:
            notes.append(f"{name!r} is called {names[name]} here")
    return names


def _time(value: float | None) -> str | None:
    return None if value is None else f"{value!r} s"


def _coupling(file: Path, structure: Structure, notes: list[str]) -> dict[str, Any]:
    """Return the algorithm of a rig, with its settings."""
    if structure.algorithm != "ecco":
        return {"algorithm": "plain-jacobi"}  # libcosim's fixedStep
    if structure.ecco is None:
        raise InputError(f"{file}: the algorithm ecco needs an EccoConfiguration")
    stepping = [name for name, one in structure.simulators.items() if one.step is not None]
    if stepping:
        notes.append(f"stepSize of {', '.join(stepping)} has no effect with ecco, as in libcosim")
    return {"algorithm": "ecco", "ecco": read_settings(structure.ecco)}


def _step_ns(
    structure: Structure, ecco: Mapping[str, Any] | None, step: Any, notes: list[str]
) -> int:
    if step is not None:
        step_ns = duration_ns(step, "step") if isinstance(step, str) else 0
        if step_ns <= 0:
            raise InputError(f"step: a duration such as '10 ms' is needed, found {step!r}")
        return step_ns
    if ecco is not None:
        notes.append(
            "BaseStepSize has no effect with ecco, as in libcosim: communication points, with rows "
            f"and events, are MaximumStepSize apart ({ecco['max_step']}), ecco's steps in between"
        )
        return duration_ns(ecco["max_step"], "MaximumStepSize")
    written = structure.step
    if written is None:
        notes.append(f"there is no BaseStepSize: {_USUAL_STEP} s is taken, as libcosim does")
        written = _USUAL_STEP
    return max(1, round(written * NS))


def _every(name: str, simulator: Simulator, step_ns: int, notes: list[str]) -> int:
    """Return how many communication steps a simulator's own step takes, as libcosim rounds it."""
    if simulator.step is None:
        return 1
    every, rest = divmod(round(simulator.step * NS), step_ns)
    if rest or not every:
        every = max(1, every)
        notes.append(
            f"{simulator.where}: its step of {simulator.step!r} s is no multiple of the base step; "
            f"it steps by {every * step_ns / NS!r} s, as in libcosim"
        )
    return every


def _values(
    name: str, simulator: Simulator, fmu: LoadedFmu, links: list[Link], notes: list[str]
) -> dict[str, Any]:
    fed = {link.target.name for link in links if link.target.owner == name}
    found: dict[str, Any] = {}
    for variable, initial in simulator.values.items():
        if variable in fed:
            notes.append(
                f"{initial.where}: {name}.{variable} is fed by a connection; its initial value is "
                "not used"
            )
            continue
        known = fmu.variables.get(variable)
        if known is not None and type(initial.value) is not known.type:
            raise InputError(
                f"{initial.where}: {variable!r} is of type {known.type.__name__}, "
                f"found {initial.value!r}"
            )
        found[variable] = initial.value
    return found


def _connections(links: list[Link], names: Mapping[str, str]) -> dict[str, Any]:
    connections: dict[str, Any] = {}
    for link in links:
        entry = {
            "to": f"{names[link.target.owner]}.{link.target.name}",
            "factor": link.factor,
            "offset": link.offset,
            "convert": False,  # libcosim converts no units
        }
        source = f"{names[link.source.owner]}.{link.source.name}"
        connections.setdefault(source, []).append(entry)
    return connections


def _differing_units(links: list[Link], fmus: Mapping[str, LoadedFmu]) -> list[str]:
    """Return notes on plain connections between units that are not the same."""
    notes = []
    for link in links:
        if link.source.owner not in fmus or link.target.owner not in fmus:
            continue
        source = fmus[link.source.owner].variables[link.source.name]
        target = fmus[link.target.owner].variables[link.target.name]
        if (link.factor, link.offset) != (1.0, 0.0) or not (source.unit and target.unit):
            continue
        try:
            alike = conversion(source.measure, target.measure) == (1.0, 0.0)
        except InputError:
            alike = source.unit == target.unit
        if not alike:
            notes.append(
                f"{link.where}: {source.name} is in {source.unit}, {target.name} in "
                f"{target.unit}; nothing is converted, as in libcosim"
            )
    return notes


def _unlike_steps(links: list[Link], every: Mapping[str, int]) -> list[str]:
    """Return notes on connections whose ends step at times that libcosim treats otherwise."""
    notes = []
    for link in links:
        one, other = (every.get(end.owner, 1) for end in (link.source, link.target))
        if max(one, other) % min(one, other):
            notes.append(
                f"{link.where}: steps of {one} and {other} base steps: libcosim moves values where "
                "both end, here an input has the newest"
            )
    return notes
