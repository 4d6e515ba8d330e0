"""Predicates of criteria: comparisons, Boolean signals, and what a text port says.

A predicate has a margin at every row of a record: positive where it holds, negative where it does
not, never zero. So one number is both the truth and the distance from the other truth.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Literal, NamedTuple, cast

import numpy as np

from ...errors import InputError
from ...links.text import decode
from ...model.readable import distinct, from_si
from . import expressions as ex
from .expressions import BoolArray, Expression, FloatArray, Operation, Signal, Units, Values
from .metrics import TIME, is_constant, is_of_record

TINY = 5e-324
"""The least margin there is: of a limit that is met exactly."""

Kind = Literal["number", "truth", "text"]


class Limit(NamedTuple):
    """A bound that a criterion puts on one signal, to be drawn into its plot."""

    signal: str
    value: float
    """SI."""
    kind: str
    """``max``, ``min``, or ``band`` for an edge of the band in which the signal must settle."""


@dataclass(frozen=True)
class Record:
    """What predicates are evaluated on: ``time``, s, rising; columns of the same length."""

    time: FloatArray
    numbers: Values
    """SI; a Boolean is 0 or 1."""
    texts: Mapping[str, list[str]] = field(default_factory=dict)

    @cached_property
    def values(self) -> Values:
        """What expressions are evaluated on: ``numbers``, and the time."""
        return {**self.numbers, TIME: self.time}


@dataclass(frozen=True)
class Telling:
    """What a predicate had at one row."""

    text: str
    """For a person."""
    limit: str = ""
    """What ``text`` is compared with; nothing if the predicate has no distance."""
    value: float | None = None
    unit: str = "1"


@dataclass(frozen=True)
class Comparison:
    """``left < right`` or ``<= > >=``.

    ``measured`` is the side with signals (the left one if both have some), ``bound`` the other.
    """

    operator: str
    left: Expression
    right: Expression

    @property
    def measured(self) -> Expression:
        """The side that varies."""
        return self.left if ex.signal_names(self.left) else self.right

    @property
    def bound(self) -> Expression:
        """The side that the measured one is compared with."""
        return self.right if ex.signal_names(self.left) else self.left

    @property
    def kind(self) -> str:
        """``max`` if the measured side must stay below the bound, else ``min``."""
        return "max" if (self.measured is self.left) == (self.operator in ("<", "<=")) else "min"

    @property
    def kinds(self) -> dict[str, Kind]:
        """The kind of each signal."""
        return dict.fromkeys(ex.signal_names(self.left) | ex.signal_names(self.right), "number")

    @property
    def scale(self) -> float | None:
        """Magnitude of a fixed bound that is not zero, SI: margins are shares of it."""
        if ex.signal_names(self.bound):
            return None
        bound = abs(float(self.bound.evaluate({})))
        return bound if bound and math.isfinite(bound) else None

    @property
    def is_timeless(self) -> bool:
        """Whether a point alone decides it."""
        return not (is_of_record(self.left) or is_of_record(self.right))

    @property
    def is_constant(self) -> bool:
        """Whether it is of the record, and of no point in it."""
        return is_constant(self.left) and is_constant(self.right)

    def leaves(self) -> Iterator[ex.Literal | Signal]:
        """Yield all literals and signals, from left to right."""
        yield from self.left.leaves()
        yield from self.right.leaves()

    def depth(self) -> int:
        """Return how many levels the tree has."""
        return 1 + max(ex.depth(self.left), ex.depth(self.right))

    def renamed(self, names: Mapping[str, str]) -> Comparison:
        """Return the comparison with other names of signals."""
        return Comparison(
            self.operator, ex.renamed(self.left, names), ex.renamed(self.right, names)
        )

    def check(self, units: Units) -> None:
        """Raise InputError if the two sides do not measure the same."""
        left, right = self.left.exponents(units), self.right.exponents(units)
        ex.check_same(f"{self.operator!r}", (self.left, left), (self.right, right), units)

    def margins(self, record: Record) -> tuple[FloatArray, FloatArray]:
        """Return lower and upper margins: shares of a fixed bound, else SI; see the module.

        They differ where a side is no finite number: nothing is known there.
        """
        left, right = (self._course(side, record) for side in (self.left, self.right))
        holds: BoolArray = _COMPARE[self.operator](left, right)
        distance = np.abs(left - right) / (self.scale or 1.0)
        margin = np.where(holds, np.maximum(distance, TINY), -np.maximum(distance, TINY))
        known = np.isfinite(left) & np.isfinite(right)
        if known.all():
            return margin, margin
        return np.where(known, margin, -np.inf), np.where(known, margin, np.inf)

    def holds_of(self, values: Mapping[str, float]) -> bool:
        """Say if it holds of single values, both sides finite: `margins` is then positive."""
        of_one = cast("ex.Values", values)  # NumPy's functions take a number for an array
        left, right = (float(side.evaluate(of_one)) for side in (self.left, self.right))
        known = math.isfinite(left) and math.isfinite(right)
        return known and bool(_COMPARE[self.operator](left, right))

    def undefined(self, record: Record) -> FloatArray | None:
        """Return the values of a side that is not finite everywhere, if one is."""
        for side in (self.left, self.right):
            course = self._course(side, record)
            if not np.isfinite(course).all():
                return course
        return None

    def telling(self, record: Record, row: int, units: Units) -> Telling:
        """Return both sides at a row, in the unit in which a person would state them."""
        unit = ex.unit_of(self, units, self.left.exponents(units))
        measured, bound = (
            from_si(float(self._course(side, record)[row]), unit)
            for side in (self.measured, self.bound)
        )
        text, limit = distinct(measured, bound, unit)
        return Telling(text, limit, measured, unit)

    def limits(self) -> list[Limit]:
        """Return the bounds on single signals, where the comparison is as simple as that."""
        if ex.signal_names(self.bound):
            return []
        bound = float(self.bound.evaluate({}))
        return _limits(self.measured, bound, self.kind) if math.isfinite(bound) else []

    def _course(self, side: Expression, record: Record) -> FloatArray:
        course = np.asarray(side.evaluate(record.values), dtype=float)
        return np.broadcast_to(course, record.time.shape)


@dataclass(frozen=True)
class Truth:
    """A Boolean signal. It has no distance: its margin is infinite."""

    name: str

    is_timeless: ClassVar = True
    is_constant: ClassVar = False

    @property
    def kinds(self) -> dict[str, Kind]:
        """The kind of its signal."""
        return {self.name: "truth"}

    def depth(self) -> int:
        """Return how many levels the tree has."""
        return 1

    def renamed(self, names: Mapping[str, str]) -> Truth:
        """Return the predicate with another name of its signal."""
        return Truth(names[self.name])

    def check(self, units: Units) -> None:
        """Check nothing: a Boolean has no unit."""

    def margins(self, record: Record) -> tuple[FloatArray, FloatArray]:
        """Return lower and upper margins: ± infinity. Raises InputError for other numbers."""
        values = record.numbers[self.name]
        if not np.isin(values, (0.0, 1.0)).all():
            raise InputError(f"{self.name} is a number: compare it, as in '{self.name} > 0.5'")
        margin = np.where(values > 0.5, np.inf, -np.inf)
        return margin, margin

    def undefined(self, record: Record) -> None:
        """Return None: a Boolean is always known."""

    def telling(self, record: Record, row: int, units: Units) -> Telling:
        """Return the value at a row."""
        return Telling(f"{self.name} is {'true' if record.numbers[self.name][row] else 'false'}")

    def limits(self) -> list[Limit]:
        """Return no bounds."""
        return []


@dataclass(frozen=True)
class Says:
    """``port says "OK"``, or ``port is "OK"``: see `said_at`. Its margin is infinite."""

    name: str
    verb: Literal["says", "is"]
    text: str

    is_timeless: ClassVar = True
    is_constant: ClassVar = False

    @property
    def kinds(self) -> dict[str, Kind]:
        """The kind of its signal."""
        return {self.name: "text"}

    def depth(self) -> int:
        """Return how many levels the tree has."""
        return 1

    def renamed(self, names: Mapping[str, str]) -> Says:
        """Return the predicate with another name of its signal."""
        return Says(names[self.name], self.verb, self.text)

    def check(self, units: Units) -> None:
        """Check nothing: a text has no unit."""

    def margins(self, record: Record) -> tuple[FloatArray, FloatArray]:
        """Return lower and upper margins: ± infinity."""
        margin = np.where(self._holds(record), np.inf, -np.inf)
        return margin, margin

    def undefined(self, record: Record) -> None:
        """Return None: a text is always known."""

    def telling(self, record: Record, row: int, units: Units) -> Telling:
        """Return whether it holds at a row."""
        if self._holds(record)[row]:
            return Telling(f'{self.name} {self.verb} "{self.text}"')
        column = record.texts[self.name]
        if self.verb == "is":
            return Telling(f'{self.name} is "{column[row]}", not "{self.text}"')
        said = last_said(column)
        ends = f', what it says ends with "{said}"' if said else ", it says nothing"
        return Telling(f'{self.name} does not say "{self.text}"{ends}')

    def limits(self) -> list[Limit]:
        """Return no bounds."""
        return []

    def _holds(self, record: Record) -> BoolArray:
        column = record.texts[self.name]
        if self.verb == "is":
            return np.array([value == self.text for value in column], dtype=bool)
        return said_at(column, self.text)


Predicate = Comparison | Truth | Says

_COMPARE: dict[str, Callable[..., Any]] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
}


def _limits(measured: Expression, bound: float, kind: str) -> list[Limit]:
    if isinstance(measured, Signal):
        return [Limit(measured.name, bound, kind)]
    if not isinstance(measured, Operation):
        return []
    name, arguments = measured.name, measured.arguments
    if name == "negative":
        return _limits(arguments[0], -bound, "min" if kind == "max" else "max")
    if name == "abs" and kind == "max":
        return [*_limits(arguments[0], bound, "max"), *_limits(arguments[0], -bound, "min")]
    if name == kind:
        # The greatest stays below a bound if each one does, the least above it likewise.
        return [limit for a in arguments for limit in _limits(a, bound, kind)]
    return []


def said_at(column: Sequence[str], text: str) -> BoolArray:
    """Return at which rows a port says ``text``.

    A port that carries bytes (`links.text`) says it where the last byte of it leaves: the bytes
    are one stream, however they were cut into chunks. Any other port says it as long as its
    value contains it. Text is compared as UTF-8.
    """
    if not is_stream(column):
        return np.array([text in value for value in column], dtype=bool)
    wanted = text.encode()
    said = np.zeros(len(column), dtype=bool)
    before = b""
    for row, data in received(column):
        stream = before + data
        said[row] = wanted in stream
        before = stream[-(len(wanted) - 1) :] if len(wanted) > 1 else b""
    return said


def is_stream(column: Sequence[str]) -> bool:
    """Return whether a column is what a port of bytes holds: numbered chunks, at least one."""
    values = set(column) - {""}
    found = False
    for value in values:
        try:
            found |= bool(decode(value)[1])
        except InputError:
            return False
    return found


def received(column: Sequence[str]) -> Iterator[tuple[int, bytes]]:
    """Yield the rows at which bytes arrive, and those bytes."""
    sequence = 0
    for row, value in enumerate(column):
        if row and value is column[row - 1]:
            continue
        number, chunks = decode(value)
        if number > sequence:
            sequence = number
            yield row, b"".join(data for _, data in chunks)


def last_said(column: Sequence[str], length: int = 80) -> str:
    """Return the end of what a port has said, for a person; control characters as escapes."""
    said = b"".join(data for _, data in received(column)) if is_stream(column) else b""
    with suppress(IndexError):
        said = said or column[-1].encode()
    tail = said[-length:].decode(errors="replace")
    return re.sub(r"[\x00-\x1f\x7f]", lambda found: repr(found.group())[1:-1], tail)
