"""Actions: ports set, overridden or released while a system runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from ..errors import InputError, unknown
from ..fmi.instance import Value
from .master import Master
from .system import System, settable
from .values import from_written, port_names, port_scalars

ActionKind = Literal["set", "override", "release"]


@dataclass(frozen=True)
class Action:
    """What becomes of the scalars of one port, checked."""

    kind: ActionKind
    component: str
    values: dict[str, Value | None]
    """By variable name, in the port's unit; None where it is released."""

    def apply(self, master: Master) -> None:
        """Do it at the master's time. Raises SimulationError."""
        if self.kind == "set":
            master.set(self.component, list(self.values), list(self.values.values()))
        for name, value in self.values.items():
            if self.kind == "override":
                master.override(self.component, name, value)
            elif self.kind == "release":
                master.release(self.component, name)


def action(system: System, kind: ActionKind, key: str, written: Any, where: str) -> Action:
    """Return the action on ``component.port`` of what a person wrote.

    Inputs that nothing feeds and tunable parameters can be set; outputs and inputs that are
    wholly connected, overridden and released. Raises InputError, naming ``where``.
    """
    component, _, port = key.partition(".")
    if component not in system.parts:
        raise InputError(f"{where}: {unknown('component', component, system.parts)}")
    part = system.parts[component]
    variables = part.instance.variables
    scalars = port_scalars(variables, port)
    if not scalars:
        raise InputError(f"{where}: {component}: {unknown('port', port, port_names(variables))}")
    fed = system.feeders(component)
    connected = [variable.name in fed for variable in scalars]
    if kind == "set":
        settable(variables, port, f"{where}: {component}")
        if any(connected):
            feeder = next(fed[variable.name] for variable in scalars if variable.name in fed)
            raise InputError(f"{where}: {key} is fed by {feeder}; override it instead")
        if scalars[0].causality == "parameter" and scalars[0].variability != "tunable":
            raise InputError(f"{where}: {key} is fixed and cannot change during a run")
    elif not (all(connected) or scalars[0].causality == "output"):
        raise InputError(
            f"{where}: {key} is neither an output nor an input that is wholly connected"
        )
    if kind == "release":
        return Action(kind, component, dict.fromkeys(variable.name for variable in scalars))
    given = from_written(written, scalars, part.presets.get(port, {}), where)
    return Action(kind, component, {name: value.value for name, value in given.items()})
