"""The file of a policy that was trained in a task: its observations and actions, as ports."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from seatrial.api.assembling import assembled
from seatrial.errors import InputError, unknown
from seatrial.files.whole_file import write_whole
from seatrial.fmi.direct import DirectInstance
from seatrial.system.system import System
from seatrial.trial.criteria import expressions as ex

from .policy_file import has_meaning
from .task import Task


def write_policy(task: str | Path, network: str | Path, path: str | Path) -> Path:
    """Write the file of a policy for a network that was trained in ``task``; return its path.

    Inputs are the ports that the task observes, outputs those that it sets, by their own names as
    far as these differ; all inputs are the terminal ``sensors``. Observations, ranges and period
    are the task's. ``network``, an ``.npz`` or ``.onnx`` file, need not be there yet.

    Raises InputError for a task that does not fit its system, one that observes or sets what is no
    real number, and if there is a file at ``path``.
    """
    path = Path(path)
    if path.exists():
        raise InputError(f"{path}: is there already")
    read = Task(task)
    file = read.file
    made = assembled(file.rig, file.set, variant=file.variant, choices=file.choices or None)
    try:
        content = _text(read, made.system, os.path.relpath(network, path.parent))
    finally:
        made.system.discard()
    write_whole(path, content)
    return path


def _text(task: Task, system: System, network: str) -> str:
    file = task.file
    names = {name for value in task.values for name in ex.signal_names(value)}
    inputs, outputs = sorted(names), [entry.to for entry in file.act]
    ports = _Ports(task, system, [*inputs, *outputs])
    lines = [
        f"title   = {json.dumps(file.title)}",
        f"network = {json.dumps(Path(network).as_posix())}",
        f"period  = {json.dumps(file.decision)}",
        *("", "[inputs]", *ports.tables(inputs)),
        *("", "[outputs]", *ports.tables(outputs)),
        *("", "[terminals]", f"sensors = {json.dumps(ports.names(inputs))}"),
    ]
    for seen in file.observe:
        lines += ["", "[[observe]]", f"value = {json.dumps(ports.renamed(seen.value))}"]
        lines += [f"range = {json.dumps(seen.range)}"]
    for done in file.act:
        lines += ["", "[[act]]", f"to    = {json.dumps(ports.renamed(done.to))}"]
        lines += [f"range = {json.dumps(done.range)}"]
    return "\n".join(lines) + "\n"


class _Ports:
    """Ports that a task reads and sets, with names of their own."""

    def __init__(self, task: Task, system: System, signals: Iterable[str]) -> None:
        self._places: dict[str, tuple[str, str, str]] = {}
        """Component, port and element, with its point, by signal."""
        self._content: dict[tuple[str, str], Mapping[str, Any]] = {}
        for name in signals:
            component = max(
                (p for p in system.parts if name.startswith(f"{p}.")), key=len, default=""
            )
            variables = system.parts[component].instance.variables if component else {}
            scalar = name.removeprefix(f"{component}.")
            if scalar not in variables:
                known = [
                    f"{c}.{v}" for c, part in system.parts.items() for v in part.instance.variables
                ]
                raise InputError(f"{task.path}: {unknown('signal', name, known)}")
            if variables[scalar].type is not float:
                raise InputError(
                    f"{task.path}: {name} is no real number: a policy takes those alone"
                )
            port, content = _port(system, component, scalar)
            self._places[name] = component, port, scalar.removeprefix(port)
            self._content[component, port] = content
        self._names = _shortest([*self._content])
        found = sorted(map(re.escape, self._places), key=len, reverse=True)
        self._signals = re.compile(rf"(?<![\w.])(?:{'|'.join(found)})(?![\w.])")

    def names(self, signals: Iterable[str]) -> list[str]:
        """Return the names of ports, each once."""
        return list(dict.fromkeys(self._names[self._places[name][:2]] for name in signals))

    def tables(self, signals: Iterable[str]) -> list[str]:
        """Return a line of TOML for each port, behind a note where it is from."""
        lines = []
        for at in dict.fromkeys(self._places[name][:2] for name in signals):
            written = ", ".join(f"{k} = {json.dumps(v)}" for k, v in self._content[at].items() if v)
            lines.append(f"{self._names[at]} = {{ {written} }}  # {'.'.join(at)}")
        return lines

    def renamed(self, text: str) -> str:
        """Return an expression with the ports' own names."""

        def name(match: re.Match[str]) -> str:
            component, port, element = self._places[match[0]]
            return f"{self._names[component, port]}{element}"

        return self._signals.sub(name, text)


def _shortest(ports: list[tuple[str, str]]) -> dict[tuple[str, str], str]:
    """Return names of ports: of as many of the last parts of the path as tell them apart."""
    paths = [[*component.split("."), port] for component, port in ports]
    found = {}
    for at, path in zip(ports, paths, strict=True):
        same = [other for other in paths if other is not path]
        names = [
            "_".join(path[-n:])
            for n in range(1, len(path) + 1)
            if path[-n:] not in [other[-n:] for other in same]
        ]
        found[at] = next((name for name in names if not has_meaning(name)), names[-1])
    return found


def _port(system: System, component: str, scalar: str) -> tuple[str, Mapping[str, Any]]:
    """Return the port of a scalar, and what a policy's file says of it."""
    instance = system.parts[component].instance
    if isinstance(instance, DirectInstance):
        own = instance.component.scalar_by_name[scalar].port
        return own.name, {
            "unit": list(own.unit) if isinstance(own.unit, tuple) else own.unit,
            "axes": list(own.axes) if own.axes else None,
            "frame": own.frame,
            "description": own.description,
        }
    variable = instance.variables[scalar]
    return scalar, {"unit": variable.unit or "1", "description": variable.description}
