"""Actions: ports set, overridden or released while a system runs."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal

from ..errors import InputError, unknown
from ..fmi.instance import Value, Variable
from ..system.part import Part
from ..system.references.values import from_written, port_names, port_scalars
from ..system.system import System, settable
from .master import Master

ActionKind = Literal["set", "override", "release"]


@dataclass(frozen=True)
class Change:
    """What becomes of the scalars of one port."""

    component: str
    values: dict[str, Value | None]
    """By variable name, in the port's unit; None where it is released."""


@dataclass(frozen=True)
class Action:
    """What becomes of the ports that one name means, checked."""

    kind: ActionKind
    changes: tuple[Change, ...]

    def apply(self, master: Master) -> None:
        """Do it at the master's time. Raises SimulationError."""
        for change in self.changes:
            if self.kind == "set":
                master.set(change.component, list(change.values), list(change.values.values()))
            for name, value in change.values.items():
                if self.kind == "override":
                    master.override(change.component, name, value)
                elif self.kind == "release":
                    master.release(change.component, name)


def action(system: System, kind: ActionKind, key: str, written: Any, where: str) -> Action:
    """Return the action on ``component.port`` of what a person wrote.

    Inputs that nothing feeds and tunable parameters can be set; outputs and inputs that are
    wholly connected, overridden and released. What a rig inside shows stands
    for all ports that it means. Raises InputError, naming ``where``.
    """
    located = system.located(key, where)
    return Action(kind, tuple(_change(system, kind, each, key, written, where) for each in located))


def _can_change(variable: Variable) -> bool:
    """Say if a variable that can be set before a run can be during it, too."""
    return variable.causality == "input" or variable.variability == "tunable"


def _change(
    system: System, kind: ActionKind, place: tuple[Part, str], key: str, written: Any, where: str
) -> Change:
    part, port = place
    component = part.name
    variables = part.instance.variables
    scalars = port_scalars(variables, port)
    if not scalars:
        raise InputError(f"{where}: {component}: {unknown('port', port, port_names(variables))}")
    fed = system.feeders(component)
    connected = [variable.name in fed for variable in scalars]
    if kind == "set" and scalars[0].role == "fault":
        raise InputError(f"{where}: {key} is written by faults: {_hint(key, written)}")
    if kind == "set":
        settable(variables, port, f"{where}: {component}")
        if any(connected):
            feeder = next(fed[variable.name] for variable in scalars if variable.name in fed)
            raise InputError(f"{where}: {key} is fed by {feeder}; a fault replaces it")
        if not _can_change(scalars[0]):
            raise InputError(f"{where}: {key} is fixed and cannot change during a run")
    elif {(component, scalars[0].name)} & {one.target for one in system.initial}:
        raise InputError(f"{where}: {key} has its value from the start and cannot change")
    elif not (all(connected) or scalars[0].causality == "output"):
        raise InputError(
            f"{where}: {key} is neither an output nor an input that is wholly connected"
        )
    if kind == "release":
        return Change(component, dict.fromkeys(variable.name for variable in scalars))
    given = from_written(written, scalars, part.presets.get(port, {}), where)
    return Change(component, {name: value.value for name, value in given.items()})


def _hint(key: str, written: Any) -> str:
    """Return the entry of faults that stands for what was set."""
    place = key.removesuffix(".fault") if key.endswith(".fault") else key.replace(".fault.", ".")
    return f"[[faults]] where = {json.dumps(place)}, what = {json.dumps(str(written))}"
