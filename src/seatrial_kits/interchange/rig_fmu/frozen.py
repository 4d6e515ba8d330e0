"""An assembled rig as text, and the source of an FMU in Python of it."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.instance import Variable
from seatrial.model.component import Component, seconds
from seatrial.system.part import Part
from seatrial.system.registry import ALGORITHMS
from seatrial.system.system import Connection, System

from .component import rig_component
from .face import Face

_SCRIPT = '''"""{name}: a rig as an FMU."""

{imports}
from seatrial_kits.interchange.rig_fmu.component import rig_component
from seatrial.fmi.slave import Slave

FROZEN = {text!r}
CLASSES = {{{classes}}}
Rig = rig_component(FROZEN, CLASSES, Algorithm)


class RigFmu(Slave):
    """FMU of the rig."""

    component_class = Rig

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
'''


@dataclass(frozen=True)
class RigSource(ComponentSource):
    """A rig that can be built into an FMU as a component in Python is."""

    text: str = ""
    """The rig, frozen."""
    parts: tuple[ComponentSource, ...] = ()
    """What its components are of, each once."""
    algorithm: str = "jacobi"

    @property
    def script(self) -> bytes:
        """Text of the FMU's slave script."""
        module, _, name = ALGORITHMS.target(self.algorithm).partition(":")
        imports = [f"from {module} import {name} as Algorithm"]
        imports += [one.imported(f"Class{i}") for i, one in enumerate(self.parts)]
        classes = ", ".join(f"{_key(one)!r}: Class{i}" for i, one in enumerate(self.parts))
        return _SCRIPT.format(
            name=self.name, imports="\n".join(imports), text=self.text, classes=classes
        ).encode()

    @property
    def package(self) -> str | None:
        """Top-level package of somebody else that has to travel in the FMU."""
        return next((one.package for one in self.parts if one.package), None)

    @property
    def title(self) -> str:
        """What it is, for listings."""
        return self.class_name

    @cached_property
    def _class(self) -> type[Component]:
        classes = {_key(one): one.component_class() for one in self.parts}
        return rig_component(self.text, classes, ALGORITHMS.load(self.algorithm))

    def component_class(self) -> type[Component]:
        """Return the component."""
        return self._class


def rig_source(system: System, face: Face, name: str) -> RigSource:
    """Return the source of an FMU in Python of a rig whose parts all run in process.

    Raises InputError for parts that are FMUs of others or in processes of their own, and for
    components of users' files in several folders.
    """
    path = system.rig.read_from.path
    sources: dict[str, ComponentSource] = {}
    for part in system.parts.values():
        if part.is_sum:
            continue
        source = find_source(part.fmu, system.rig.components[part.name].scope.folder)
        if isinstance(source, Path) or not isinstance(part.instance, DirectInstance):
            raise InputError(f"{path}: {part.name} is an FMU: it cannot be within another one")
        sources.setdefault(_key(source), source)
    folders = {one.folder for one in sources.values() if one.folder is not None}
    packages = {one.package for one in sources.values() if one.package}
    if len(folders) > 1 or len(packages) > 1:
        several = ", ".join(sorted(map(str, [*folders, *packages])))
        raise InputError(f"{path}: one FMU carries the files of one folder and package: {several}")
    stem = re.sub(r"\W", "_", name)
    algorithm = system.rig.file.algorithm
    text = json.dumps(_frozen(system, face, name), separators=(",", ":"))
    folder = next(iter(folders), None)
    parts = tuple(sources.values())
    return RigSource(name, stem, stem, "Rig", name, folder, text, parts, algorithm)


def _frozen(system: System, face: Face, name: str) -> dict[str, Any]:
    file = system.rig.file
    parts = system.parts.values()
    components = [p.instance.component for p in parts if isinstance(p.instance, DirectInstance)]
    return {
        "name": name,
        "title": system.rig.top.file.title or name,
        "step": file.step,
        "fixed_step": seconds(system.rig.step_ns),
        "algorithm": file.algorithm,
        "iteration": None if file.iteration is None else file.iteration.model_dump(),
        "ecco": None if file.ecco is None else file.ecco.model_dump(),
        "bonds": [[one.name, one.pairs] for one in system.bonds],
        "parts": [_part(system, part) for part in parts],
        "connections": [_connection(one) for one in system.connections],
        "initial": [_connection(one) for one in system.initial],
        "ports": [_port(variable) for variable in face.variables.values()],
        "targets": {whole: [list(n) for n in names] for whole, names in face.targets.items()},
        "through": {output: inputs for output, inputs in face.through.items() if inputs},
        "terminals": {n: [dict(one.members), one.rule] for n, one in face.terminals.items()},
        "rolls_back": all(part.instance.rolls_back for part in parts),
        "discrete": any(one.discrete for one in components),
    }


def _part(system: System, part: Part) -> dict[str, Any]:
    entry, scope = system.rig.components[part.name].entry, system.rig.components[part.name].scope
    summed = None if entry.sum is None else [entry.sum.inputs, entry.sum.dimension]
    source = None if summed else find_source(part.fmu, scope.folder)
    return {
        "name": part.name,
        "class": _key(source) if isinstance(source, ComponentSource) else "",
        "sum": summed,
        "every": part.every,
        "given": {name: given.value for name, given in part.given.items()},
    }


def _key(source: ComponentSource) -> str:
    """Return what tells the class of a component from others."""
    return f"{source.module}:{source.class_name}"


def _connection(one: Connection) -> list[Any]:
    mapping = [list(pair) for pair in one.mapping.items()]
    return [one.source, one.target, one.factor, one.offset, one.to_real, mapping]


def _port(variable: Variable) -> dict[str, Any]:
    return {
        "name": variable.name,
        "kind": variable.causality,
        "type": variable.type.__name__,
        "unit": variable.unit or "1",
        "description": variable.description,
        "start": variable.start,
        "min": variable.minimum,
        "max": variable.maximum,
        "nominal": variable.nominal,
        "tunable": variable.variability == "tunable",
        "optional": variable.optional,
        "role": variable.role,
        "term_of": variable.term_of,
    }
