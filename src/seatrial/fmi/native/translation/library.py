"""Functions of Python's library: builtins, `math`, and the few of others that components use."""

from __future__ import annotations

import ast
import bisect
import math
import sys
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from ....component import seconds
from .constants import is_record
from .domain import (
    Choice,
    Component,
    FaultValues,
    Known,
    Num,
    Once,
    OtherText,
    Queue,
    Range,
    Record,
    Seq,
    Table,
    Unconverted,
    Zipped,
    described,
    is_once,
    opened,
)
from .expressions import storable, unpacked
from .frame import Frame
from .operations import (
    binary,
    compared,
    held,
    is_known,
    is_number,
    is_plain,
    kind_of,
    python_of,
    split,
    truth,
)

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


def _array(frame: Frame, values: Any) -> str:
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
        return frame.num("d", f"compensated({len(items)}, {_array(frame, items)})")
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
    if isinstance(value, Known) and isinstance(value.value, str):
        return Known(len(value.value))
    if isinstance(value, Record) and issubclass(value.cls, tuple):
        return Known(len(value.fields))
    if not isinstance(value, (Seq, Table)) or is_once(value):
        raise frame.refused(f"the length of {described(value)}")
    return Known(len(value.items))


@library(list, tuple)
def _list(frame: Frame, value: Any = None, kind: type = list) -> Any:
    if isinstance(value, Choice):
        return frame.each(value, lambda one: _list(frame, one, kind))
    if isinstance(value, FaultValues):
        return frame.unit.fault_values(frame, value, kind)
    value = opened(value)
    if kind is tuple and isinstance(value, Seq) and value.kind is tuple:
        return value  # the same one
    return Seq(kind, unpacked(frame, value) if value is not None else [])


LIBRARY[tuple] = lambda frame, value=None: _list(frame, value, tuple)


@library(dict)
def _dict(frame: Frame, **named: Any) -> Any:
    held([storable(frame, each) for each in named.values()])
    return Table(dict(named))


def gone_through(frame: Frame, value: Any) -> list[Any]:
    """Return the items of what is gone through later: a list must stay as it is until then."""
    held([value])
    return unpacked(frame, value)


@library(zip)
def _zip(frame: Frame, *values: Any, strict: Any = None) -> Any:
    later = any(is_once(value) and value.kind is not Zipped for value in values)
    columns = [gone_through(frame, value) for value in values]
    sizes = {len(column) for column in columns}
    is_strict = strict is not None and not (isinstance(strict, Known) and strict.value is False)
    if len(sizes) > 1 and (is_strict or later):
        raise frame.refused(f"zip of {sorted(sizes)} values")
    return Seq(Zipped, [Seq(tuple, list(row)) for row in zip(*columns)])  # noqa: B905


@library(range)
def _range(frame: Frame, *ends: Any) -> Any:
    start, stop = ends[:2] if len(ends) > 1 else (Known(0), ends[0])
    step = ends[2] if len(ends) > 2 else Known(1)
    if not (isinstance(step, Known) and type(step.value) is int and step.value):
        raise frame.refused("a range with a step of the run")
    return Range(frame.text_of(start, "i"), frame.text_of(stop, "i"), step.value)


@library(enumerate)
def _enumerate(frame: Frame, values: Any, start: Any = None) -> Any:
    first = start if start is not None else Known(0)
    if not (isinstance(first, Known) and type(first.value) is int):
        raise frame.refused("enumerate from a number of the run")
    items = enumerate(gone_through(frame, values), first.value)
    return Seq(Zipped, [Seq(tuple, [Known(i), each]) for i, each in items])


@library(reversed)
def _reversed(frame: Frame, values: Any) -> Any:
    return Seq(Zipped, gone_through(frame, values)[::-1])


@library(pairwise)
def _pairwise(frame: Frame, values: Any) -> Any:
    return Seq(Zipped, [Seq(tuple, list(pair)) for pair in pairwise(gone_through(frame, values))])


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


@library(bisect.bisect_right, bisect.bisect_left)
def _bisect(frame: Frame, table: Any, x: Any, name: str = "right_of") -> Num:
    found = frame.unit.constant_table(python_of(table)) if is_known(table) else None
    if not found or found[1] != "d":
        raise frame.refused("bisect but in a table of floats")
    return frame.num("i", f"{name}({found[0]}, {found[2]}, {frame.text_of(x, 'd')})")


LIBRARY[bisect.bisect_left] = lambda frame, table, x: _bisect(frame, table, x, "left_of")


@library(np.interp)
def _interp(frame: Frame, x: Any, xs: Any, ys: Any) -> Num:
    sizes = {len(python_of(v) if is_known(v) else unpacked(frame, v)) for v in (xs, ys)}
    size = sizes.pop()
    if not size or sizes:
        raise frame.refused("numpy.interp of tables of other lengths")
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
    return frame.unit.attribute(frame, owner, _name_of(frame, name))


@library(setattr)
def _setattr(frame: Frame, owner: Any, name: Any, value: Any) -> Any:
    frame.unit.store(frame, owner, _name_of(frame, name), value)
    return Known(None)


@library(hasattr)
def _hasattr(frame: Frame, owner: Any, name: Any) -> Any:
    if not isinstance(owner, Component):
        raise frame.refused(f"hasattr of {described(owner)}")
    return Known(frame.unit.has(frame, _name_of(frame, name)))


def _name_of(frame: Frame, name: Any) -> str:
    if not (isinstance(name, Known) and isinstance(name.value, str)):
        raise frame.refused("the name of an attribute that the run decides")
    return name.value


@library(isinstance)
def _isinstance(frame: Frame, value: Any, cls: Any) -> Any:
    if isinstance(value, Choice):
        return frame.each(value, lambda one: _isinstance(frame, one, cls))
    if isinstance(value, Num):
        own = {"d": float, "i": int, "b": bool}[value.kind]
    elif isinstance(value, Seq) and not is_once(value):
        own = value.kind
    elif is_plain(value):
        own = type(value.value)
    elif isinstance(value, Record):
        own = value.cls
    else:
        raise frame.refused(f"isinstance of {described(value)}")
    given: Any = python_of(cls) if is_known(cls) else None
    classes = given if isinstance(given, tuple) else (given,)
    for each in classes:
        if each not in (float, int, bool, str, list, tuple, type(None)) and not is_record(each):
            raise frame.refused(f"isinstance of {described(cls)}")
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
    if named and name != "_replace":
        raise frame.refused(f"the method {name} with names for what it is given")
    match name, receiver, len(arguments):
        case "tolist", Unconverted(value=Seq() as value), 0:
            return value
        case "copy", Seq(kind=kind), 0 if kind is list:
            return Seq(list, unpacked(frame, receiver))
        case "keys", Table(), 0:
            return Seq(Once, [Known(key) for key in receiver.items])
        case "values", Table(), 0:
            return Seq(Once, list(receiver.items.values()))
        case "items", Table(), 0:
            pairs = receiver.items.items()
            return Seq(Once, [Seq(tuple, [Known(key), each]) for key, each in pairs])
        case "get", Table(), 1 | 2:
            return _got(frame, receiver, *arguments)
        case "_replace", Record(), 0 if set(named) <= set(receiver.fields):
            held([storable(frame, each) for each in named.values()])
            return Record(receiver.cls, {**receiver.fields, **named})
        case "pop", Queue(), 0 | 1:
            last = not arguments
            if not last and not (isinstance(arguments[0], Known) and arguments[0].value == 0):
                raise frame.refused("pop but from an end")
            entry = frame.unit.queue_entry(frame, receiver, Known(-1 if last else 0))
            frame.emit(f"{'drop_last' if last else 'drop_first'}({frame.unit.queue(receiver)});")
            frame.stores([receiver.name])
            return entry
    raise frame.refused(f"the method {name} of {described(receiver)}")


def _got(frame: Frame, table: Table, key: Any, default: Any = None) -> Any:
    other = Known(None) if default is None else default
    if isinstance(key, Choice):
        return frame.each(key, lambda one: _got(frame, table, one, default))
    if isinstance(key, OtherText) and set(table.items) <= set(key.known):
        return other
    if not is_plain(key):
        raise frame.refused("a key of the run")
    return table.items.get(key.value, other)
