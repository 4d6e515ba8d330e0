"""Operators on values: arithmetic, comparisons, truth, items."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from .domain import (
    Choice,
    FaultValues,
    Known,
    Num,
    Queue,
    Record,
    Seq,
    Table,
    described,
    opened,
    parts_of,
)
from .frame import Frame

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
_ORDERS = {ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_CHECKED = {ast.Div: "divided", ast.FloorDiv: "quotient", ast.Mod: "modulo", ast.Pow: "power"}
_WHOLE = {ast.FloorDiv: "floored", ast.Mod: "whole_modulo"}


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
        return value.kind(python_of(item) for item in value.items)
    if isinstance(value, Table):
        return {key: python_of(each) for key, each in value.items.items()}
    return value.cls(**{name: python_of(each) for name, each in value.fields.items()})


def is_number(value: Any) -> bool:
    """Return whether a value is a number, known or not."""
    plain = isinstance(value, Known) and isinstance(value.value, (bool, int, float))
    return plain or isinstance(value, Num)


def kind_of(value: Any) -> str:
    """Return the kind of a number."""
    if isinstance(value, Num):
        return value.kind
    return {bool: "b", int: "i"}.get(type(value.value), "d")


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
    if isinstance(left, Known) and isinstance(right, Known):
        try:
            return Known(_PYTHON[type(op)](left.value, right.value))
        except KeyError:
            raise frame.refused(f"the operator {type(op).__name__}") from None
    if is_number(left) and is_number(right):
        return _arithmetic(frame, op, left, right)
    a, b = opened(left), opened(right)
    if isinstance(a, Seq) and isinstance(b, Seq) and isinstance(op, ast.Add):
        return Seq(a.kind, [*a.items, *b.items])
    if isinstance(a, Seq) and isinstance(op, ast.Mult) and isinstance(b, Known):
        for each in a.items:
            if isinstance(each, Seq):
                each.fresh = False  # it is the same list in several places
        return Seq(a.kind, a.items * b.value)
    raise frame.mismatched(f"{type(op).__name__} of {described(left)} and {described(right)}")


def _arithmetic(frame: Frame, op: ast.operator, left: Any, right: Any) -> Num:
    whole = kind_of(left) != "d" and kind_of(right) != "d" and not isinstance(op, ast.Div)
    kind = "i" if whole else "d"
    a, b = frame.text_of(left, kind), frame.text_of(right, kind)
    if type(op) in _C:
        return frame.num(kind, f"{a} {_C[type(op)]} {b}")
    names = _WHOLE if whole else _CHECKED
    if type(op) in names:
        return frame.num(kind, f"{names[type(op)]}(self, {a}, {b}, {frame.place()})")
    raise frame.refused(f"{type(op).__name__} of {'whole ' if whole else ''}numbers of the run")


def negative(frame: Frame, value: Any) -> Any:
    """Return -value."""
    if isinstance(value, Choice):
        return frame.each(value, lambda one: negative(frame, one))
    if isinstance(value, Known):
        return Known(-value.value)
    kind = "d" if kind_of(value) == "d" else "i"
    return frame.num(kind, f"-{frame.text_of(value, kind)}")


def compared(frame: Frame, op: ast.cmpop, left: Any, right: Any) -> Any:
    """Return the truth of a comparison."""
    return split(frame, lambda a, b: _compared(frame, op, a, b), left, right)


def _compared(frame: Frame, op: ast.cmpop, left: Any, right: Any) -> Any:
    if isinstance(op, (ast.Is, ast.IsNot)):
        same = isinstance(left, Known) and isinstance(right, Known) and left.value is right.value
        return Known(same is isinstance(op, ast.Is))
    if isinstance(op, (ast.In, ast.NotIn)):
        found = _contained(frame, left, right)
        return inverted(frame, found) if isinstance(op, ast.NotIn) else found
    if is_number(left) and is_number(right) and not (is_known(left) and is_known(right)):
        kind = max(kind_of(left), kind_of(right), key="bid".index)
        texts = frame.text_of(left, kind), frame.text_of(right, kind)
        return frame.num("b", f"{texts[0]} {_ORDERS[type(op)]} {texts[1]}")
    if is_known(left) and is_known(right):
        return Known(bool(_PYTHON[type(op)](python_of(left), python_of(right))))
    if isinstance(op, (ast.Eq, ast.NotEq)):
        same = _equal(frame, left, right)
        return inverted(frame, same) if isinstance(op, ast.NotEq) else same
    raise frame.mismatched(f"{type(op).__name__} of {described(left)} and {described(right)}")


def _equal(frame: Frame, left: Any, right: Any) -> Any:
    a, b = opened(left), opened(right)
    if not (isinstance(a, (Seq, Record)) and isinstance(b, (Seq, Record))):
        return Known(False)
    one, other = parts_of(a), parts_of(b)
    if len(one) != len(other):
        return Known(False)
    result: Any = Known(True)
    for p, q in zip(one, other, strict=True):
        result = both(frame, result, compared(frame, ast.Eq(), p, q))
    return result


def _contained(frame: Frame, item: Any, container: Any) -> Any:
    container = opened(container)
    if isinstance(container, Table):
        if not isinstance(item, Known):
            raise frame.refused("a key of the run")
        return Known(item.value in container.items)
    if isinstance(container, Known) and isinstance(item, Known):
        return Known(item.value in container.value)
    result: Any = Known(False)
    for each in parts_of(container):
        result = either(frame, result, compared(frame, ast.Eq(), item, each))
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
    if isinstance(value, Known):
        return Known(bool(value.value))
    if isinstance(value, Queue):
        return frame.num("b", f"{frame.unit.queue(value)}.count > 0")
    if isinstance(value, (Seq, Table)):
        return Known(bool(value.items))
    return Known(True)


# ------------------------------------------------------------------ items


def item(frame: Frame, value: Any, index: Any) -> Any:
    """Return value[index]."""
    return split(frame, lambda v, i: _item(frame, v, i), value, index)


def _item(frame: Frame, value: Any, index: Any) -> Any:
    if isinstance(value, Queue):
        return frame.unit.queue_entry(frame, value, index)
    if isinstance(value, FaultValues):
        return frame.unit.fault_value(frame, value, index)
    if isinstance(opened(value), Known) and is_known(index):
        return Known(value.value[python_of(index)])
    if isinstance(value, Known) and isinstance(index, Num):
        table = frame.unit.constant_table(value.value)
        if table:
            name, kind, size = table
            return frame.num(kind, f"{name}[checked_index(self, {index.text}, {size})]")
        if _is_table(value.value):
            size = len(value.value)
            at = frame.num("i", f"checked_index(self, {index.text}, {size})")
            return _row(frame, value.value, at.text)
    value = opened(value)
    if isinstance(value, Table) and isinstance(index, Known):
        if index.value not in value.items:
            raise frame.refused(f"the key {index.value!r}")
        return value.items[index.value]
    if isinstance(value, Record) or (isinstance(value, Seq) and isinstance(index, Known)):
        parts, at = parts_of(value), index.value
        if isinstance(at, slice):
            return Seq(value.kind if isinstance(value, Seq) else tuple, list(parts)[at])
        if not -len(parts) <= at < len(parts):
            raise frame.mismatched(f"item {at} of {len(parts)}")
        return parts[at]
    if isinstance(value, Seq) and isinstance(index, Num):
        size = len(value.items)
        at = frame.num("i", f"checked_index(self, {frame.text_of(index, 'i')}, {size})")
        return frame.each(Choice(at.text, tuple(value.items)), lambda one: one)
    raise frame.mismatched(f"an item of {described(value)}")


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


def with_item(frame: Frame, value: Any, index: Any, new: Any) -> Any:
    """Return a list or dict with another item."""
    value = opened(value)
    if isinstance(value, Table) and isinstance(index, Known):
        return Table({**value.items, index.value: new})
    if not isinstance(value, Seq) or value.kind is not list:
        raise frame.refused(f"a new item in {described(value)}")
    items = list(value.items)
    if isinstance(index, Known):
        items[index.value] = new
        return Seq(list, items, value.fresh)
    at = frame.num("i", f"checked_index(self, {frame.text_of(index, 'i')}, {len(items)})")
    for place, old in enumerate(items):
        here = frame.num("b", f"{at.text} == {place}")
        items[place] = frame.branch(here, lambda: new, lambda old=old: old)  # type: ignore[misc]
    return Seq(list, items, value.fresh)
