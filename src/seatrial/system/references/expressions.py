"""Expressions in files, ``"= 0.5 * hull.mass"``: their grammar, and their value with units.

A text that begins with ``=`` has numbers, names, ``+ - * / **``, parentheses, ``sqrt``, ``min``,
``max`` and ``pi``. A name has letters, digits, ``_``, dots, and inside ``-``: the minus of a
difference has a blank before it. A vector takes a sign, a scalar factor or divisor, and a sum with
one of as many elements; all else is of scalars.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from typing import Any

from ...errors import InputError, unknown
from .quantities import Amount, number

Value = Amount | tuple[Amount, ...]
"""A scalar or a vector."""

_LONGEST = 1000
_DEEPEST = 40
_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
    r"|(?P<name>\.?[A-Za-z_]\w*(?:[-.]\w+)*)"
    r"|(?P<sign>\*\*|[-+*/(),]))"
)
_BARE = re.compile(r"\.?[A-Za-z_]\w*(?:[-.]\w+)*")
_FUNCTIONS = ("sqrt", "min", "max")
_CONSTANTS = {"pi": math.pi}


def is_expression(value: Any) -> bool:
    """Return whether what a file says is an expression."""
    return isinstance(value, str) and value.lstrip().startswith("=")


def bare_name(text: str) -> str | None:
    """Return the name that an expression is, if it is nothing else."""
    inside = _inside(text)
    return inside if _BARE.fullmatch(inside) and inside not in _CONSTANTS else None


def names_in(text: str) -> list[str]:
    """Return the names of an expression; what is no token ends them."""
    found, position, inside = [], 0, _inside(text)
    while match := _TOKEN.match(inside, position):
        position = match.end()
        name = match["name"]
        if name and name not in _CONSTANTS and name not in _FUNCTIONS:
            found.append(name)
    return found


def evaluate(text: str, look_up: Callable[[str], Value]) -> Value:
    """Return the value of an expression, whose names ``look_up`` has.

    Raises InputError for anything that is no expression, and for amounts that do not fit.
    """
    inside = _inside(text)
    if len(inside) > _LONGEST:
        raise InputError(f"an expression has at most {_LONGEST} characters, found {len(inside)}")
    reader = _Reader(inside, look_up)
    value = reader.sum()
    reader.end()
    return value


def _inside(text: str) -> str:
    return text.lstrip().removeprefix("=").strip()


class _Reader:
    """Reads an expression from left to right, by recursive descent."""

    def __init__(self, text: str, look_up: Callable[[str], Value]) -> None:
        self._text, self._look_up = text, look_up
        self._position = self._depth = 0
        self._kind, self._token = "", ""
        self._next()

    def sum(self) -> Value:
        value = self._product()
        while self._token in ("+", "-"):
            apply = operator.add if self._take() == "+" else operator.sub
            value = _added(apply, value, self._product())
        return value

    def end(self) -> None:
        if self._kind:
            raise InputError(f"{self._token!r} is not expected there")

    def _product(self) -> Value:
        value = self._factor()
        while self._token in ("*", "/"):
            if self._take() == "*":
                value = _multiplied(value, self._factor())
            else:
                value = _each(operator.truediv, value, _scalar(self._factor(), "a divisor"))
        return value

    def _factor(self) -> Value:
        if self._token in ("+", "-"):
            negative = self._take() == "-"
            value = self._nested(self._factor)
            return _multiplied(number(-1.0), value) if negative else value
        return self._power()

    def _power(self) -> Value:
        base = self._atom()
        if self._token != "**":
            return base
        self._take()
        exponent = _scalar(self._nested(self._factor), "an exponent")
        return _scalar(base, "the base of a power") ** exponent

    def _atom(self) -> Value:
        kind, token = self._kind, self._take()
        if kind == "number":
            return number(float(token))
        if kind == "name":
            if self._token == "(":
                return self._call(token)
            return number(_CONSTANTS[token]) if token in _CONSTANTS else self._look_up(token)
        if token != "(":
            raise InputError(f"a value is needed, found {token!r}" if token else "it is not whole")
        value = self._nested(self.sum)
        self._expect(")")
        return value

    def _call(self, name: str) -> Value:
        if name not in _FUNCTIONS:
            raise InputError(unknown("function", name, _FUNCTIONS))
        self._expect("(")
        given = [self._argument(name)]
        while self._token == ",":
            self._take()
            given.append(self._argument(name))
        self._expect(")")
        if name == "sqrt":
            if len(given) != 1:
                raise InputError(f"sqrt has one argument, found {len(given)}")
            return given[0].root()
        value = given[0]
        for other in given[1:]:
            value = value.chosen(min if name == "min" else max, other)
        return value

    def _argument(self, name: str) -> Amount:
        return _scalar(self._nested(self.sum), f"an argument of {name}")

    def _nested(self, read: Callable[[], Value]) -> Value:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise InputError(f"an expression is at most {_DEEPEST} levels deep")
        value = read()
        self._depth -= 1
        return value

    def _expect(self, sign: str) -> None:
        if self._token != sign:
            raise InputError(f"{sign!r} is missing")
        self._take()

    def _take(self) -> str:
        token = self._token
        self._next()
        return token

    def _next(self) -> None:
        rest = self._text[self._position :].strip()
        match = _TOKEN.match(self._text, self._position)
        if match is None and rest:
            raise InputError(f"{rest[0]!r} is not expected there")
        self._kind = (match.lastgroup or "") if match else ""
        self._token = match[self._kind] if match else ""
        self._position = match.end() if match else len(self._text)


def _scalar(value: Value, what: str) -> Amount:
    if isinstance(value, tuple):
        raise InputError(f"{what} is a scalar, found a list of {len(value)}")
    return value


def _each(apply: Callable[[Amount, Amount], Amount], value: Value, scalar: Amount) -> Value:
    if isinstance(value, tuple):
        return tuple(apply(element, scalar) for element in value)
    return apply(value, scalar)


def _multiplied(a: Value, b: Value) -> Value:
    if isinstance(a, tuple):
        return _each(operator.mul, a, _scalar(b, "the factor of a list"))
    return _each(operator.mul, b, a)


def _added(apply: Callable[[Amount, Amount], Amount], a: Value, b: Value) -> Value:
    if isinstance(a, tuple) and isinstance(b, tuple) and len(a) == len(b):
        return tuple(apply(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, tuple) or isinstance(b, tuple):
        sizes = [str(len(v)) if isinstance(v, tuple) else "1" for v in (a, b)]
        raise InputError(f"a sum is of as many elements each, found {' and '.join(sizes)}")
    return apply(a, b)
