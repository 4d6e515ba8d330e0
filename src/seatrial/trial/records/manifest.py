"""The manifest of a run: everything that decides its signals, and where it came from."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ... import __version__
from ...model.component import seconds
from ...sim.compiled.choice import is_compiled
from ...system.files import Source
from ...system.part import Part
from ...system.references.values import storable
from ...system.system import Engine, System
from ..files.trial import Trial
from .identity import IDENTITY, identity_of_run
from .program import versions

_TYPES = {float: "Real", int: "Integer", bool: "Boolean", str: "String", bytes: "Binary"}


def manifest(trial: Trial, system: System, engine: Engine) -> dict[str, Any]:
    """Return the manifest's content: same content, same bytes of ``signals.csv``."""
    return {
        "format": 1,
        "seatrial": __version__,
        "versions": versions(),
        IDENTITY: identity_of_run(trial).content(),
        "trial": {**_file(trial.read_from), "title": trial.file.title},
        "rig": {**_file(trial.rig.read_from), "title": trial.rig.file.title},
        **_composition(trial, system),
        "engine": engine,
        "master": "compiled" if is_compiled(system) else "python",
        "algorithm": trial.rig.file.algorithm,
        "variant": system.variant,
        "seed": system.seed,
        **({} if trial.file.utc is None else {"utc": trial.file.utc}),
        "start": seconds(trial.start_ns),
        "stop": seconds(trial.stop_ns),
        "step": seconds(trial.rig.step_ns),
        "record": trial.file.record.model_dump(),
        "components": {
            name: _component(part, system.feeders(name), seconds(part.every * trial.rig.step_ns))
            for name, part in system.parts.items()
        },
        "connections": _connections(system),
        "signals": {
            f"{name}.{v.name}": {
                "type": _TYPES[v.type],
                "unit": v.unit,
                "description": v.description,
            }
            for name, part in system.parts.items()
            for v in part.instance.variables.values()
            if v.causality == "output"
        },
        "criteria": [
            {**entry.model_dump(), "paths": dict(criterion.paths)}
            for entry, (_, criterion) in zip(trial.file.criteria, trial.criteria, strict=True)
        ],
        "plots": [entry.model_dump() for entry in trial.file.plots],
        "events": [entry.model_dump() for entry in trial.file.events],
        "faults": [entry.written for entry in trial.file.faults],
        **({} if trial.scenario is None else {"scenario": _file(trial.scenario.read_from)}),
    }


def _composition(trial: Trial, system: System) -> dict[str, Any]:
    """Return choices, files of the rigs inside, and parts that were left out, if there are any."""
    rig, content = trial.rig, dict[str, Any]()
    if rig.top.choices:
        content["choices"] = dict(rig.top.choices)
    if rig.sources:
        content["rigs"] = [_file(source) for source in rig.sources]
    if system.left_out:
        content["left_out"] = system.left_out
    return content


def _connections(system: System) -> list[list[Any]]:
    """Return [from, to], behind it [factor, offset] and [mapping] where a connection has them."""
    rows: list[list[Any]] = []
    for joint in system.joints:
        mapping = [[list(pair) for pair in joint.mapping]] if joint.mapping else []
        transformed = mapping or (joint.factor, joint.offset) != (1.0, 0.0)
        transformation = [joint.factor, joint.offset] if transformed else []
        rows.append([joint.source, joint.target, *transformation, *mapping])
    return rows


def _file(source: Source) -> dict[str, str]:
    return {"name": source.name, "file": source.path.name, "sha256": source.sha256}


def _without_folder(origin: str) -> str:
    """Return ``/folder/x.toml: set: ...`` as ``x.toml: set: ...``: manifests name no folder."""
    file, colon, rest = origin.partition(": ")
    return f"{Path(file).name}{colon}{rest}" if colon and Path(file).is_absolute() else origin


def _component(part: Part, feeders: Mapping[str, str], step: float) -> dict[str, Any]:
    parameters = {}
    for variable in part.instance.variables.values():
        given = part.given.get(variable.name)
        if variable.causality != "parameter" and given is None:
            continue
        value = variable.start if given is None else given.value
        origin = "start value of the FMU" if given is None else _without_folder(given.origin)
        if variable.name in feeders:
            value, origin = None, f"fed by {feeders[variable.name]}"
        parameters[variable.name] = {
            **_value(value),
            "unit": variable.unit,
            "from": origin,
            "source": "" if given is None else given.source,
            "mark": "" if given is None else given.mark,
        }
    shown: dict[str, Any] = {}
    if part.instance.views:
        shown["views"] = {kind: dict(ports) for kind, ports in part.instance.views.items()}
    if part.outline is not None:
        shown["outline"] = {"length": part.outline.length, "beam": part.outline.beam}
    if part.drawn:
        shown["shape"] = part.drawn
    if part.home is not None and "motion" in part.instance.terminals:
        shown["home"] = list(part.home)
    return {
        "fmu": Path(part.fmu).name if Path(part.fmu).is_absolute() else part.fmu,
        "sha256": part.sha256,
        "code": part.code,
        "step": step,
        "parameters": parameters,
        **shown,
    }


def _value(value: Any) -> dict[str, Any]:
    """Return a value as it is stored; a file by its path, as its name and what is in it."""
    if isinstance(value, str) and Path(value).is_absolute() and Path(value).is_file():
        sha256 = hashlib.sha256(Path(value).read_bytes()).hexdigest()
        return {"value": Path(value).name, "sha256": sha256}
    return {"value": None if value is None else storable(value)}
