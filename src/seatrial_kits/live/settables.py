"""Set-points, tunables and helms: all that a page can set while a run goes on."""

from __future__ import annotations

import math
from typing import Any

from seatrial.fmi.instance import Variable
from seatrial.sim.master import Master
from seatrial.system.system import System

_HELM = ("mode", "armed", "manual")
"""Members of the terminal ``orders`` by which a person takes a pilot's helm."""


def settables_of(system: System, master: Master) -> list[dict[str, Any]]:
    """Return the numbers and switches that can be set at any time, with unit, limits, value.

    They are inputs that nothing feeds and tunable parameters that nothing feeds, scalar by scalar.
    """
    found = []
    for name, part in system.parts.items():
        fed = system.feeders(name)
        own = [
            v
            for v in part.instance.variables.values()
            if v.type in (float, int, bool)
            and v.name not in fed
            and v.role != "fault"
            and (v.causality == "input" or v.variability == "tunable")
        ]
        values = master.values(name, [v.name for v in own]) if own else []
        found += [_entry(name, v, value) for v, value in zip(own, values, strict=True)]
    return found


def _entry(component: str, variable: Variable, value: Any) -> dict[str, Any]:
    limits = [variable.minimum, variable.maximum]
    return {
        "key": f"{component}.{variable.name}",
        "unit": variable.unit,
        "limits": [x if x is not None and math.isfinite(x) else None for x in limits],
        "value": value,
        "is_switch": variable.type is bool,
        "description": variable.description,
    }


def orders_of(system: System, master: Master) -> list[dict[str, Any]]:
    """Return the pilots whose helm a person can take: what their orders are written to.

    ``fed`` has the members that something else orders, which a fault of the kind fixed replaces
    as long as somebody has the helm; ``before`` has mode and arming as the rig starts.
    """
    found = []
    for name, part in system.parts.items():
        orders = part.instance.terminals.get("orders")
        if orders is None or not all(member in orders.members for member in _HELM):
            continue
        ports = {member: orders.members[member] for member in _HELM}
        variables = part.instance.variables
        scalars = variables.ports.get(ports["manual"], [])
        mode = variables.get(ports["mode"])
        if len(scalars) < 2 or mode is None or mode.causality != "input":
            continue
        fed = system.feeders(name)
        own = [ports["mode"], ports["armed"]]
        first = {**ports, "manual": scalars[0].name}
        found.append(
            {
                "component": name,
                "ports": ports,
                "axes": [scalar.name.rpartition(".")[2] for scalar in scalars],
                "fed": [member for member in _HELM if first[member] in fed],
                "before": dict(zip(("mode", "armed"), master.values(name, own), strict=True)),
            }
        )
    return found
