"""Arithmetic over recorded signals, with units: what the predicates of a criterion compare.

Every value is SI while it is computed. An angle is a unit of its own, as in FMI: a product of
an angular velocity and a length is ``m.rad/s``, and ``/ 1 rad`` makes it a velocity.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...model.readable import person_unit, quantity_text
from ...model.units import unit
from ...plugins import Registry

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Value = float | FloatArray
Values = Mapping[str, FloatArray]
Units = Mapping[str, str]
Exponents = dict[str, int]


@dataclass(frozen=True)
class Literal:
    """A number with its unit; ``value`` is SI."""

    value: float
    unit: str

    def leaves(self) -> Iterator[Literal | Signal]:
        """Yield this literal."""
        yield self

    def exponents(self, units: Units) -> Exponents:
        """Return the exponents of the base units."""
        return unit(self.unit).exponents

    def evaluate(self, values: Values) -> Value:
        """Return the SI value."""
        return self.value


@dataclass(frozen=True)
class Signal:
    """A recorded signal."""

    name: str

    def leaves(self) -> Iterator[Literal | Signal]:
        """Yield this signal."""
        yield self

    def exponents(self, units: Units) -> Exponents:
        """Return the exponents of the base units."""
        return unit(units[self.name]).exponents

    def evaluate(self, values: Values) -> Value:
        """Return the SI values."""
        return values[self.name]


@dataclass(frozen=True)
class Operation:
    """An operator or function applied to expressions."""

    name: str
    arguments: tuple[Expression, ...]

    @property
    def when(self) -> str:
        """Which part of the record it is about, as it is written; nothing of a single point."""
        return ""

    def leaves(self) -> Iterator[Literal | Signal]:
        """Yield all literals and signals, from left to right."""
        for argument in self.arguments:
            yield from argument.leaves()

    def exponents(self, units: Units) -> Exponents:
        """Return the exponents of the base units.

        Raises InputError if the arguments' units do not go together.
        """
        rule = rule_of(self.name).rule
        return rule(self, [a.exponents(units) for a in self.arguments], units)

    def evaluate(self, values: Values) -> Value:
        """Return the SI values."""
        result: Value = rule_of(self.name).function(*[a.evaluate(values) for a in self.arguments])
        return result


Expression = Literal | Signal | Operation


def signal_names(node: Expression) -> set[str]:
    """Return the names of all signals that occur in ``node``."""
    return {leaf.name for leaf in node.leaves() if isinstance(leaf, Signal)}


def renamed(node: Expression, names: Mapping[str, str]) -> Expression:
    """Return an expression with other names of signals."""
    if isinstance(node, Signal):
        return Signal(names[node.name])
    if isinstance(node, Literal):
        return node
    return replace(node, arguments=tuple(renamed(argument, names) for argument in node.arguments))


def written(node: Expression) -> str:
    """Return an expression as a person could have written it; numbers in their unit."""
    if isinstance(node, Signal):
        return node.name
    if isinstance(node, Literal):
        measure = unit(node.unit)
        return quantity_text((node.value - measure.offset) / measure.factor, node.unit, 6)
    parts = [written(argument) for argument in node.arguments]
    if node.name not in _OPERATORS:
        bare = [
            part[1:-1] if isinstance(argument, Operation) and argument.name in "+-*/" else part
            for part, argument in zip(parts, node.arguments, strict=True)
        ]
        return f"{node.name}({', '.join(bare)}{node.when})"
    if node.name == "negative":
        return f"-{parts[0]}"
    return f"({f' {node.name} '.join(parts)})"


def depth(node: Expression) -> int:
    """Return how many levels the tree has."""
    if isinstance(node, (Literal, Signal)):
        return 1
    return 1 + max(depth(part) for part in node.arguments)


class _Leafy(Protocol):
    def leaves(self) -> Iterator[Literal | Signal]: ...


def unit_of(node: _Leafy, units: Units, exponents: Exponents) -> str:
    """Return the unit in which a person would state values of ``node``.

    That is the unit of its first literal that measures the same, else of such a signal (degrees
    for radians), else the product of base units.
    """
    leaves = sorted(node.leaves(), key=lambda leaf: isinstance(leaf, Signal))
    for leaf in leaves:
        text = leaf.unit if isinstance(leaf, Literal) else person_unit(units[leaf.name])
        if unit(text).exponents == exponents:
            return text
    return person_unit(_product_text(exponents))


# ---------------------------------------------------------------------- units of operations


def same_kind(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
    """Return the exponents of values of one kind. Raises InputError for different ones."""
    first = node.arguments[0]
    for argument, own in zip(node.arguments[1:], exponents[1:], strict=True):
        check_same(f"{node.name!r}", (first, exponents[0]), (argument, own), units)
    return exponents[0]


def _product(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
    return combined(exponents[0], exponents[1], 1)


def _quotient(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
    return combined(exponents[0], exponents[1], -1)


def _root(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
    if any(power % 2 for power in exponents[0].values()):
        raise InputError(f"{unit_of(node.arguments[0], units, exponents[0])!r} has no square root")
    return {base: power // 2 for base, power in exponents[0].items()}


def combined(a: Exponents, b: Exponents, sign: int) -> Exponents:
    """Return the exponents of a product, ``sign`` 1, or of a quotient, -1."""
    powers = {base: a.get(base, 0) + sign * b.get(base, 0) for base in a | b}
    return {base: power for base, power in powers.items() if power}


def _product_text(exponents: Exponents) -> str:
    # Positive powers first: a leading one lets a person's unit stand in for rad.
    powers = sorted(exponents.items(), key=lambda item: item[1] < 0)
    return ".".join(b if p == 1 else f"{b}{p}" for b, p in powers) or "1"


def check_same(
    what: str, a: tuple[Expression, Exponents], b: tuple[Expression, Exponents], units: Units
) -> None:
    """Raise InputError, with both units, if two expressions do not measure the same."""
    if a[1] != b[1]:
        left, right = (_described(node, exponents, units) for node, exponents in (a, b))
        raise InputError(f"{what} needs values of one kind, got {left} and {right}")


def _described(node: Expression, exponents: Exponents, units: Units) -> str:
    if isinstance(node, Signal):
        return f"{node.name} in {units[node.name]!r}"
    text = node.unit if isinstance(node, Literal) else unit_of(node, units, exponents)
    return "a number without a unit" if text == "1" else f"a value in {text!r}"


class Rule(NamedTuple):
    """An operator or function: NumPy's arithmetic, and what becomes of the units."""

    function: Callable[..., Any]
    rule: Callable[[Operation, list[Exponents], Units], Exponents]
    arguments: int | None = None
    """How many it takes; None: any number."""


def _greatest(*values: Value) -> Any:
    return np.maximum.reduce(np.broadcast_arrays(*values))


def _least(*values: Value) -> Any:
    return np.minimum.reduce(np.broadcast_arrays(*values))


def _wrapped(angle: Value) -> Any:
    """Return an angle in (-pi, pi]."""
    return math.pi - np.mod(math.pi - np.asarray(angle), math.tau)


def _of_angle(found: Exponents) -> Callable[[Operation, list[Exponents], Units], Exponents]:
    def rule(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
        if exponents[0] != _ANGLE:
            argument = _described(node.arguments[0], exponents[0], units)
            raise InputError(f"{node.name!r} needs an angle, got {argument}")
        return found

    return rule


def _to_angle(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
    same_kind(node, exponents, units)
    return _ANGLE


def _distance(north: Value, east: Value, *places: float) -> Any:
    """Return the distance from a path through places, north and east of each."""
    corners = np.reshape([float(each) for each in places], (-1, 2))
    at = np.stack(np.broadcast_arrays(np.asarray(north, float), east), axis=-1)
    found = [np.hypot(*np.moveaxis(at - corner, -1, 0)) for corner in corners[:1]]
    for begin, end in pairwise(corners):
        along = end - begin
        length2 = float(along @ along) or 1.0
        share = np.clip(((at - begin) @ along) / length2, 0.0, 1.0)
        found.append(np.hypot(*np.moveaxis(at - begin - share[..., None] * along, -1, 0)))
    return np.minimum.reduce(found)


def _of_path(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
    places = node.arguments[2:]
    if len(places) < 2 or len(places) % 2 or any(signal_names(place) for place in places):
        raise InputError(
            f"{node.name} needs north and east, and behind them north and east of each place of "
            f"the path as numbers, got {len(node.arguments)} values"
        )
    return same_kind(node, exponents, units)


_ANGLE: Exponents = {"rad": 1}
_OPERATIONS = {
    "+": Rule(np.add, same_kind),
    "-": Rule(np.subtract, same_kind),
    "*": Rule(np.multiply, _product),
    "/": Rule(np.divide, _quotient),
    "negative": Rule(np.negative, same_kind),
    "abs": Rule(np.abs, same_kind, 1),
    "max": Rule(_greatest, same_kind),
    "min": Rule(_least, same_kind),
    "sqrt": Rule(np.sqrt, _root, 1),
    "sin": Rule(np.sin, _of_angle({}), 1),
    "cos": Rule(np.cos, _of_angle({}), 1),
    "tan": Rule(np.tan, _of_angle({}), 1),
    "atan2": Rule(np.arctan2, _to_angle, 2),
    "wrap": Rule(_wrapped, _of_angle(_ANGLE), 1),
    "cross_track": Rule(_distance, _of_path),
}
_OPERATORS = ("+", "-", "*", "/", "negative")
OF_KITS = Registry("seatrial.criteria", "function of criteria", {})
"""Functions that kits add: each a `Rule`."""


def functions() -> list[str]:
    """Return the names of all functions of single points."""
    return sorted({*_OPERATIONS, *OF_KITS.names()} - {*_OPERATORS})


def rule_of(name: str) -> Rule:
    """Return an operator or function. Raises InputError for one of a kit that is not to be had."""
    if name in _OPERATIONS:
        return _OPERATIONS[name]
    return cast(Rule, OF_KITS.load(name))


def literal(text: str, unit_text: str) -> Literal:
    """Return the literal ``text`` in the unit ``unit_text``.

    Raises InputError if that is no unit or the value is not finite.
    """
    measure = unit(unit_text)
    try:
        value = float(text) * measure.factor + measure.offset
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise InputError(f"{text} {unit_text} is not a finite number")
    return Literal(value, unit_text)
