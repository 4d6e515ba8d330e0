"""Sums of signals in the place of a component: evaluated where values move, without a step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..fmi.instance import Reader, Value, Variable, Variables, Writer
from ..terminals import Terminal


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
        self._terms: dict[str, list[str]] = {}
        for suffix in suffixes:
            terms = [f"in[{number}]{suffix}" for number in range(inputs)]
            self._terms[f"out{suffix}"] = self.feedthrough[f"out{suffix}"] = terms
        for term in (t for terms in self._terms.values() for t in terms):
            self.variables[term] = _variable(term, "input", len(self.variables))
        for out in self._terms:
            self.variables[out] = _variable(out, "output", len(self.variables))
        self._inputs = {term: 0.0 for terms in self._terms.values() for term in terms}

    def set_start(self, values: Mapping[str, Value]) -> None:
        """Set inputs by name."""
        self._inputs.update({name: _real(value) for name, value in values.items()})

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start: nothing to do."""

    def begin(self) -> None:
        """End the initialisation: nothing to do."""

    def reader(self, names: Sequence[str]) -> Reader:
        """Return a callable that returns the values of ``names``, in that order."""
        inputs, terms = self._inputs, self._terms

        def value(name: str) -> float:
            if name in inputs:
                return inputs[name]
            total = 0.0
            for term in terms[name]:  # one after the other, as libcosim adds
                total += inputs[term]
            return total

        return lambda: [value(name) for name in names]

    def writer(self, names: Sequence[str]) -> Writer:
        """Return a callable that sets ``names`` to a sequence of values."""
        return lambda values: self._inputs.update(zip(names, values, strict=True))

    def step(self, t: float, h: float) -> None:
        """Advance: nothing to do, a sum has no state."""

    def reset(self) -> None:
        """Never called: it does not restart."""

    def get_state(self) -> Any:
        """Return a copy of the inputs."""
        return dict(self._inputs)

    def set_state(self, state: Any) -> None:
        """Restore what `get_state` returned."""
        self._inputs.update(state)

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
