"""Components that have a native carrier."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.components.source import ComponentSource
from seatrial.model.component import Component
from seatrial.model.plant import Plant

from . import equations
from .tables import words_of
from .translation.unit import Unit

_RUNNER = (
    *("set", "get", "write", "read", "refresh", "setup", "initialise", "check_parameters"),
    *("begin", "advance", "begin_anew"),
)
"""Methods of `Component` that the runtime has in C."""


def why_python(cls: type[Component], values: Mapping[str, Any] | None = None) -> str:
    """Return why a component cannot be native, empty if it can with the values it starts with.

    ``values`` (by scalar) are given to it before. Nothing is compiled.
    """
    why = why_refused(cls)
    if why:
        return why
    try:
        component = cls()
        for name, value in (values or {}).items():
            component.set(name, value)
        if isinstance(component, Plant):
            equations.require_start(component, cls.__name__)
        else:
            Unit(component).translate()
    except InputError as error:
        return str(error)
    return ""


def why_refused(cls: type[Component]) -> str:
    """Return why a component cannot be native, whatever its methods do, else nothing."""
    if issubclass(cls, Plant):
        return equations.why_python(cls)
    if not cls.rolls_back:
        return "it reaches outside the simulation"
    for name in _RUNNER:
        if getattr(cls, name) is not getattr(Component, name):
            return f"it overrides {name}"
    texts = [p.name for p in cls.ports.values() if p.type is str and p.kind != "parameter"]
    texts = [name for name in texts if not words_of(cls.ports[name])]
    return f"its ports {', '.join(texts)} are texts" if texts else ""


def refuse(source: ComponentSource) -> None:
    """Raise InputError for a component that cannot be native, before there is one.

    One that reaches outside the simulation is refused by its class: to start it, as `checked`
    does, would open its links.
    """
    if why := why_refused(source.component_class()):
        raise InputError(f"{source.origin} cannot be native: {why}")


def checked(component: Component, name: str) -> None:
    """Start a component that `refuse` lets pass, which makes all its checks, and close it.

    Raises InputError for values that it cannot start with.
    """
    try:
        component.setup(0.0)
        component.initialise()
    except SimulationError as error:
        raise InputError(f"{name}: {error}") from None
    finally:
        component.close()
