"""Observations: expressions of inputs, as the operations that `policy.Network` goes through."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.model.units import unit
from seatrial.trial.criteria import expressions as ex
from seatrial.trial.criteria.grammar import tree
from seatrial.trial.criteria.metrics import is_of_record
from seatrial.trial.criteria.predicates import Comparison

OPERATIONS = (
    *("+", "-", "*", "/", "negative", "abs", "min", "max"),
    *("sqrt", "sin", "cos", "tan", "atan2", "wrap"),
)
_BARE = "in."
"""The grammar's signals have a point in their names."""


class Program:
    """Operations, each a name and two operands: earlier operations, a number, or an input's place.

    ``units`` are those of the inputs, by scalar, in their order. Results are SI.
    """

    def __init__(self, units: Mapping[str, str]) -> None:
        self.operations: list[list[Any]] = []
        self.observed: list[int] = []
        """The operations whose results are the observations."""
        self.nodes: list[ex.Expression] = []
        """The observations, of inputs in SI by `pointed`."""
        self._places = {name: place for place, name in enumerate(units)}
        self._units = {pointed(name): text for name, text in units.items()}
        self._known: dict[str, int] = {}
        bare = [re.escape(name) for name in units if "." not in name]
        self._names = re.compile(rf"(?<![\w.])({'|'.join(bare) or '(?!)'})(?![\w.(])")

    def add(self, text: str) -> str:
        """Add an observation, and return its unit. Raises InputError for what is none."""
        try:
            node = self._parsed(text)
            exponents = node.exponents(self._units)
            self.observed.append(self._of(node))
            self.nodes.append(node)
            return ex.unit_of(node, self._units, exponents)
        except InputError as error:
            raise InputError(str(error).replace(_BARE, "")) from None

    def _parsed(self, text: str) -> ex.Expression:
        node = number_of(self._names.sub(lambda match: _BARE + match[0], text))
        if is_of_record(node):
            raise InputError(f"{text!r}: that needs a whole record, and there is the present")
        for name in sorted(ex.signal_names(node)):
            if name not in self._units:
                raise InputError(unknown("input", name, self._places))
        return node

    def _of(self, node: ex.Expression) -> int:
        """Return the place of the operation whose result is a node's value."""
        if isinstance(node, ex.Literal):
            return self._operation("number", node.value)
        if isinstance(node, ex.Signal):
            return self._input(node.name)
        if node.name not in OPERATIONS:
            raise InputError(f"{node.name!r} is for criteria; {', '.join(OPERATIONS)} are known")
        places = [self._of(argument) for argument in node.arguments]
        found = self._operation(node.name, *places[:2])
        for place in places[2:]:  # of min and max, which take any number of values
            found = self._operation(node.name, found, place)
        return found

    def _input(self, name: str) -> int:
        """Return the place of an input in SI."""
        measure = unit(self._units[name])
        found = self._operation("input", self._places[name.removeprefix(_BARE)])
        if measure.factor != 1:
            found = self._operation("*", found, self._operation("number", float(measure.factor)))
        if measure.offset:
            found = self._operation("+", found, self._operation("number", float(measure.offset)))
        return found

    def _operation(self, name: str, a: float, b: float = 0) -> int:
        key = repr((name, a, b))
        if key not in self._known:
            self._known[key] = len(self.operations)
            self.operations.append([name, a, b])
        return self._known[key]


def number_of(text: str) -> ex.Expression:
    """Return an expression. Raises InputError for what is none."""
    parsed = tree(f"{text} >= 0")
    if not isinstance(parsed, Comparison):
        raise InputError(f"{text!r}: a number or signal is needed, got a condition")
    return parsed.left


def pointed(name: str) -> str:
    """Return the name of an input in expressions, which has a point."""
    return name if "." in name else f"{_BARE}{name}"
