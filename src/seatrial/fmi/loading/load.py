"""FMI 1.0, 2.0 and 3.0 FMUs loaded: unpacked once, described, and instantiated."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any

from fmpy.model_description import ValidationError, read_model_description

from ...errors import InputError
from ..files.archive import content_hash, unpacked
from ..files.lsbus import port_terminals, read_buses, with_ports, without_own
from ..files.modelfile import read_model
from ..files.options import DEFAULTS, FmuOptions, Interface
from ..files.osp import read_osp
from ..files.terminals import read_terminals
from ..files.variables import described, views_of
from ..instance import Instance
from ..interfaces.fmi1 import Fmi1Model, Fmi1Slave
from ..interfaces.fmi2 import Fmi2Model, Fmi2Slave
from ..interfaces.fmi3 import Fmi3Model
from ..interfaces.fmi3clocks import Fmi3ClockedSlave
from ..interfaces.fmi3slave import Fmi3Slave
from ..interfaces.loaded import LoadedFmu
from .built import with_library

_NEEDED = "co-simulation or model exchange of FMI 1.0, 2.0 or 3.0 is needed"
_INTERFACES = {
    "CoSimulation": "co-simulation",
    "ModelExchange": "model exchange",
    "ScheduledExecution": "scheduled execution",
}
_INSTANCES: dict[tuple[int, Interface], Callable[[LoadedFmu, str], Instance]] = {
    (1, "co-simulation"): Fmi1Slave,
    (2, "co-simulation"): Fmi2Slave,
    (3, "co-simulation"): Fmi3Slave,
    (1, "model exchange"): Fmi1Model,
    (2, "model exchange"): Fmi2Model,
    (3, "model exchange"): Fmi3Model,
}
_MOST_PROBLEMS = 3


def load_fmu(path: Path, options: FmuOptions = DEFAULTS) -> LoadedFmu:
    """Unpack and read the FMU at ``path``, to be used as ``options`` say.

    Its terminals are those inside; if there are none, the variable groups in the
    OspModelDescription.xml beside it.

    Raises InputError if it has no interface that is used here, or is damaged, for a mistake in a
    file of terminals, and for options that do not fit the FMU.
    """
    try:
        status = path.stat()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}{_near(path)}") from None
    fmu = _load(path.resolve(), (status.st_mtime_ns, status.st_size))
    if options != DEFAULTS:
        fmu = _with_options(fmu, options)
    if fmu.terminals:
        return fmu
    groups = read_osp(fmu.path, fmu.description.modelName or "", fmu.variables, fmu.others)
    return replace(fmu, terminals=groups) if groups else fmu


def _near(path: Path) -> str:
    """Return FMUs beside ``path`` that are called much like it, for a message."""
    beside = [one.name for one in path.parent.glob("*.fmu")]
    near = get_close_matches(path.name, beside, n=2, cutoff=0.8)
    return f"; did you mean {' or '.join(map(repr, near))}?" if near else ""


def open_instance(fmu: LoadedFmu, name: str) -> Instance:
    """Return a new instance of ``fmu``, called ``name`` in the rig.

    A source FMU is built first. Raises InputError if it has no binary that this machine can load,
    or sources that cannot be built, and SimulationError if it cannot be instantiated.
    """
    fmu = with_library(fmu)
    if fmu.clocks.by_reference:
        return Fmi3ClockedSlave(fmu, name)
    return _INSTANCES[fmu.version, fmu.interface](fmu, name)


def _with_options(fmu: LoadedFmu, options: FmuOptions) -> LoadedFmu:
    """Return the FMU to be used as ``options`` say; sizes of arrays follow them."""
    if options.interface and options.interface not in fmu.interfaces:
        raise InputError(
            f"{fmu.path.name} has no {options.interface}, only {' and '.join(fmu.interfaces)}"
        )
    chosen = replace(fmu, options=options)
    if options.tolerance is not None and not fmu.takes_tolerance(options.interface):
        raise InputError(
            f"{fmu.path.name}: co-simulation of FMI 1.0 has no tolerance; that of later "
            "versions has, and model exchange"
        )
    if not (options.structure or options.locals or fmu.clocks.by_reference):
        return chosen
    return _with_content(chosen)


def _with_content(fmu: LoadedFmu) -> LoadedFmu:
    """Return the FMU with all that its files say of signals, used as its options say."""
    try:
        content = described(fmu.model, fmu.description, fmu.options)
    except InputError as error:
        raise InputError(f"{fmu.path}: {error}") from None
    usable = without_own(fmu.folder, fmu.model, content.variables, content.clocks)
    buses, notes = read_buses(fmu.folder, fmu.model, *usable)
    variables, clocks = with_ports(buses, *usable)
    others = content.others | (content.variables.keys() - variables.keys())
    terminals = read_terminals(fmu.folder, fmu.path, variables, others)
    return replace(
        fmu,
        variables=variables,
        arrays=content.arrays,
        feedthrough=content.feedthrough,
        others=others,
        terminals={**terminals, **port_terminals(buses)},
        notes=(*content.notes, *notes),
        clocks=clocks,
        buses=buses,
    )


@lru_cache(maxsize=256)
def _load(path: Path, _stamp: tuple[int, int]) -> LoadedFmu:
    sha256 = content_hash(path)
    folder = unpacked(path, "FMU")
    file = folder / "modelDescription.xml"
    called = f"{path}: modelDescription.xml"
    try:
        model = read_model(file, called)
    except ValueError as error:
        raise InputError(f"{called}: ModelStructure: {error}") from None
    _refuse_other_kinds(path, model.root)
    try:
        description = model.header()
        empty = LoadedFmu(path, folder, sha256, description, model, views_of(model.root))
        fmu = _with_content(empty)
    except InputError:
        raise
    except Exception as error:  # whatever FMPy meets in a description that is no valid one
        why = _problems(file) or f"{type(error).__name__}: {error}"
        raise InputError(f"{path}: cannot read its model description: {why}") from None
    for interface in (description.coSimulation, description.modelExchange):
        if interface is not None:
            _refuse_identifier(path, interface.modelIdentifier)
    return fmu


def _refuse_other_kinds(path: Path, root: Any) -> None:
    """Raise InputError for what has neither co-simulation nor model exchange."""
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        raise InputError(
            f"{path}: modelDescription.xml: an element fmiModelDescription with an fmiVersion is "
            f"needed, found {root.tag} with fmiVersion {version!r}"
        )
    kinds = [text for tag, text in _INTERFACES.items() if root.find(tag) is not None]
    known = version in ("1.0", "2.0") or re.fullmatch(r"3\.\d+(\.\d+)?", version)
    if not known or (version != "1.0" and not {"co-simulation", "model exchange"} & set(kinds)):
        raise InputError(f"{path}: FMI {version}, {' and '.join(kinds) or 'nothing'}; {_NEEDED}")
    variables = root.find("ModelVariables")
    if variables is None:
        raise InputError(f"{path}: modelDescription.xml: has no ModelVariables")
    for other in variables.iterchildren("*"):
        raise InputError(
            f"{path}: modelDescription.xml: {other.tag} (line {other.sourceline}) is no variable"
        )


def _refuse_identifier(path: Path, identifier: str | None) -> None:
    """Raise InputError for a modelIdentifier that would lead out of the FMU's folder."""
    if not identifier or identifier in (".", "..") or re.search(r"[/\\:\0]", identifier):
        raise InputError(
            f"{path}: modelIdentifier {identifier!r} is not the name of a file in the FMU"
        )


def _problems(file: Path) -> str:
    """Return what FMPy's checker finds in a model description, empty if it cannot say."""
    try:
        read_model_description(str(file), validate=True)
    except ValidationError as error:
        return "; ".join(str(problem) for problem in error.problems[:_MOST_PROBLEMS])
    except Exception:
        pass
    return ""
