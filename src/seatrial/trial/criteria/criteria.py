"""Criteria: what must hold in a trial, in signal temporal logic over recorded signals with units.

Forms:

- a formula of signal temporal logic, evaluated at the start of the run. One without an operator
  that looks ahead must hold at every point, as if ``always`` stood before it;
- ``EXPRESSION settles within 5 s``: stays, not later than 5 s after the start, in a band of
  5 % (or ``to 2 %``) about its final value; ``after 4 s`` moves the start.

Formulas have comparisons of expressions (``< <= > >=``), Boolean signals, ``port says "OK"`` and
``port is "AUTO"``; ``not``, ``and``, ``or``, ``implies``; ``always``, ``eventually``, ``until``,
``finally`` and, looking back, ``historically``, ``once``, ``since``. An interval ``[1 s, 5 s]`` or
``[1 s, end]`` after an operator counts from the point at which it is evaluated. Semantics, finite
records: `robustness`. Short for a condition X at times of the run:

- ``X after 4 s``: ``always[4 s, end] X``; ``X from 4 s to 12 s``: ``always[4 s, 12 s] X``;
- ``within 5 s X``: ``eventually[0 s, 5 s] X``, with ``after 4 s`` ``eventually[4 s, 9 s] X``;
- ``port says "OK" within 2 s``: ``eventually[0 s, 2 s] port says "OK"``.

What binds most comes first: ``not`` and the operators with one operand; ``until`` and ``since``;
``and``; ``or``; ``implies``.

Expressions have ``+ - * /``, functions of a point (`expressions`) and of the record (`metrics`),
signals and numbers with a unit written without spaces (``0.5 m/s``, ``5 %``).

The band of ``settles`` is a share of the greatest distance that the signal has from its final
value anywhere in the record, whichever row the time is measured from: so the band is the same for
a step to a new value and for a push after which the signal comes back to where it was. The
final value is the last row's, so let the trial run until the signal rests.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...errors import InputError, unknown
from ...model.units import unit
from . import expressions as ex
from . import formulas
from .expressions import FloatArray, Units
from .formulas import WHOLE, Formula, Temporal
from .grammar import tree
from .predicates import Kind, Limit, Record
from .settling import Settling, evaluate_settling
from .verdict import Verdict, evaluate_formula, flaw

__all__ = ["Criterion", "Limit", "Verdict", "parse"]


@dataclass(frozen=True)
class Criterion:
    """A parsed criterion: its text, and what it says; a formula is evaluated at the start."""

    text: str
    says: Formula | Settling
    paths: Mapping[str, str] = field(default_factory=dict)
    """Of signals whose names in the text are not those in ``says``."""

    @property
    def kinds(self) -> dict[str, set[Kind]]:
        """The signals that the criterion needs, each with what it is taken for."""
        if isinstance(self.says, Settling):
            return {name: {"number"} for name in ex.signal_names(self.says.subject)}
        return formulas.kinds(self.says)

    @property
    def signals(self) -> set[str]:
        """Names of the signals that the criterion needs."""
        return set(self.kinds)

    @property
    def condition(self) -> Formula | None:
        """What must hold at every point and is known there; None of any other criterion."""
        says = self.says
        if not isinstance(says, Temporal) or says.name != "always" or says.interval != WHOLE:
            return None
        return says.parts[0] if formulas.is_timeless(says.parts[0]) else None

    @property
    def goal(self) -> Formula | None:
        """What must hold at one point from the start on; None of any other criterion."""
        says = self.says
        if not isinstance(says, Temporal) or says.name != "eventually" or says.interval.first:
            return None
        return says.parts[0] if formulas.is_timeless(says.parts[0]) else None

    def renamed(self, names: Mapping[str, str]) -> Criterion:
        """Return the criterion with other names of signals; its text stays."""
        paths = {name: path for name, path in names.items() if path != name}
        if isinstance(self.says, Settling):
            subject = ex.renamed(self.says.subject, names)
            return replace(self, says=replace(self.says, subject=subject), paths=paths)
        return replace(self, says=formulas.renamed(self.says, names), paths=paths)

    def check_units(self, units: Units) -> None:
        """Check signals and dimensions against ``units``, unit by name of every signal there is.

        Raises InputError, naming the criterion, for a signal that is not recorded, a unit that
        is none, or values compared or added that do not measure the same.
        """
        try:
            for name in sorted(self.signals):
                if name not in units:
                    raise InputError(unknown("signal", name, units))
            if isinstance(self.says, Settling):
                self.says.subject.exponents(units)
            else:
                formulas.check(self.says, units)
        except InputError as error:
            raise InputError(f"criterion {self.text!r}: {error}") from None

    def evaluate(self, time: FloatArray, signals: Mapping[str, Any], units: Units) -> Verdict:
        """Evaluate a record: ``time`` in s, ``signals`` in the units of ``units``.

        A record that is empty, too short or not all numbers does not pass, and the verdict says
        why. Raises InputError as `check_units` does, for a signal whose values are not of the
        kind that is needed, and for columns that differ in length.
        """
        self.check_units(units)
        time = np.asarray(time, dtype=float)
        try:
            record = self.record(time, signals, units)
            lacks = flaw(record)
            if lacks:
                return Verdict(False, lacks)
            with np.errstate(all="ignore"):
                if isinstance(self.says, Settling):
                    return evaluate_settling(self.says, record, units)
                verdict = evaluate_formula(self.says, record, units)
                return replace(verdict, limits=tuple(formulas.limits(self.says)))
        except InputError as error:
            raise InputError(f"criterion {self.text!r}: {error}") from None

    def record(self, time: FloatArray, signals: Mapping[str, Any], units: Units) -> Record:
        """Return the columns that are needed, numbers in SI. Raises InputError."""
        numbers, texts = dict[str, FloatArray](), dict[str, list[str]]()
        for name, wanted in self.kinds.items():
            if name not in signals:
                raise InputError(unknown("signal", name, signals))
            if len(signals[name]) != len(time):
                raise InputError(f"{name} has {len(signals[name])} rows, the time has {len(time)}")
            if "text" in wanted:
                texts[name] = _texts(name, signals[name])
            if wanted != {"text"}:
                numbers[name] = _numbers(name, signals[name], units[name])
        return Record(time, numbers, texts)


def _numbers(name: str, column: Any, unit_text: str) -> FloatArray:
    """Return a column in SI."""
    column = np.asarray(column)
    # An empty column has no type worth looking at.
    if column.size and column.dtype.kind not in "biuf":
        raise InputError(f"{name} holds text, not numbers")
    measure = unit(unit_text)
    numbers: FloatArray = column.astype(float) * measure.factor + measure.offset
    return numbers


def _texts(name: str, column: Any) -> list[str]:
    texts = list(column)
    if not all(isinstance(value, str) for value in texts):
        raise InputError(f"{name} holds no text")
    return texts


def parse(text: str) -> Criterion:
    """Return the criterion written ``text``.

    Raises InputError with the column and what was expected there; for a unit that is none; for
    a condition where a number belongs, or the reverse; if no signal occurs; for what looks ahead
    joined with what does not, outside of an operator that says when.
    """
    try:
        says = tree(text)
        if not isinstance(says, Settling):
            says = _from_the_start(says)
    except InputError as error:
        raise InputError(f"criterion {text!r}: {error}") from None
    criterion = Criterion(text, says)
    if not criterion.signals:
        raise InputError(f"criterion {text!r}: names no signal")
    return criterion


def _from_the_start(node: Formula) -> Formula:
    """Return the formula that the start of a run must meet."""
    if not formulas.looks_ahead(node):
        return Temporal("always", WHOLE, (node,))
    if formulas.from_the_start(node):
        return node
    raise InputError(
        "joins what looks ahead with what does not: write 'always (...)' for every point, or "
        "'always' before the part that is meant so"
    )
