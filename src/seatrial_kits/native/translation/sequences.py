"""Functions of Python's library on lists, dicts and objects, and the methods of those."""

from __future__ import annotations

import bisect
from itertools import pairwise
from typing import Any

import numpy as np

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
)
from .expressions import storable, unpacked
from .frame import Frame
from .library import LIBRARY, array, library
from .operations import held, is_known, is_plain, python_of, truth
from .shapes import opened


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
        return array(frame, unpacked(frame, values))
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
