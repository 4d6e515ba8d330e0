"""Functions of Python's library: builtins, `math`, and the few of others that components use."""

from __future__ import annotations

import bisect
import math
import sys
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from ....component import seconds
from .domain import (
    Choice,
    Component,
    FaultValues,
    Known,
    Num,
    Queue,
    Range,
    Record,
    Seq,
    Table,
    opened,
)
from .expressions import unpacked
from .frame import Frame
from .operations import is_known, is_number, kind_of, python_of, split, truth

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


for _name in ("atan2", "copysign", "remainder", "fmod"):
    LIBRARY[getattr(math, _name)] = lambda frame, a, b, name=_name: _two(frame, a, b, name)


@library(math.pow)
def _pow(frame: Frame, a: Any, b: Any) -> Num:
    texts = frame.text_of(a, "d"), frame.text_of(b, "d")
    return frame.num("d", f"power(self, {texts[0]}, {texts[1]}, {frame.place()})")


@library(math.hypot)
def _hypot(frame: Frame, *values: Any) -> Num:
    return frame.num("d", f"norm({len(values)}, {_array(frame, values)})")


@library(math.dist)
def _dist(frame: Frame, a: Any, b: Any) -> Num:
    pairs = zip(unpacked(frame, a), unpacked(frame, b), strict=True)
    parts = [frame.num("d", _difference(frame, *pair)) for pair in pairs]
    return frame.num("d", f"norm({len(parts)}, {_array(frame, parts)})")


def _difference(frame: Frame, a: Any, b: Any) -> str:
    return f"{frame.text_of(a, 'd')} - {frame.text_of(b, 'd')}"


@library(divmod)
def _divmod(frame: Frame, a: Any, b: Any) -> Any:
    x, y, where = frame.text_of(a, "d"), frame.text_of(b, "d"), frame.place()
    quotient = frame.num("d", f"quotient(self, {x}, {y}, {where})")
    return Seq(tuple, [quotient, frame.num("d", f"modulo(self, {x}, {y}, {where})")])


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


def _array(frame: Frame, values: Any) -> str:
    return f"(const double[]){{{', '.join(frame.text_of(v, 'd') for v in values)}}}"


# ------------------------------------------------------------------ numbers


@library(abs)
def _abs(frame: Frame, x: Any) -> Num:
    if kind_of(x) == "d":
        return frame.num("d", f"__builtin_fabs({frame.text_of(x)})")
    return frame.num("i", f"llabs({frame.text_of(x, 'i')})")


@library(round)
def _round(frame: Frame, x: Any) -> Num:
    if kind_of(x) != "d":
        return frame.num("i", frame.text_of(x, "i"))
    return frame.num("i", f"whole(self, nearest({frame.text_of(x, 'd')}), {frame.place()})")


@library(int)
def _int(frame: Frame, x: Any) -> Num:
    if kind_of(x) != "d":
        return frame.num("i", frame.text_of(x, "i"))
    return frame.num("i", f"whole(self, trunc({frame.text_of(x, 'd')}), {frame.place()})")


@library(float)
def _float(frame: Frame, x: Any) -> Num:
    return frame.num("d", frame.text_of(x, "d"))


@library(bool)
def _bool(frame: Frame, x: Any) -> Any:
    return truth(frame, x)


@library(seconds)
def _seconds(frame: Frame, ns: Any) -> Num:
    return frame.num("d", f"{frame.text_of(ns, 'd')} / 1e9")


def _extreme(sign: str) -> Callable[..., Any]:
    def call(frame: Frame, *values: Any, default: Any = None) -> Any:
        items = list(values) if len(values) > 1 else unpacked(frame, values[0])
        if not items and default is not None:
            return default
        best, *others = items
        for other in others:
            best = split(frame, lambda a, b: one(frame, a, b), best, other)
        return best

    def one(frame: Frame, a: Any, b: Any) -> Any:
        if is_known(a) and is_known(b):
            better = b.value < a.value if sign == "<" else b.value > a.value
            return b if better else a
        kind = max(kind_of(a), kind_of(b), key="bid".index)
        x, y = frame.text_of(a, kind), frame.text_of(b, kind)
        return frame.num(kind, f"{y} {sign} {x} ? {y} : {x}")

    return call


LIBRARY[min], LIBRARY[max] = _extreme("<"), _extreme(">")


@library(sum)
def _sum(frame: Frame, values: Any, start: Any = None) -> Any:
    items = unpacked(frame, values)
    floats = all(is_number(i) and kind_of(i) == "d" for i in items)
    if sys.version_info >= (3, 12) and floats and items and start is None:
        return frame.num("d", f"compensated({len(items)}, {_array(frame, items)})")
    total = Known(0) if start is None else start
    for each in items:
        total = frame.unit.added(frame, total, each)
    return total


# ------------------------------------------------------------------ sequences


@library(len)
def _len(frame: Frame, value: Any) -> Any:
    if isinstance(value, Choice):
        return frame.each(value, lambda one: _len(frame, one))
    if isinstance(value, Queue):
        return frame.num("i", f"{frame.unit.queue(value)}.count")
    if isinstance(value, FaultValues):
        return frame.num("i", f"self->state.fault.counts[{value.key}]")
    value = opened(value)
    return Known(len(value.items if isinstance(value, (Seq, Table)) else value.fields))


@library(list, tuple)
def _list(frame: Frame, value: Any = None, kind: type = list) -> Any:
    if isinstance(value, Choice):
        return frame.each(value, lambda one: _list(frame, one, kind))
    if isinstance(value, FaultValues):
        return frame.unit.fault_values(frame, value, kind)
    return Seq(kind, unpacked(frame, value) if value is not None else [])


LIBRARY[tuple] = lambda frame, value=None: _list(frame, value, tuple)


@library(dict)
def _dict(frame: Frame, value: Any = None, **named: Any) -> Any:
    return Table({**(opened(value).items if value is not None else {}), **named})


@library(zip)
def _zip(frame: Frame, *values: Any, strict: Any = None) -> Any:
    columns = [unpacked(frame, value) for value in values]
    sizes = {len(column) for column in columns}
    if strict is not None and strict.value and len(sizes) > 1:
        raise frame.refused(f"zip of {sorted(sizes)} values")
    return Seq(list, [Seq(tuple, list(row)) for row in zip(*columns)])  # noqa: B905


@library(range)
def _range(frame: Frame, *ends: Any) -> Any:
    start, stop = ends[:2] if len(ends) > 1 else (Known(0), ends[0])
    step = ends[2] if len(ends) > 2 else Known(1)
    if not isinstance(step, Known):
        raise frame.refused("a range with a step of the run")
    return Range(frame.text_of(start, "i"), frame.text_of(stop, "i"), step.value)


@library(enumerate)
def _enumerate(frame: Frame, values: Any, start: Any = None) -> Any:
    first = start.value if start is not None else 0
    items = enumerate(unpacked(frame, values), first)
    return Seq(list, [Seq(tuple, [Known(i), each]) for i, each in items])


@library(reversed)
def _reversed(frame: Frame, values: Any) -> Any:
    return Seq(list, unpacked(frame, values)[::-1])


@library(pairwise)
def _pairwise(frame: Frame, values: Any) -> Any:
    return Seq(list, [Seq(tuple, list(pair)) for pair in pairwise(unpacked(frame, values))])


@library(any, all)
def _any(frame: Frame, values: Any, wanted: bool = True) -> Any:
    result: Any = Known(not wanted)
    flags = [truth(frame, each) for each in unpacked(frame, values)]
    for flag in flags:
        if isinstance(flag, Known):
            if flag.value is wanted:
                return flag
        elif isinstance(result, Known):
            result = flag
        else:
            result = frame.num("b", f"{result.text} {'||' if wanted else '&&'} {flag.text}")
    return result


LIBRARY[all] = lambda frame, values: _any(frame, values, False)


@library(next)
def _next(frame: Frame, values: Any, default: Any = None) -> Any:
    items = unpacked(frame, values)
    if not items and default is None:
        raise frame.refused("next of nothing")
    return items[0] if items else default


@library(iter)
def _iter(_frame: Frame, values: Any) -> Any:
    return values


@library(bisect.bisect_right, bisect.bisect_left)
def _bisect(frame: Frame, table: Any, x: Any, name: str = "right_of") -> Num:
    found = frame.unit.constant_table(python_of(table)) if is_known(table) else None
    if not found:
        raise frame.refused("bisect but in a table of numbers")
    return frame.num("i", f"{name}({found[0]}, {found[2]}, {frame.text_of(x, 'd')})")


LIBRARY[bisect.bisect_left] = lambda frame, table, x: _bisect(frame, table, x, "left_of")


@library(np.interp)
def _interp(frame: Frame, x: Any, xs: Any, ys: Any) -> Num:
    size = len(python_of(xs)) if is_known(xs) else len(unpacked(frame, xs))
    arrays = f"{size}, {_points(frame, xs)}, {_points(frame, ys)}"
    return frame.num("d", f"interpolated({frame.text_of(x, 'd')}, {arrays})")


def _points(frame: Frame, values: Any) -> str:
    """Return an array of C: a table if it is known."""
    if not is_known(values):
        return _array(frame, unpacked(frame, values))
    name: str = frame.unit.constant_table([float(v) for v in python_of(values)])[0]
    return name


# ------------------------------------------------------------------ objects


@library(getattr)
def _getattr(frame: Frame, owner: Any, name: Any) -> Any:
    return frame.unit.attribute(frame, owner, name.value)


@library(setattr)
def _setattr(frame: Frame, owner: Any, name: Any, value: Any) -> Any:
    frame.unit.store(frame, owner, name.value, value)
    return Known(None)


@library(hasattr)
def _hasattr(frame: Frame, owner: Any, name: Any) -> Any:
    if isinstance(owner, Component):
        return Known(True)  # states are saved and restored whole
    return Known(hasattr(python_of(owner), name.value))


@library(isinstance)
def _isinstance(frame: Frame, value: Any, cls: Any) -> Any:
    if isinstance(value, Choice):
        return frame.each(value, lambda one: _isinstance(frame, one, cls))
    if isinstance(value, Known):
        return Known(isinstance(value.value, cls.value))
    kinds = {Num: float, Seq: list, Table: dict}
    own = value.cls if isinstance(value, Record) else kinds.get(type(value), object)
    if isinstance(value, Num):
        own = {"d": float, "i": int, "b": bool}[value.kind]
    if isinstance(value, Seq):
        own = value.kind
    classes = cls.value if isinstance(cls.value, tuple) else (cls.value,)
    return Known(issubclass(own, classes))


@library(type)
def _type(frame: Frame, value: Any) -> Any:
    if isinstance(value, Component):
        return Known(frame.unit.cls)
    raise frame.refused("the type of a value")


def method(frame: Frame, name: str, receiver: Any, arguments: list[Any], named: Any) -> Any:
    """Return what a method of a list, dict, record or text does."""
    if isinstance(receiver, Choice):
        return frame.each(receiver, lambda one: method(frame, name, one, arguments, named))
    match name, receiver:
        case "tolist", _:
            return receiver
        case "copy", Seq():
            return Seq(receiver.kind, list(receiver.items))
        case "keys", Table():
            return Seq(list, [Known(key) for key in receiver.items])
        case "values", Table():
            return Seq(list, list(receiver.items.values()))
        case "items", Table():
            pairs = receiver.items.items()
            return Seq(list, [Seq(tuple, [Known(key), each]) for key, each in pairs])
        case "get", Table():
            return _got(frame, receiver, *arguments)
        case "_replace", Record():
            return Record(receiver.cls, {**receiver.fields, **named})
        case "index", Seq() if is_known(receiver) and is_known(arguments[0]):
            return Known(python_of(receiver).index(python_of(arguments[0])))
        case "pop", Queue():
            last = not arguments
            entry = frame.unit.queue_entry(frame, receiver, Known(-1 if last else 0))
            frame.emit(f"{'drop_last' if last else 'drop_first'}({frame.unit.queue(receiver)});")
            return entry
    raise frame.refused(f"the method {name}")


def _got(frame: Frame, table: Table, key: Any, default: Any = None) -> Any:
    other = Known(None) if default is None else default
    if isinstance(key, Choice):
        return frame.each(key, lambda one: _got(frame, table, one, default))
    if not isinstance(key, Known):
        raise frame.refused("a key of the run")
    return table.items.get(key.value, other)
