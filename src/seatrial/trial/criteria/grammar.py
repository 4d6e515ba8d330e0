"""The language of criteria: its grammar, and text to trees. `criteria` says what it means."""

from __future__ import annotations

import re
import sys
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from lark import Lark, Token, Transformer, UnexpectedInput, v_args
from lark.exceptions import UnexpectedCharacters, UnexpectedToken

from ...errors import InputError
from ...fmi.cache import cache_folder
from ...model.units import unit
from . import expressions as ex
from . import formulas
from .expressions import Expression
from .formulas import WHOLE, Formula, Interval, Logic, Temporal, Until
from .metrics import ALL, metric
from .predicates import Comparison, Says, Truth
from .settling import DEFAULT_BAND, Settling

DATA_FILES = ("grammar.lark",)
MAX_DEPTH = 100

_EXPECTED = {
    "COMPARE": "a comparison (< <= > >=)",
    "SIGN": "an operator (+ - * /)",
    "TIMES": "an operator (+ - * /)",
    "OVER": "'always', 'eventually', 'once', 'historically'",
    "BETWEEN": "'until', 'since'",
    "VERB": "'says', 'is'",
    "TEXT": 'a text such as "OK"',
    "NUMBER": "a number",
    "SIGNAL": "a signal such as hull.position.z",
    "UNIT": "a unit",
    "LPAR": "'('",
    "RPAR": "')'",
    "LSQB": "'['",
    "RSQB": "']'",
    "COMMA": "','",
    "$END": "the end",
}
Node = TypeVar("Node")


def tree(text: str) -> Formula | Settling:
    """Return what a criterion says, as it is written. Raises InputError."""
    try:
        parsed: Formula | Settling = _parser().parse(text)  # type: ignore[assignment]
    except UnexpectedInput as error:
        raise InputError(_syntax(text, error)) from None
    return parsed


@cache
def _parser() -> Lark:
    # The tables made of a grammar are kept: lark makes them again for another grammar or version.
    kept = cache_folder("grammars") / f"criteria-{sys.implementation.cache_tag}"
    text = Path(__file__).with_name(DATA_FILES[0]).read_text("utf-8")
    grammar = text.replace("@FUNCTIONS@", "|".join(map(re.escape, _functions())))
    return Lark(grammar, parser="lalr", transformer=_Builder(), cache=str(kept))


def _functions() -> list[str]:
    return sorted([*ex.functions(), *ALL])


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
    said = {**_EXPECTED, "FUNCTION": f"a function ({', '.join(_functions())})"}
    expected = sorted({said.get(n, repr(n.strip("_").lower())) for n in accepted})
    return f"column {position + 1}: found {found}, expected one of: {', '.join(expected)}"


@v_args(inline=True)
class _Builder(Transformer[Token, "Formula | Settling"]):
    """Builds the tree from the bottom up while lark parses."""

    def whole(self, node: Any, window: Interval | None = None) -> Formula:
        formula = _formula(node)
        if window is None:
            return formula
        if isinstance(formula, Temporal) and (formula.name, formula.interval) == ("always", WHOLE):
            formula = formula.parts[0]
        return _shallow(Temporal("always", window, (_at_a_point(formula),)))

    def within(self, limit: float, node: Any, window: Interval = WHOLE) -> Formula:
        last = round(window.first + limit, 9)
        interval = Interval(window.first, last if window.last is None else min(last, window.last))
        return _shallow(Temporal("eventually", interval, (_at_a_point(_formula(node)),)))

    def window(self, first: float, last: float | None = None) -> Interval:
        return self.interval(first, last)

    def settles(self, subject: Any, limit: float, settling: dict[str, float]) -> Settling:
        band = settling.get("band", DEFAULT_BAND)
        return Settling(_expression(subject), limit, settling.get("after", 0.0), band)

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

    # ------------------------------------------------------------------ formulas

    def interval(self, first: float, last: float | None = None) -> Interval:
        if last is not None and last < first:
            raise InputError(f"the interval ends at {last:g} s, before it starts at {first:g} s")
        return Interval(first, last)

    def over(self, name: Token, *rest: Any) -> Temporal:
        *interval, part = rest
        return _shallow(Temporal(_name(name), _interval(interval), (_formula(part),)))

    def finally_(self, part: Any) -> Temporal:
        return _shallow(Temporal("finally", WHOLE, (_formula(part),)))

    def between(self, first: Any, name: Token, *rest: Any) -> Until:
        *interval, second = rest
        parts = (_formula(first), _formula(second))
        return _shallow(Until(_name(name), _interval(interval), parts))

    def implied(self, left: Any, right: Any) -> Logic:
        return _shallow(Logic("implies", (_formula(left), _formula(right))))

    def either(self, left: Any, right: Any) -> Logic:
        return _shallow(Logic("or", (_formula(left), _formula(right))))

    def both(self, left: Any, right: Any) -> Logic:
        return _shallow(Logic("and", (_formula(left), _formula(right))))

    def negated(self, part: Any) -> Logic:
        return _shallow(Logic("not", (_formula(part),)))

    def comparison(self, left: Any, operator: Token, right: Any) -> Comparison:
        return _shallow(Comparison(str(operator), _expression(left), _expression(right)))

    def says(self, name: Token, verb: Token, text: Token, *limit: float) -> Formula:
        wanted = re.sub(r"\\(.)", _unescaped, text[1:-1])
        if not wanted and verb == "says":
            raise InputError("'says' needs a text that is not empty")
        predicate = Says(str(name), _name(verb), wanted)
        if not limit:
            return predicate
        return Temporal("eventually", Interval(0.0, limit[0]), (predicate,))

    # ------------------------------------------------------------------ expressions

    def operation(self, left: Any, operator: Token, right: Any) -> ex.Operation:
        arguments = (_expression(left), _expression(right))
        return _shallow(ex.Operation(str(operator), arguments))

    def signed(self, sign: Token, part: Any) -> Expression:
        part = _expression(part)
        return _shallow(ex.Operation("negative", (part,))) if sign == "-" else part

    def call(self, function: Token, *rest: Any) -> ex.Operation:
        name = str(function)
        window = rest[-1] if isinstance(rest[-1], Interval) else None
        arguments = rest if window is None else rest[:-1]
        taken = (ALL[name] if name in ALL else ex.rule_of(name)).arguments
        if taken is not None and len(arguments) != taken:
            values = "one value" if taken == 1 else f"{taken} values"
            raise InputError(f"{name} takes {values}, got {len(arguments)}")
        given = tuple(_expression(a) for a in arguments)
        if name in ALL:
            return _shallow(metric(name, given, window))
        if window is not None:
            raise InputError(f"{name} is of single points: it takes no 'after' and no 'from'")
        return _shallow(ex.Operation(name, given))

    def signal(self, name: Token) -> ex.Signal:
        return ex.Signal(str(name))

    def quantity(self, value: Token, unit_text: Token | None = None) -> ex.Literal:
        return ex.literal(str(value), str(unit_text or "1"))


def _name(token: Token) -> Any:
    return str(token)


def _interval(found: list[Interval]) -> Interval:
    return found[0] if found else WHOLE


def _unescaped(found: re.Match[str]) -> str:
    return {"n": "\n", "r": "\r", "t": "\t"}.get(found[1], found[1])


def _is_formula(node: Any) -> bool:
    return isinstance(node, (*formulas.PREDICATES, Logic, Temporal, Until))


def _formula(node: Any) -> Formula:
    if isinstance(node, ex.Signal):
        return Truth(node.name)
    if not _is_formula(node):
        raise InputError("a comparison such as 'hull.position.z < 0.1 m' is needed, got a number")
    result: Formula = node
    return result


def _at_a_point(node: Formula) -> Formula:
    """Return a formula that 'after', 'from' and 'within' say the times of."""
    if formulas.looks_ahead(node):
        raise InputError("'after', 'from' and 'within' go with a condition that looks not ahead")
    return node


def _expression(node: Any) -> Expression:
    if _is_formula(node):
        raise InputError("a number or signal is needed, got a comparison")
    result: Expression = node
    return result


def _shallow(node: Node) -> Node:
    """Return ``node``; raise InputError if it is too deep to walk without exhausting the stack."""
    levels = formulas.depth(node) if _is_formula(node) else ex.depth(node)  # type: ignore[arg-type]
    if levels > MAX_DEPTH:
        raise InputError(f"is nested or chained more than {MAX_DEPTH} levels deep")
    return node
