"""Functions of Python's library on numbers: builtins and `math`."""

from __future__ import annotations

import ast
import math
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

from seatrial.model.component import seconds

from .domain import Known, Num, Seq, Unconverted, described
from .expressions import unpacked
from .frame import Frame
from .operations import binary, compared, is_number, kind_of, split, truth

LIBRARY: dict[Any, Callable[..., Any]] = {}
"""What a function becomes, called with the frame and its arguments."""

_CHECKED = (
    *("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
    *("exp", "expm1", "log", "log1p", "log2", "log10", "sqrt"),
)
_WHOLE = {math.floor: "floor", math.ceil: "ceil", math.trunc: "trunc"}


def library(*functions: Any) -> Callable[[Any], Any]:
    """Register what functions become."""
    return partial(_registered, functions)


def _registered(functions: Any, own: Any) -> Any:
    LIBRARY.update(dict.fromkeys(functions, own))
    return own


def _math(name: str) -> Callable[..., Any]:
    def call(frame: Frame, x: Any) -> Num:
        text = frame.text_of(x, "d")
        own = "__builtin_sqrt" if name == "sqrt" else name  # an instruction, not a call
        return frame.num("d", f"checked(self, {own}({text}), {text}, {frame.place()})")

    return call


for _name in _CHECKED:
    LIBRARY[getattr(math, _name)] = _math(_name)


def _two(frame: Frame, a: Any, b: Any, name: str) -> Num:
    texts = frame.text_of(a, "d"), frame.text_of(b, "d")
    return frame.num("d", f"{name}({texts[0]}, {texts[1]})")


@library(math.fmod, math.remainder)
def _rest(frame: Frame, x: Any, y: Any, name: str = "fmod") -> Num:
    a, b = frame.text_of(x, "d"), frame.text_of(y, "d")
    return frame.num("d", f"remaining(self, {name}({a}, {b}), {a}, {b}, {frame.place()})")


LIBRARY[math.remainder] = lambda frame, x, y: _rest(frame, x, y, "remainder")

for _name in ("atan2", "copysign"):
    LIBRARY[getattr(math, _name)] = lambda frame, a, b, name=_name: _two(frame, a, b, name)


@library(math.pow)
def _pow(frame: Frame, a: Any, b: Any) -> Num:
    texts = frame.text_of(a, "d"), frame.text_of(b, "d")
    return frame.num("d", f"power(self, {texts[0]}, {texts[1]}, {frame.place()})")


@library(math.hypot)
def _hypot(frame: Frame, *values: Any) -> Num:
    return frame.num("d", f"norm({len(values)}, {array(frame, values)})")


@library(math.dist)
def _dist(frame: Frame, a: Any, b: Any) -> Num:
    pairs = zip(unpacked(frame, a), unpacked(frame, b), strict=True)
    parts = [frame.num("d", _difference(frame, *pair)) for pair in pairs]
    return frame.num("d", f"norm({len(parts)}, {array(frame, parts)})")


def _difference(frame: Frame, a: Any, b: Any) -> str:
    return f"{frame.text_of(a, 'd')} - {frame.text_of(b, 'd')}"


@library(divmod)
def _divmod(frame: Frame, a: Any, b: Any) -> Any:
    parts = (binary(frame, op, a, b) for op in (ast.FloorDiv(), ast.Mod()))
    return Seq(tuple, list(parts))


@library(math.radians)
def _radians(frame: Frame, x: Any) -> Num:
    return frame.num("d", f"{frame.text_of(x, 'd')} * {math.pi / 180.0!r}")


@library(math.degrees)
def _degrees(frame: Frame, x: Any) -> Num:
    return frame.num("d", f"{frame.text_of(x, 'd')} * {180.0 / math.pi!r}")


def _finite(frame: Frame, x: Any, name: str) -> Num:
    return frame.num("b", f"{name}({frame.text_of(x, 'd')}) != 0")


for _name in ("isfinite", "isnan", "isinf"):
    LIBRARY[getattr(math, _name)] = lambda frame, x, name=_name: _finite(frame, x, name)


@library(math.fabs)
def _fabs(frame: Frame, x: Any) -> Num:
    return frame.num("d", f"__builtin_fabs({frame.text_of(x, 'd')})")


def _whole(name: str) -> Callable[..., Any]:
    return lambda frame, x: frame.num(
        "i", f"whole(self, {name}({frame.text_of(x, 'd')}), {frame.place()})"
    )


for _function, _name in _WHOLE.items():
    LIBRARY[_function] = _whole(_name)


def array(frame: Frame, values: Any) -> str:
    """Return an array of floats in C."""
    return f"(const double[]){{{', '.join(frame.text_of(v, 'd') for v in values)}}}"


# ------------------------------------------------------------------ numbers


@library(abs)
def _abs(frame: Frame, x: Any) -> Num:
    if kind_of(x) == "d":
        return frame.num("d", f"__builtin_fabs({frame.text_of(x)})")
    return frame.num("i", f"size_of(self, {frame.text_of(x, 'i')}, {frame.place()})")


@library(round)
def _round(frame: Frame, x: Any) -> Num:
    if kind_of(x) != "d":
        return frame.num("i", frame.text_of(x, "i"))
    return frame.num("i", f"whole(self, nearest({frame.text_of(x, 'd')}), {frame.place()})")


@library(int)
def _int(frame: Frame, x: Any) -> Num:
    if isinstance(x, Unconverted) and isinstance(x.value, Num):
        return x.value
    if not is_number(x):
        raise frame.refused(f"int of {described(x)}")
    if kind_of(x) != "d":
        return frame.num("i", frame.text_of(x, "i"))
    return frame.num("i", f"whole(self, trunc({frame.text_of(x, 'd')}), {frame.place()})")


@library(float)
def _float(frame: Frame, x: Any) -> Num:
    if isinstance(x, Unconverted) and isinstance(x.value, Num):
        x = x.value
    return frame.num("d", frame.text_of(x, "d"))


@library(bool)
def _bool(frame: Frame, x: Any) -> Any:
    return truth(frame, x)


@library(seconds)
def _seconds(frame: Frame, ns: Any) -> Num:
    return frame.num("d", f"{frame.text_of(ns, 'd')} / 1e9")


def _extreme(op: ast.cmpop) -> Callable[..., Any]:
    def call(frame: Frame, *values: Any) -> Any:
        items = list(values) if len(values) > 1 else unpacked(frame, values[0])
        if not items:
            raise frame.refused("the extreme of nothing")
        best, *others = items
        for other in others:
            best = split(frame, lambda a, b: one(frame, a, b), best, other)
        return best

    def one(frame: Frame, a: Any, b: Any) -> Any:
        if not (is_number(a) and is_number(b)):
            raise frame.refused(f"the extreme of {described(a)} and {described(b)}")
        flag = compared(frame, op, b, a)
        if isinstance(flag, Known):
            return b if flag.value else a
        kind = kind_of(a)
        if kind != kind_of(b):
            return frame.branch(flag, lambda: b, lambda: a)
        x, y = frame.text_of(a, kind), frame.text_of(b, kind)
        return frame.num(kind, f"{flag.text} ? {y} : {x}")

    return call


LIBRARY[min], LIBRARY[max] = _extreme(ast.Lt()), _extreme(ast.Gt())


@library(sum)
def _sum(frame: Frame, values: Any, start: Any = None) -> Any:
    items = unpacked(frame, values)
    total = Known(0) if start is None else start
    if not all(map(is_number, [total, *items])):
        raise frame.refused("the sum of other things than numbers, each of one kind,")
    kinds = {kind_of(each) for each in items}
    if sys.version_info >= (3, 12) and "d" in {*kinds, kind_of(total)}:
        if kinds != {"d"} or start is not None:
            raise frame.refused("the sum of floats and whole numbers")
        return frame.num("d", f"compensated({len(items)}, {array(frame, items)})")
    for each in items:
        total = frame.unit.added(frame, total, each)
    return total
