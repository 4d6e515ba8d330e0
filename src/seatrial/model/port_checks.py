"""Values that do not fit a port, and what is said of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ..errors import InputError
from .ports import Parameter, ScalarPort


def check_parameter(component: str, scalar: ScalarPort, value: Any) -> None:
    """Raise InputError if a parameter of a component is outside its min, max or choices."""
    name, port, unit = scalar.name, scalar.port, scalar.unit
    if not isinstance(port, Parameter):
        return
    if port.type is str:
        try:
            port.check_text(value)
        except InputError as error:
            raise InputError(f"{component}.{error}") from None
        return
    low, high = port.limit("min", scalar.index), port.limit("max", scalar.index)
    if (low is not None and value < low) or (high is not None and value > high):
        raise InputError(
            f"{component}.{name} is {value!r} {unit}, allowed {_range_text(low, high)} {unit}"
        )


def misfit(
    scalars: Sequence[ScalarPort], references: Iterable[int], allowed: frozenset[int], kind: type
) -> str:
    """Return why the first of ``references`` that is not ``allowed`` is not."""
    reference = next(r for r in references if r not in allowed)
    if not 0 <= reference < len(scalars):
        return f"there is no variable with value reference {reference}"
    scalar = scalars[reference]
    if scalar.port.type is not kind:
        return f"{scalar.name} is of type {scalar.port.type.__name__}, not {kind.__name__}"
    if scalar.port.kind == "output":
        return f"{scalar.name} is an output and cannot be set"
    return f"{scalar.name} is a fixed parameter and cannot change once the run has started"


def _range_text(low: float | None, high: float | None) -> str:
    if low is None:
        return f"at most {high!r}"
    return f"at least {low!r}" if high is None else f"{low!r} to {high!r}"
