"""Declarations that narrow what is found, tried: inputs are changed, and outputs compared."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable
from typing import Any

from ...errors import InputError
from ...model.component import Component, Input
from ...model.plant import Plant
from ...model.ports import Port
from ...model.sampled import Sampled
from .found import found

_POINTS = 12
_SPAN = 2.0
"""Inputs without limits are tried between minus and plus so much."""
_STEP_S = 0.01


def refuse_dependent(cls: type[Component]) -> None:
    """Raise InputError if an output follows from an input that its declaration leaves out.

    Both are tried at several points of a run with random inputs within their limits. A
    component that reaches outside is not started; one that refuses the values is not checked.
    """
    narrowed = _narrowed(cls)
    if not narrowed or not cls.rolls_back:
        return
    draw = random.Random(1)
    try:
        component = cls(cls.__name__)
        _begin(component)
    except Exception:  # it needs what only a rig gives, such as files
        return
    step = component.fixed_step or (component.period if isinstance(component, Sampled) else _STEP_S)
    for point in range(1, _POINTS + 1):  # before the first step states may follow from inputs
        try:
            component.advance((point - 1) * step, step)
            for port in _inputs(cls):
                component.set(port.name, _drawn(port, draw))
            shown = {output: component.get(output) for output in narrowed}
        except Exception:
            return
        for name in sorted({name for inputs in narrowed.values() for name in inputs}):
            _try(component, name, draw, narrowed, shown)


def _begin(component: Component) -> None:
    for name, value in component.exercised.items():
        component.set(name, value)
    component.setup(0.0)
    component.initialise()
    component.begin()


def _narrowed(cls: type[Component]) -> dict[str, set[str]]:
    """Return the inputs that may act on outputs, and that their declarations leave out."""
    by_equations = cls.output_ports if issubclass(cls, Plant) else ()
    checked = {port.name for port in by_equations}
    if not cls.feedthrough.keys() - checked:
        return {}
    through = found(cls).through
    left_out = {
        output: set(through[output]) - set(inputs)
        for output, inputs in cls.feedthrough.items()
        if output not in checked
    }
    return {output: inputs for output, inputs in left_out.items() if inputs}


def _inputs(cls: type[Component]) -> Iterable[Port]:
    return (port for port in cls.ports.values() if port.kind == "input")


def _drawn(port: Port, draw: random.Random) -> Any:
    """Return a random value of an input, within its limits."""
    if port.type is str:
        choices = port.choices if isinstance(port, Input) else ()
        return draw.choice(choices) if choices else port.start[0]
    values = []
    for index in range(port.size):
        least, most = port.limit("min", index), port.limit("max", index)
        low = -_SPAN if least is None else least
        high = max(low, _SPAN if most is None else most)
        low = min(low, high)
        number = draw.uniform(low, high)
        values.append(number > 0.0 if port.type is bool else port.type(number))
    return values if port.axes else values[0]


def _alike(a: Any, b: Any) -> bool:
    """Say if two values differ by no more than what is left where a loop has settled."""
    if isinstance(a, list):
        return all(map(_alike, a, b))
    return a == b or (isinstance(a, float) and math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12))


def _try(
    component: Component,
    name: str,
    draw: random.Random,
    narrowed: dict[str, set[str]],
    shown: dict[str, Any],
) -> None:
    """Change one input, compare the outputs that do not depend on it, and change it back."""
    before, value = component.get(name), _drawn(component.ports[name], draw)
    try:
        component.set(name, value)
        changed = {output: component.get(output) for output in narrowed if name in narrowed[output]}
    except Exception:
        changed = {}
    component.set(name, before)
    for output, found_now in changed.items():
        if not _alike(found_now, shown[output]):
            raise InputError(
                f"{type(component).__name__}.feedthrough says that {output!r} does not depend on "
                f"{name!r}, but at the same instant {output} is {shown[output]!r} with {name} = "
                f"{before!r} and {found_now!r} with {name} = {value!r}: name it there, or leave "
                f"{output!r} out, then it is found"
            )
