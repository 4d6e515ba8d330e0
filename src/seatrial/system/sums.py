"""Sums of signals in the place of a component: evaluated where values move, without a step."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any

from ..fmi.instance import Reader, Value, Variable, Variables, Writer
from ..model.terminals import Terminal


class SumInstance:
    """Adds real signals; OSP-IS calls it Sum, and VectorSum with a dimension.

    ``out`` is the sum of ``in[0]``, ``in[1]`` and so on. With a dimension, ``out[0]`` is that of
    ``in[0][0]``, ``in[1][0]`` and so on. It has no unit: its connections convert nothing.
    """

    rolls_back = any_step = True
    restarts = False
    at_once = False
    ended_at: float | None = None
    terminals: Mapping[str, Terminal] = {}
    views: Mapping[str, Mapping[str, str]] = {}

    def __init__(self, name: str, inputs: int, dimension: int | None) -> None:
        self.name = name
        suffixes = [""] if dimension is None else [f"[{axis}]" for axis in range(dimension)]
        self.variables, self.feedthrough = Variables(), dict[str, Sequence[str]]()
        for suffix in suffixes:
            self.feedthrough[f"out{suffix}"] = [f"in[{n}]{suffix}" for n in range(inputs)]
        for term in (term for terms in self.feedthrough.values() for term in terms):
            self.variables[term] = _variable(term, "input", len(self.variables))
        for out in self.feedthrough:
            self.variables[out] = _variable(out, "output", len(self.variables))
        self.terms = inputs
        """Inputs of each output; those of the first stand first, by value reference."""
        self.inputs = (ctypes.c_double * (inputs * len(suffixes)))()
        """Values of the inputs, which C reads and writes too."""

    def set_start(self, values: Mapping[str, Value]) -> None:
        """Set inputs by name."""
        self.writer(list(values))([_real(value) for value in values.values()])

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start: nothing to do."""

    def begin(self) -> None:
        """End the initialisation: nothing to do."""

    def reader(self, names: Sequence[str]) -> Reader:
        """Return a callable that returns the values of ``names``, in that order."""
        inputs, terms = self.inputs, self.terms

        def value(reference: int) -> float:
            if reference < len(inputs):
                return inputs[reference]
            first, total = terms * (reference - len(inputs)), 0.0
            for term in inputs[first : first + terms]:  # one after the other, as libcosim adds
                total += term
            return total

        references = [self.variables[name].reference for name in names]
        return lambda: [value(reference) for reference in references]

    def writer(self, names: Sequence[str]) -> Writer:
        """Return a callable that sets ``names`` to a sequence of values."""
        references = [self.variables[name].reference for name in names]

        def write(values: Sequence[Any]) -> None:
            for reference, value in zip(references, values, strict=True):
                self.inputs[reference] = value

        return write

    def step(self, t: float, h: float) -> None:
        """Advance: nothing to do, a sum has no state."""

    def reset(self) -> None:
        """Return to before `set_start`."""
        self.inputs[:] = [0.0] * len(self.inputs)

    def goes_back(self, may: bool) -> None:
        """Say whether a state may be restored: nothing depends on it."""

    def get_state(self) -> Any:
        """Return a copy of the inputs."""
        return list(self.inputs)

    def set_state(self, state: Any) -> None:
        """Restore what `get_state` returned."""
        self.inputs[:] = state

    def free_state(self, state: Any) -> None:
        """Release a state: nothing to do."""

    def terminate(self) -> None:
        """End the run: nothing to do."""

    def free(self) -> None:
        """Release everything: nothing to do."""


def _real(value: Value) -> float:
    assert isinstance(value, float)
    return value


def _variable(name: str, causality: str, reference: int) -> Variable:
    return Variable(
        name=name,
        causality=causality,
        variability="continuous",
        type=float,
        reference=reference,
        unit="",
        start=0.0 if causality == "input" else None,
        minimum=None,
        maximum=None,
        nominal=None,
        description="",
    )
