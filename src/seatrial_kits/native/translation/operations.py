"""Operators on values: arithmetic, comparisons, truth, items."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from .domain import (
    Choice,
    FaultValues,
    Known,
    Num,
    OtherText,
    Queue,
    Record,
    Seq,
    Table,
    described,
    is_once,
)
from .frame import Frame
from .shapes import MOST, number_kind, opened, parts_of

_PYTHON: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.BitOr: operator.or_,
    ast.BitAnd: operator.and_,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_C = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*"}
_BOUNDED = {ast.Add: "plus", ast.Sub: "minus", ast.Mult: "times"}
_ORDERS = {ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_CHECKED = {ast.Div: "divided", ast.FloorDiv: "quotient", ast.Mod: "modulo", ast.Pow: "power"}
_WHOLE = {**_BOUNDED, ast.FloorDiv: "floored", ast.Mod: "whole_modulo"}


def is_known(value: Any) -> bool:
    """Return whether nothing in a value depends on the run."""
    if isinstance(value, Known):
        return True
    if isinstance(value, (Seq, Record, Table)):
        return all(is_known(part) for part in parts_of(value))
    return False


def python_of(value: Any) -> Any:
    """Return the object of Python that a known value is."""
    if isinstance(value, Known):
        return value.value
    if isinstance(value, Seq):
        kind = value.kind if value.kind in (list, tuple) else list
        return kind(python_of(item) for item in value.items)
    if isinstance(value, Table):
        return {key: python_of(each) for key, each in value.items.items()}
    return value.cls(**{name: python_of(each) for name, each in value.fields.items()})


def is_plain(value: Any) -> bool:
    """Return whether a value is known and plain: None, a number, text or set of those."""
    return isinstance(value, Known) and isinstance(
        value.value, (bool, int, float, str, bytes, frozenset, type(None))
    )


def held(items: list[Any]) -> list[Any]:
    """Return items of a list or record: of a list among them something else knows from now on."""
    for each in items:
        if isinstance(each, Seq):
            each.fresh = False
    return items


def is_number(value: Any) -> bool:
    """Return whether a value is a number, known or not."""
    known = isinstance(value, Known) and bool(number_kind(value.value))
    return known or isinstance(value, Num)


def kind_of(value: Any) -> str:
    """Return the kind of a number."""
    return value.kind if isinstance(value, Num) else number_kind(value.value)


def split(frame: Frame, act: Callable[..., Any], *values: Any) -> Any:
    """Return ``act`` of values, for each alternative of those that are choices."""
    for place, value in enumerate(values):
        if isinstance(value, Choice):
            return frame.each(value, partial(_placed, frame, act, values, place))
    return act(*values)


def _placed(
    frame: Frame, act: Callable[..., Any], values: tuple[Any, ...], place: int, one: Any
) -> Any:
    return split(frame, act, *values[:place], one, *values[place + 1 :])


def binary(frame: Frame, op: ast.operator, left: Any, right: Any) -> Any:
    """Return the value of a binary operation."""
    return split(frame, lambda a, b: _binary(frame, op, a, b), left, right)


def _binary(frame: Frame, op: ast.operator, left: Any, right: Any) -> Any:
    if is_plain(left) and is_plain(right):
        if type(op) not in _PYTHON:
            raise frame.refused(f"the operator {type(op).__name__}")
        return _of_known(frame, op, left.value, right.value)
    if is_number(left) and is_number(right):
        return _arithmetic(frame, op, left, right)
    a, b = opened(left), opened(right)
    lists = isinstance(a, Seq) and a.kind in (list, tuple)
    if lists and isinstance(b, Seq) and a.kind is b.kind and isinstance(op, ast.Add):
        return Seq(a.kind, held([*a.items, *b.items]))
    if lists and isinstance(op, ast.Mult) and isinstance(b, Known) and type(b.value) is int:
        _refuse_large(frame, len(a.items) * b.value)
        return Seq(a.kind, held(a.items * b.value))
    what = f"{type(op).__name__} of {described(left)} and {described(right)}"
    raise frame.mismatched(what, left, right)


def _of_known(frame: Frame, op: ast.operator, left: Any, right: Any) -> Known:
    """Return what Python makes of two plain values, unless it would take long or has no C."""
    if isinstance(op, ast.Pow) and type(left) is type(right) is int:
        _refuse_large(frame, left.bit_length() * right)
    if isinstance(op, ast.Mult):
        for text, times in ((left, right), (right, left)):
            if isinstance(text, str):
                _refuse_large(frame, len(text) * times)
    value = _PYTHON[type(op)](left, right)
    if isinstance(value, complex):
        raise frame.refused(f"{value}, which is no real number,")
    return Known(value)


def _refuse_large(frame: Frame, size: int) -> None:
    if size > MOST:
        raise frame.refused(f"a value of {size} parts, known before the run,")


def _arithmetic(frame: Frame, op: ast.operator, left: Any, right: Any) -> Num:
    whole = kind_of(left) != "d" and kind_of(right) != "d"
    if whole and isinstance(op, ast.Div):
        texts = [exact(frame, each) for each in (left, right)]
        return frame.num("d", f"divided(self, {texts[0]}, {texts[1]}, {frame.place()})")
    kind = "i" if whole else "d"
    a, b = frame.text_of(left, kind), frame.text_of(right, kind)
    if type(op) in _C and not whole:
        return frame.num(kind, f"{a} {_C[type(op)]} {b}")
    names = _WHOLE if whole else _CHECKED
    if type(op) in names:
        return frame.num(kind, f"{names[type(op)]}(self, {a}, {b}, {frame.place()})")
    raise frame.refused(f"{type(op).__name__} of {'whole ' if whole else ''}numbers of the run")


def exact(frame: Frame, value: Any) -> str:
    """Return a whole number as the double that it is; the run fails for one that is none."""
    if isinstance(value, Known):
        if abs(value.value) > 2**53:
            raise frame.refused(f"{value.value}, which is beyond 2^53,")
        return frame.text_of(value, "d")
    if kind_of(value) == "b":
        return frame.text_of(value, "d")
    return f"exact(self, {value.text}, {frame.place()})"


def negative(frame: Frame, value: Any) -> Any:
    """Return -value."""
    if isinstance(value, Choice):
        return frame.each(value, lambda one: negative(frame, one))
    if not is_number(value):
        raise frame.mismatched(f"- of {described(value)}", value)
    if isinstance(value, Known):
        return Known(-value.value)
    if kind_of(value) == "d":
        return frame.num("d", f"-{value.text}")
    return frame.num("i", f"minus(self, 0, {frame.text_of(value, 'i')}, {frame.place()})")


def compared(frame: Frame, op: ast.cmpop, left: Any, right: Any) -> Any:
    """Return the truth of a comparison."""
    return split(frame, lambda a, b: _compared(frame, op, a, b), left, right)


def _compared(frame: Frame, op: ast.cmpop, left: Any, right: Any) -> Any:
    if isinstance(op, (ast.Is, ast.IsNot)):
        return Known(_is_none(frame, left, right) is isinstance(op, ast.Is))
    if isinstance(op, (ast.In, ast.NotIn)):
        found = _contained(frame, left, right)
        return inverted(frame, found) if isinstance(op, ast.NotIn) else found
    if is_plain(left) and is_plain(right):
        return Known(_PYTHON[type(op)](left.value, right.value))
    if is_number(left) and is_number(right):
        a, b = comparable(frame, left, right)
        return frame.num("b", f"{a} {_ORDERS[type(op)]} {b}")
    if isinstance(op, (ast.Eq, ast.NotEq)):
        same = _equal(frame, left, right)
        return inverted(frame, same) if isinstance(op, ast.NotEq) else same
    what = f"{type(op).__name__} of {described(left)} and {described(right)}"
    raise frame.mismatched(what, left, right)


def comparable(frame: Frame, left: Any, right: Any) -> tuple[str, str]:
    """Return two numbers as C that compares them exactly, as Python does."""
    kinds = [kind_of(left), kind_of(right)]
    if "d" not in kinds:
        return frame.text_of(left, "i"), frame.text_of(right, "i")
    a, b = (
        frame.text_of(each) if kind == "d" else exact(frame, each)
        for each, kind in zip((left, right), kinds, strict=True)
    )
    return a, b


def _is_none(frame: Frame, left: Any, right: Any) -> bool:
    """Return whether both are None: of other things C does not know which are the same."""
    none = [isinstance(each, Known) and each.value is None for each in (left, right)]
    if not any(none):
        raise frame.refused(f"whether {described(left)} is {described(right)}")
    return all(none)


def _equal(frame: Frame, left: Any, right: Any) -> Any:
    """Return whether two values are equal, of which one is a list or record, or no data."""
    for text, other in ((left, right), (right, left)):
        if isinstance(text, OtherText):
            if is_plain(other) and (other.value in text.known or not isinstance(other.value, str)):
                return Known(False)
            raise frame.refused(f"a text that may be {described(other)}")
    a, b = opened(left), opened(right)
    kinds = [_kind_of_items(frame, each) for each in (a, b)]
    if None in kinds or kinds[0] is not kinds[1] or len(parts_of(a)) != len(parts_of(b)):
        return Known(False)
    result: Any = Known(True)
    for p, q in zip(parts_of(a), parts_of(b), strict=True):
        result = both(frame, result, _same_item(frame, p, q))
    return result


def _kind_of_items(frame: Frame, value: Any) -> Any:
    """Return what a value is as a list of items; None for a number, text or None."""
    if isinstance(value, Seq) and value.kind in (list, tuple):
        return value.kind
    if isinstance(value, Record):
        return tuple if issubclass(value.cls, tuple) else value.cls
    if is_plain(value) or is_number(value):
        return None
    raise frame.refused(f"a comparison of {described(value)}")


def _same_item(frame: Frame, a: Any, b: Any) -> Any:
    """Return whether two items are the same or equal."""
    return split(frame, lambda p, q: _equal_item(frame, p, q), a, b)


def _equal_item(frame: Frame, a: Any, b: Any) -> Any:
    if is_number(a) and is_number(b) and {"d"} == {kind_of(a), kind_of(b)}:
        texts = frame.text_of(a), frame.text_of(b)
        return frame.num("b", f"same(self, {texts[0]}, {texts[1]}, {frame.place()})")
    return _compared(frame, ast.Eq(), a, b)


def _contained(frame: Frame, item: Any, container: Any) -> Any:
    container = opened(container)
    if isinstance(container, Table) and is_plain(item):
        return Known(item.value in container.items)
    is_other = isinstance(container, Table) and isinstance(item, OtherText)
    if is_other and set(container.items) <= set(item.known):
        return Known(False)
    if is_plain(container) and is_plain(item) and isinstance(container.value, (str, frozenset)):
        return Known(item.value in container.value)
    if not isinstance(container, (Seq, Record)) or is_once(container):
        raise frame.refused(f"whether {described(item)} is in {described(container)}")
    result: Any = Known(False)
    for each in parts_of(container):
        result = either(frame, result, _same_item(frame, item, each))
    return result


def both(frame: Frame, a: Any, b: Any) -> Any:
    """Return whether two truths hold."""
    if isinstance(a, Known):
        return b if a.value else a
    if isinstance(b, Known):
        return a if b.value else b
    return frame.num("b", f"{a.text} && {b.text}")


def either(frame: Frame, a: Any, b: Any) -> Any:
    """Return whether one of two truths holds."""
    if isinstance(a, Known):
        return a if a.value else b
    if isinstance(b, Known):
        return b if b.value else a
    return frame.num("b", f"{a.text} || {b.text}")


def inverted(frame: Frame, truth: Any) -> Any:
    """Return not truth."""
    if isinstance(truth, Known):
        return Known(not truth.value)
    return frame.num("b", f"!{truth.text}")


def truth(frame: Frame, value: Any) -> Any:
    """Return the truth of a value: known, or a number of kind b."""
    if isinstance(value, Choice):
        return frame.each(value, lambda one: truth(frame, one))
    if isinstance(value, Num):
        return value if value.kind == "b" else frame.num("b", f"{value.text} != 0")
    if is_plain(value):
        return Known(bool(value.value))
    if isinstance(value, Queue):
        return frame.num("b", f"{frame.unit.queue(value)}.count > 0")
    if isinstance(value, OtherText) and "" in value.known:
        return Known(True)
    value = opened(value)
    if isinstance(value, (Seq, Table)) and not is_once(value):
        return Known(bool(value.items))
    if isinstance(value, Record):
        return Known(bool(value.fields) or not issubclass(value.cls, tuple))
    raise frame.refused(f"whether {described(value)} is true")


# ------------------------------------------------------------------ items


def item(frame: Frame, value: Any, index: Any) -> Any:
    """Return value[index]."""
    return split(frame, lambda v, i: _item(frame, v, i), value, index)


def _item(frame: Frame, value: Any, index: Any) -> Any:
    if isinstance(value, Queue):
        return frame.unit.queue_entry(frame, value, index)
    if isinstance(value, FaultValues):
        return frame.unit.fault_value(frame, value, index)
    if isinstance(index, Num) and index.kind == "d":
        raise frame.refused("a float as an index")
    if (is_plain(value) or _is_array(value)) and is_known(index):
        return Known(value.value[python_of(index)])
    if isinstance(value, Known) and isinstance(index, Num):
        table = frame.unit.constant_table(value.value)
        if table:
            name, kind, size = table
            at = frame.num("i", f"checked_index(self, {index.text}, {size})")
            return frame.num(kind, f"{name}[{at.text}]")
        if _is_table(value.value):
            size = len(value.value)
            at = frame.num("i", f"checked_index(self, {index.text}, {size})")
            return _row(frame, value.value, at.text)
    value = opened(value)
    if isinstance(value, Table) and is_plain(index):
        if index.value not in value.items:
            raise frame.refused(f"the key {index.value!r}")
        return value.items[index.value]
    kind = value.kind if isinstance(value, Seq) else _kind_of_items(frame, value)
    if kind in (list, tuple, range) and isinstance(index, Known):
        parts, at = held(list(parts_of(value))), index.value
        if isinstance(at, slice) and kind is not range:
            return Seq(kind, parts[at])
        if not isinstance(at, int) or not -len(parts) <= at < len(parts):
            raise frame.impossible(f"item {at} of {len(parts)}")
        return parts[at]
    if kind in (list, tuple) and isinstance(index, Num):
        items = held(list(parts_of(value)))
        at = frame.num("i", f"checked_index(self, {frame.text_of(index, 'i')}, {len(items)})")
        return frame.each(Choice(at.text, tuple(items)), lambda one: one)
    raise frame.mismatched(f"an item of {described(value)}", value)


def _is_array(value: Any) -> bool:
    return isinstance(value, Known) and isinstance(value.value, np.ndarray)


def _is_table(rows: Any) -> bool:
    """Return whether rows are many records or lists of numbers, all of one structure."""
    if not isinstance(rows, (list, tuple)) or len(rows) < 2:
        return False
    shapes = {_structure(row) for row in rows}
    return len(shapes) == 1 and not any(part is None for part in shapes)


def _structure(row: Any) -> Any:
    if isinstance(row, (list, tuple)):
        parts = tuple(_structure(each) for each in row)
        return None if None in parts else (type(row), parts)
    return type(row) if type(row) in (int, float) else None


def _row(frame: Frame, rows: Sequence[Any], at: str) -> Any:
    """Return a row of a table, read column by column."""
    first = rows[0]
    if not isinstance(first, (list, tuple)):
        name, kind, _ = frame.unit.constant_table(list(rows))
        return frame.num(kind, f"{name}[{at}]")
    columns = [_row(frame, column, at) for column in zip(*rows, strict=True)]
    if hasattr(first, "_fields"):
        return Record(type(first), dict(zip(first._fields, columns, strict=True)))
    return Seq(type(first), columns)
