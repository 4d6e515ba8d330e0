"""FMI 1.0, 2.0 and 3.0 FMUs loaded: unpacked once, described, and instantiated."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any

from fmpy.model_description import ModelDescription, ValidationError, read_model_description

from ..errors import InputError
from .archive import content_hash, unpacked
from .fmi1 import Fmi1Slave
from .fmi1model import Fmi1Model
from .fmi2 import Fmi2Slave
from .fmi2model import Fmi2Model
from .fmi3model import Fmi3Model
from .fmi3slave import Fmi3Slave
from .instance import Instance
from .loaded import LoadedFmu
from .options import DEFAULTS, FmuOptions, Interface
from .osp import read_osp
from .terminals import read_terminals
from .variables import described, views_of
from .xmlfile import read_xml

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
    others = _names(fmu.description)
    groups = read_osp(fmu.path, fmu.description.modelName or "", fmu.variables, others)
    return replace(fmu, terminals=groups) if groups else fmu


def _near(path: Path) -> str:
    """Return FMUs beside ``path`` that are called much like it, for a message."""
    beside = [one.name for one in path.parent.glob("*.fmu")]
    near = get_close_matches(path.name, beside, n=2, cutoff=0.8)
    return f"; did you mean {' or '.join(map(repr, near))}?" if near else ""


def open_instance(fmu: LoadedFmu, name: str) -> Instance:
    """Return a new instance of ``fmu``, called ``name`` in the rig.

    Raises InputError if it has no binary that this machine can load, and SimulationError if
    it cannot be instantiated.
    """
    return _INSTANCES[fmu.version, fmu.interface](fmu, name)


def _with_options(fmu: LoadedFmu, options: FmuOptions) -> LoadedFmu:
    """Return the FMU to be used as ``options`` say; sizes of arrays follow them."""
    if options.interface and options.interface not in fmu.interfaces:
        raise InputError(
            f"{fmu.path.name} has no {options.interface}, only {' and '.join(fmu.interfaces)}"
        )
    chosen = replace(fmu, options=options)
    if options.tolerance is not None and chosen.interface != "model exchange":
        raise InputError(
            f"{fmu.path.name}: a tolerance has no effect in co-simulation, only with "
            'interface = "model exchange"'
        )
    if not options.structure:
        return chosen
    try:
        content = described(fmu.description, fmu.root, options.structure)
    except InputError as error:
        raise InputError(f"{fmu.path}: {error}") from None
    names = _names(fmu.description)
    return replace(
        chosen,
        variables=content.variables,
        arrays=content.arrays,
        feedthrough=content.feedthrough,
        terminals=read_terminals(fmu.folder, fmu.path, content.variables, names),
    )


@lru_cache(maxsize=256)
def _load(path: Path, _stamp: tuple[int, int]) -> LoadedFmu:
    sha256 = content_hash(path)
    folder = unpacked(path, "FMU")
    file = folder / "modelDescription.xml"
    root = read_xml(file, f"{path}: modelDescription.xml")
    _refuse_other_kinds(path, root)
    try:
        # The file, not the folder: FMPy would read other files there too.
        description = read_model_description(str(file), validate=False)
        content = described(description, root)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except Exception as error:  # whatever FMPy meets in a description that is no valid one
        why = _problems(file) or f"{type(error).__name__}: {error}"
        raise InputError(f"{path}: cannot read its model description: {why}") from None
    for interface in (description.coSimulation, description.modelExchange):
        if interface is not None:
            _refuse_identifier(path, interface.modelIdentifier)
    return LoadedFmu(
        path,
        folder,
        sha256,
        description,
        root,
        content.variables,
        content.arrays,
        content.feedthrough,
        read_terminals(folder, path, content.variables, _names(description)),
        views_of(root),
        content.notes,
    )


def _names(description: ModelDescription) -> set[str]:
    return {v.name for v in description.modelVariables}


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
    if root.find("ModelVariables") is None:
        raise InputError(f"{path}: modelDescription.xml: has no ModelVariables")


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
