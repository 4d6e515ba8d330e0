"""Running a component by hand."""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np

from seatrial.model.component import Component

C = TypeVar("C", bound=Component)


def started(cls: type[C], **values: Any) -> C:
    """Return a component of this class, its ports set, at time 0 and ready to step."""
    component = cls(cls.__name__)
    for name, value in values.items():
        component.set(name, value)
    component.initialise()
    component.begin()
    return component


def run(
    component: Component,
    outputs: list[str],
    stop_ms: int,
    step_ms: int,
    inputs: Callable[[int], Mapping[str, Any]] = lambda _: {},
    first_ms: int = 0,
) -> list[list[Any]]:
    """Step from ``first_ms`` and return, per communication point (ms), the outputs there.

    ``inputs(t_ms)`` are set at each point before its outputs are read.
    """
    rows = []
    for t_ms in range(first_ms, stop_ms + 1, step_ms):
        for name, value in inputs(t_ms).items():
            component.set(name, value)
        rows.append([component.get(name) for name in outputs])
        if t_ms < stop_ms:
            component.advance(t_ms / 1000, step_ms / 1000)
    return rows


def over(component, names, h, inputs):
    """Return outputs at the beginning of each step of ``h``, s, whose inputs are a row."""
    rows = []
    for k, row in enumerate(inputs):
        for name, value in row.items():
            component.set(name, value)
        rows.append(np.hstack([component.get(name) for name in names]))
        component.advance(k * h, h)
    return np.array(rows)
