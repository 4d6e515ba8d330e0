"""Criteria: what must hold in a trial, written over recorded signals with units.

Forms, with ``abs(hull.attitude.phi) < 10 deg`` as an example of a condition:

- ``CONDITION`` or ``always CONDITION``: holds in every row;
- ``finally CONDITION``: holds in the last row;
- ``within 5 s CONDITION``: holds in some row not later than 5 s after the start;
- ``EXPRESSION settles within 5 s``: stays, not later than 5 s after the start, in a band of
  5 % (or ``to 2 %``) about its final value.

``after 4 s`` ends any of them but ``finally`` and moves the start; ``from 4 s to 12 s`` ends
the forms with a condition. These are simulated times.

Conditions have ``< <= > >=``, ``and``, ``or``, ``not`` and parentheses; expressions have
``+ - * /``, ``abs``, ``max``, ``min``, ``sqrt``, signals and numbers with a unit written
without spaces (``0.5 m/s``, ``5 %``).

The band of ``settles`` is a share of the greatest distance that the signal has from its final
value anywhere in the record, whichever row the time is measured from: so the band is the same for
a step to a new value and for a push after which the signal comes back to where it was. The
final value is the last row's, so let the trial run until the signal rests.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal, TypeVar

import numpy as np
from lark import Lark, Token, Transformer, UnexpectedInput, v_args
from lark.exceptions import UnexpectedCharacters, UnexpectedToken

from ..errors import InputError, unknown
from ..fmi.cache import cache_folder
from ..units import unit
from . import expressions as ex
from .expressions import Comparison, Condition, Expression, FloatArray, Limit, Logic, Units
from .verdict import WHOLE, Span, Verdict, evaluate_condition, evaluate_settling

__all__ = ["Criterion", "Limit", "Verdict", "parse"]

GRAMMAR = r"""
start: _ALWAYS? condition window?             -> always
     | _FINALLY condition                     -> finally_
     | _WITHIN duration condition window?     -> within
     | sum _SETTLES _WITHIN duration settling -> settles

window: _AFTER duration                       -> window
      | _FROM duration _TO duration           -> window
settling: (band after?)?                      -> settling
        | after band?                         -> settling
band: _TO quantity
after: _AFTER duration
duration: quantity

?condition: conjunction
          | condition _OR conjunction         -> either
?conjunction: negation
            | conjunction _AND negation       -> both
?negation: comparison
         | _NOT negation                      -> negated
?comparison: sum
           | sum COMPARE sum                  -> comparison
?sum: product
    | sum SIGN product                        -> operation
?product: factor
        | product TIMES factor                -> operation
?factor: atom
       | SIGN factor                          -> signed
?atom: quantity
     | SIGNAL                                 -> signal
     | FUNCTION "(" sum ("," sum)* ")"        -> call
     | "(" condition ")"
quantity: NUMBER UNIT?

COMPARE: "<=" | ">=" | "<" | ">"
SIGN: "+" | "-"
TIMES: "*" | "/"
FUNCTION: /(abs|max|min|sqrt)(?=\s*\()/
NUMBER: /([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?/
SIGNAL: /[A-Za-z_][A-Za-z0-9_]*(-[A-Za-z0-9_]+)*(\.[A-Za-z0-9_]+)+/
UNIT: NO_KEYWORD UNIT_PART (("." | "/") UNIT_PART)*
NO_KEYWORD: /(?!(and|or|not|after|from|to|settles)\b)/
UNIT_PART: /(%|°|[A-Za-zµμΩ]+(-?[0-9])?)/
_ALWAYS: /always\b/
_FINALLY: /finally\b/
_WITHIN: /within\b/
_SETTLES: /settles\b/
_AFTER: /after\b/
_FROM: /from\b/
_TO: /to\b/
_AND: /and\b/
_OR: /or\b/
_NOT: /not\b/
%ignore /\s+/
"""

_EXPECTED = {
    "COMPARE": "a comparison (< <= > >=)",
    "SIGN": "an operator (+ - * /)",
    "TIMES": "an operator (+ - * /)",
    "FUNCTION": "a function (abs, max, min, sqrt)",
    "NUMBER": "a number",
    "SIGNAL": "a signal such as hull.position.z",
    "UNIT": "a unit",
    "LPAR": "'('",
    "RPAR": "')'",
    "COMMA": "','",
    "$END": "the end",
}
DEFAULT_BAND = 0.05

Form = Literal["always", "finally", "within", "settles"]
Node = TypeVar("Node", bound=Condition | Expression)


@dataclass(frozen=True)
class Criterion:
    """A parsed criterion; make one with `parse`.

    ``subject`` is the condition, or the expression that must settle; ``band`` the share that
    is regarded as settled.
    """

    text: str
    form: Form
    subject: Condition | Expression
    span: Span = WHOLE
    band: float = DEFAULT_BAND

    @property
    def signals(self) -> set[str]:
        """Names of the signals that the criterion needs."""
        return ex.signal_names(self.subject)

    def check_units(self, units: Units) -> None:
        """Check signals and dimensions against ``units``, unit by name of every signal there is.

        Raises InputError, naming the criterion, for a signal that is not recorded, a unit that
        is none, or values compared or added that do not measure the same.
        """
        try:
            for name in sorted(self.signals):
                if name not in units:
                    raise InputError(unknown("signal", name, units))
            if isinstance(self.subject, (Comparison, Logic)):
                self.subject.check(units)
            else:
                self.subject.exponents(units)
        except InputError as error:
            raise InputError(f"criterion {self.text!r}: {error}") from None

    def evaluate(self, time: FloatArray, signals: Mapping[str, Any], units: Units) -> Verdict:
        """Evaluate a record: ``time`` in s, ``signals`` in the units of ``units``.

        A record that is empty, too short or not all numbers does not pass, and the verdict says
        why. Raises InputError as `check_units` does, for a signal whose values are no numbers,
        and for columns that differ in length.
        """
        self.check_units(units)
        time = np.asarray(time, dtype=float)
        values = {name: self._column(name, signals, units, len(time)) for name in self.signals}
        subject, span = self.subject, self.span
        with np.errstate(all="ignore"):
            if isinstance(subject, (Comparison, Logic)):
                assert self.form != "settles"
                verdict = evaluate_condition(self.form, subject, span, time, values, units)
                return replace(verdict, limits=tuple(subject.limits()))
            return evaluate_settling(subject, self.band, span, time, values, units)

    def _column(
        self, name: str, signals: Mapping[str, Any], units: Units, length: int
    ) -> FloatArray:
        """Return a signal's values in SI."""
        if name not in signals:
            raise InputError(f"criterion {self.text!r}: {unknown('signal', name, signals)}")
        column = np.asarray(signals[name])
        # An empty column has no type worth looking at.
        if column.size and column.dtype.kind not in "biuf":
            raise InputError(f"criterion {self.text!r}: {name} holds text, not numbers")
        if column.shape != (length,):
            raise InputError(
                f"criterion {self.text!r}: {name} has {column.size} rows, the time has {length}"
            )
        measure = unit(units[name])
        return column.astype(float) * measure.factor + measure.offset


def parse(text: str) -> Criterion:
    """Return the criterion written ``text``.

    Raises InputError with the column and what was expected there; for a unit that is none; for
    a condition where a number belongs, or the reverse; if no signal occurs.
    """
    try:
        criterion: Criterion = _parser().parse(text)  # type: ignore[assignment]
    except UnexpectedInput as error:
        raise InputError(f"criterion {text!r}: {_syntax(text, error)}") from None
    except InputError as error:
        raise InputError(f"criterion {text!r}: {error}") from None
    if not criterion.signals:
        raise InputError(f"criterion {text!r}: names no signal")
    return replace(criterion, text=text)


@cache
def _parser() -> Lark:
    # The tables made of a grammar are kept: lark makes them again for another grammar or version.
    kept = cache_folder("grammars") / f"criteria-{sys.implementation.cache_tag}"
    return Lark(GRAMMAR, parser="lalr", transformer=_Builder(), cache=str(kept))


def _syntax(text: str, error: UnexpectedInput) -> str:
    """Return what is wrong where, and what would be right there."""
    at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
    position = len(text) if at_end else error.pos_in_stream or 0
    word = re.match(r"[\w.]+|.", text[position:], re.DOTALL)
    found = repr(word.group()) if word else "the end"
    assert isinstance(error, (UnexpectedToken, UnexpectedCharacters))
    accepted: set[str] = error.interactive_parser.accepts()  # type: ignore[no-untyped-call]
    if "NUMBER" in accepted:
        accepted.discard("SIGN")
    expected = sorted({_EXPECTED.get(n, repr(n.strip("_").lower())) for n in accepted})
    return f"column {position + 1}: found {found}, expected one of: {', '.join(expected)}"


@v_args(inline=True)
class _Builder(Transformer[Token, Criterion]):
    """Builds a criterion from the bottom up while lark parses."""

    # ------------------------------------------------------------------ forms

    def always(self, subject: Any, window: Span = WHOLE) -> Criterion:
        return Criterion("", "always", _condition(subject), window)

    def finally_(self, subject: Any) -> Criterion:
        return Criterion("", "finally", _condition(subject))

    def within(self, limit: float, subject: Any, window: Span = WHOLE) -> Criterion:
        return Criterion("", "within", _condition(subject), replace(window, within=limit))

    def settles(self, subject: Any, limit: float, settling: dict[str, float]) -> Criterion:
        span = Span(settling.get("after"), within=limit)
        band = settling.get("band", DEFAULT_BAND)
        return Criterion("", "settles", _expression(subject), span, band)

    def window(self, start: float, end: float | None = None) -> Span:
        if end is not None and end < start:
            raise InputError(f"the window ends at {end:g} s, before it starts at {start:g} s")
        return Span(start, end)

    def settling(self, *parts: tuple[str, float]) -> dict[str, float]:
        return dict(parts)

    def band(self, quantity: ex.Literal) -> tuple[str, float]:
        if unit(quantity.unit).exponents or not 0 < quantity.value < 1:
            raise InputError("the band of 'settles' is a share such as 'to 2 %'")
        return "band", quantity.value

    def after(self, start: float) -> tuple[str, float]:
        return "after", start

    def duration(self, quantity: ex.Literal) -> float:
        if unit(quantity.unit).exponents != {"s": 1}:
            raise InputError(f"a time such as '5 s' is needed, got one in {quantity.unit!r}")
        # To the nanosecond, as time is counted: 300 ms in doubles is not 0.3.
        return round(quantity.value, 9)

    # ------------------------------------------------------------------ conditions

    def either(self, left: Any, right: Any) -> Logic:
        return _shallow(Logic("or", (_condition(left), _condition(right))))

    def both(self, left: Any, right: Any) -> Logic:
        return _shallow(Logic("and", (_condition(left), _condition(right))))

    def negated(self, part: Any) -> Logic:
        return _shallow(Logic("not", (_condition(part),)))

    def comparison(self, left: Any, operator: Token, right: Any) -> Comparison:
        return _shallow(Comparison(str(operator), _expression(left), _expression(right)))

    # ------------------------------------------------------------------ expressions

    def operation(self, left: Any, operator: Token, right: Any) -> ex.Operation:
        arguments = (_expression(left), _expression(right))
        return _shallow(ex.Operation(str(operator), arguments))

    def signed(self, sign: Token, part: Any) -> Expression:
        part = _expression(part)
        return _shallow(ex.Operation("negative", (part,))) if sign == "-" else part

    def call(self, function: Token, *arguments: Any) -> ex.Operation:
        name = str(function)
        if name in ("abs", "sqrt") and len(arguments) != 1:
            raise InputError(f"{name} takes one value, got {len(arguments)}")
        return _shallow(ex.Operation(name, tuple(_expression(a) for a in arguments)))

    def signal(self, name: Token) -> ex.Signal:
        return ex.Signal(str(name))

    def quantity(self, value: Token, unit_text: Token | None = None) -> ex.Literal:
        return ex.literal(str(value), str(unit_text or "1"))


def _condition(node: Any) -> Condition:
    if not isinstance(node, (Comparison, Logic)):
        raise InputError("a comparison such as 'hull.position.z < 0.1 m' is needed, got a number")
    return node


def _expression(node: Any) -> Expression:
    if isinstance(node, (Comparison, Logic)):
        raise InputError("a number or signal is needed, got a comparison")
    result: Expression = node
    return result


def _shallow(node: Node) -> Node:
    """Return ``node``; raise InputError if it is too deep to walk without exhausting the stack."""
    if ex.depth(node) > ex.MAX_DEPTH:
        raise InputError(f"is nested or chained more than {ex.MAX_DEPTH} levels deep")
    return node
