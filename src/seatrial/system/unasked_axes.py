"""Forces and moments that a pilot asks for, and that the axes of the allocation leave out."""

from __future__ import annotations

from .part import Part
from .system import Connection, System

_AXES = {
    "surge": "surge",
    "sway": "sway",
    "heave": "heave",
    "roll_moment": "roll",
    "pitch_moment": "pitch",
    "yaw_moment": "yaw",
}
"""Axes of an allocation by its inputs."""


def unasked(system: System) -> list[str]:
    """Return notes on demands that reach an allocation and are not among its ``axes``."""
    notes = []
    for connection in system.connections:
        name, port = connection.target
        part, axis = system.parts[name], _AXES.get(port, "")
        if not axis or "propulsor_order.p1" not in part.instance.variables:
            continue
        axes = str(_value(part, "axes", axis))
        if axis not in axes.split() and _asks(system, connection):
            origin = part.given["axes"].origin if "axes" in part.given else ""
            file = origin.removesuffix(f": {name}.axes")
            notes.append(
                f"{file}{': ' if file else ''}{name}.axes is {axes!r}: nothing gives {axis}, "
                f"which {'.'.join(connection.source)} asks for"
            )
    return notes


def _asks(system: System, connection: Connection) -> bool:
    """Return whether a demand may be other than 0: a helm has axes that it does not steer."""
    name, port = connection.source
    part = system.parts[name]
    if f"{port}_limit" not in part.instance.variables:
        return True
    held = (name, f"{port}_held")
    fed = any(one.target == held for one in system.connections)
    return fed or _value(part, f"{port}_limit", 0.0) != 0.0


def _value(part: Part, name: str, otherwise: object) -> object:
    if name in part.given:
        return part.given[name].value
    variable = part.instance.variables.get(name)
    return otherwise if variable is None else variable.start
