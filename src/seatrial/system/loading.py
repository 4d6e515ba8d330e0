"""Components of a rig as instances: in this process or isolated, from Python or an FMU."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..fmi.building.bundle_name import bundle_name
from ..fmi.components.source import find_source
from ..fmi.dependencies.checked import checked
from ..fmi.direct import DirectInstance
from ..fmi.files.options import FmuOptions
from ..fmi.instance import Instance
from ..model.component import seconds
from .part import Part
from .references.values import from_written
from .rig import ComponentEntry, Rig, Scope, duration_ns
from .sums import SumInstance
from .system import Engine

if TYPE_CHECKING:
    from ..fmi.interfaces.loaded import LoadedFmu

_TIMEOUT_S = 60.0
"""Longest wall time of a call of an isolated component, where the rig says nothing else."""

_ONCE: set[str] = set()
"""Hashes of FMUs that allow one instance for each process, and have had theirs in this one.

Their libraries stay loaded, with what a run has left in them.
"""


def load_part(rig: Rig, name: str, engine: Engine) -> Part:
    """Return the component ``name`` of a rig, with nothing given yet. Raises InputError."""
    placed = rig.components[name]
    entry, where, every = placed.entry, placed.where, 1
    if entry.sum is not None:
        adding = SumInstance(name, entry.sum.inputs, entry.sum.dimension)
        return Part(name, entry.what, adding, sha256="", code="", every=1, is_sum=True)
    stepped = placed.scope.step if entry.step is None else (entry.step, f"{where}.step")
    if stepped is not None:
        written, place = stepped
        every, rest = divmod(duration_ns(written, place), rig.step_ns)
        if every < 1 or rest:
            raise InputError(
                f"{place}: {written!r} is not a multiple of the rig's {rig.file.step!r}"
            )
    timeout_s = _timeout_s(entry, f"{where}.timeout")
    try:
        return _part(entry, name, placed.scope, engine, timeout_s, every)
    except InputError as error:
        raise InputError(f"{where}.fmu: {error}") from None


def _timeout_s(entry: ComponentEntry, where: str) -> float:
    """Return the longest wall time of one call of a component, if it is isolated."""
    if entry.timeout is None:
        return _TIMEOUT_S
    timeout_ns = duration_ns(entry.timeout, where)
    if timeout_ns <= 0:
        raise InputError(f"{where}: must be positive, found {entry.timeout!r}")
    return seconds(timeout_ns)


def _options(entry: ComponentEntry, loaded: LoadedFmu, tolerance: float | None) -> FmuOptions:
    """Return how a rig uses an FMU; structural parameters are set before anything has a size."""
    structure = {}
    for name, written in entry.set.items():
        variable = loaded.variables.get(name)
        if variable is not None and variable.causality == "structuralParameter":
            given = from_written(written, [variable], {}, f"set.{name}")
            structure[name] = int(given[name].value)
    takes = entry.tolerance is not None or loaded.takes_tolerance(entry.interface)
    own = entry.tolerance if entry.tolerance is not None else tolerance if takes else None
    return FmuOptions(entry.interface, own, structure, tuple(entry.locals))


def _part(
    entry: ComponentEntry, name: str, scope: Scope, engine: Engine, timeout_s: float, every: int
) -> Part:
    """Return a component; an isolated one is an FMU with any engine."""
    source = find_source(entry.fmu, scope.folder)
    if not isinstance(source, Path):
        for key in ("interface", "tolerance", "locals"):
            if key in entry.model_fields_set:
                raise InputError(
                    f"{entry.fmu} is a component in Python: the key {key!r} is for FMUs of others"
                )
    in_process = not entry.isolated and (
        engine == "direct" or (engine == "native" and not isinstance(source, Path))
    )
    if isinstance(source, Path):
        if in_process:
            raise InputError(
                f"{source.name} can only run with the engines 'fmu' and 'native', or with "
                "isolated = true"
            )
        from ..fmi.loading.load import load_fmu

        loaded = load_fmu(source, _options(entry, load_fmu(source), scope.tolerance))
        instance, sha256 = _of_fmu(loaded, entry, name, timeout_s)
        return Part(name, entry.fmu, instance, sha256, "", every)
    code = bundle_name(source)
    known = checked(source, code)
    if in_process:
        direct = DirectInstance(source.component_class()(name), through=known.through)
        return Part(name, entry.fmu, direct, "", code, every, undecided=known.undecided)
    # A run in process needs neither FMPy nor pythonfmu.
    from ..fmi.building.export import cached_fmu
    from ..fmi.loading.load import load_fmu

    loaded = replace(load_fmu(cached_fmu(source.portable(), code)), origin=source.folder)
    instance, sha256 = _of_fmu(loaded, entry, name, timeout_s)
    return Part(name, entry.fmu, instance, sha256, code, every, undecided=known.undecided)


def _of_fmu(
    loaded: LoadedFmu, entry: ComponentEntry, name: str, timeout_s: float
) -> tuple[Instance, str]:
    """Return an instance of an FMU, and the hash of its file.

    Of one that allows one instance for each process, a further one gets a process of its own.
    """
    from ..fmi.isolation.isolated import IsolatedInstance
    from ..fmi.loading.load import open_instance

    is_further = loaded.only_once and loaded.sha256 in _ONCE
    if entry.isolated or is_further:
        sandboxed = entry.isolated == "sandboxed"
        instance = IsolatedInstance(loaded, name, timeout_s, sandboxed=sandboxed)
        return instance, loaded.sha256
    if loaded.only_once:
        _ONCE.add(loaded.sha256)
    return open_instance(loaded, name), loaded.sha256
