"""Scalars of a rig, described."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..fmi.instance import Variable
    from ..system.system import System


@dataclass(frozen=True)
class Signal:
    """One scalar of a rig: an output, an input or a parameter."""

    name: str
    """``component.port``, with its axis: ``hull.position.x``."""
    unit: str
    """As FMI writes it: ``m/s``, ``rad``, ``1``; empty if it has none."""
    description: str
    type: type
    """float, int, bool, str or bytes."""
    minimum: float | None
    maximum: float | None
    tunable: bool
    """A parameter that may be set during a run, or an input that nothing feeds."""
    feeder: str
    """The output that feeds this input or parameter; empty if none does."""


def described(system: System, causality: str) -> dict[str, Signal]:
    """Return the variables of a causality, by name, in the order of the rig."""
    found = {}
    for component, part in system.parts.items():
        feeders = system.feeders(component)
        for variable in part.instance.variables.values():
            if variable.causality == causality:
                name, feeder = f"{component}.{variable.name}", feeders.get(variable.name, "")
                found[name] = _signal(name, variable, feeder)
    return found


def _signal(name: str, variable: Variable, feeder: str) -> Signal:
    settable = variable.causality == "input" or variable.variability == "tunable"
    return Signal(
        name=name,
        unit=variable.unit,
        description=variable.description,
        type=variable.type,
        minimum=variable.minimum,
        maximum=variable.maximum,
        tunable=settable and variable.causality != "output" and not feeder,
        feeder=feeder,
    )
