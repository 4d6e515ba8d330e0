"""Expressions of Python."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable
from functools import partial
from typing import Any

from .domain import (
    Choice,
    Closure,
    Known,
    Queue,
    Seq,
    Table,
    described,
    opened,
    parts_of,
)
from .frame import Frame, Join, expression
from .narrowing import narrowing
from .operations import (
    binary,
    both,
    compared,
    inverted,
    is_known,
    item,
    negative,
    python_of,
    truth,
)


@expression(ast.Constant)
def _constant(_frame: Frame, node: ast.Constant) -> Any:
    return Known(node.value)


@expression(ast.Name)
def _name(frame: Frame, node: ast.Name) -> Any:
    names = frame.names or {}
    if node.id in names:
        return names[node.id]
    if node.id in frame.scope:
        return Known(frame.scope[node.id])
    if hasattr(builtins, node.id):
        return Known(getattr(builtins, node.id))
    raise frame.refused(f"{node.id}, which may have no value here,", node)


@expression(ast.Attribute)
def _attribute(frame: Frame, node: ast.Attribute) -> Any:
    return frame.unit.attribute(frame, frame.evaluate(node.value), node.attr)


@expression(ast.BinOp)
def _binary(frame: Frame, node: ast.BinOp) -> Any:
    left = frame.evaluate(node.left)
    return binary(frame, node.op, left, frame.evaluate(node.right))


@expression(ast.UnaryOp)
def _unary(frame: Frame, node: ast.UnaryOp) -> Any:
    value = frame.evaluate(node.operand)
    if isinstance(node.op, ast.Not):
        return inverted(frame, truth(frame, value))
    if isinstance(node.op, ast.USub):
        return negative(frame, value)
    raise frame.refused(f"the operator {type(node.op).__name__}", node)


@expression(ast.Compare)
def _compare(frame: Frame, node: ast.Compare) -> Any:
    left, result = frame.evaluate(node.left), Known(True)
    for op, right_node in zip(node.ops, node.comparators, strict=True):
        right = frame.evaluate(right_node)
        result = both(frame, result, compared(frame, op, left, right))
        if isinstance(result, Known) and not result.value:
            return result
        left = right
    return result


@expression(ast.BoolOp)
def _boolean(frame: Frame, node: ast.BoolOp) -> Any:
    return _first_of(frame, node.values, isinstance(node.op, ast.Or))


def _first_of(frame: Frame, nodes: list[ast.expr], ends: bool) -> Any:
    """Return the first value whose truth is ``ends``, or the last."""
    value = frame.evaluate(nodes[0])
    if len(nodes) == 1:
        return value
    flag = truth(frame, value)

    def others() -> Any:
        return _first_of(frame, nodes[1:], ends)

    def own() -> Any:
        # What is not empty cannot be the empty one of several.
        return _true_part(value) if ends else value

    return frame.branch(flag, own, others) if ends else frame.branch(flag, others, own)


def _true_part(value: Any) -> Any:
    """Return what a value can be if it is true."""
    if not isinstance(value, Choice):
        return value
    able = [
        i
        for i, each in enumerate(value.alternatives)
        if not (isinstance(each, Known) and not each.value)
        and not (isinstance(each, Seq) and not each.items)
    ]
    return value.alternatives[able[0]] if len(able) == 1 else value


@expression(ast.IfExp)
def _either(frame: Frame, node: ast.IfExp) -> Any:
    flag = narrowing(frame, node.test)
    return flag(lambda: frame.evaluate(node.body), lambda: frame.evaluate(node.orelse))


@expression(ast.Tuple, ast.List)
def _sequence(frame: Frame, node: ast.Tuple | ast.List) -> Any:
    kind = tuple if isinstance(node, ast.Tuple) else list
    return _displayed(frame, node.elts, lambda items: Seq(kind, items))


def _displayed(frame: Frame, nodes: list[ast.expr], made: Callable[[list[Any]], Any]) -> Any:
    """Return what is made of the items of a display or call; for each length that they may have."""
    parts = [
        (isinstance(n, ast.Starred), frame.evaluate(n.value if isinstance(n, ast.Starred) else n))
        for n in nodes
    ]
    return _spread(frame, parts, [], made)


def _spread(
    frame: Frame,
    parts: list[tuple[bool, Any]],
    items: list[Any],
    made: Callable[[list[Any]], Any],
) -> Any:
    for at, (is_starred, value) in enumerate(parts):
        if not is_starred:
            items = [*items, value]
        elif isinstance(value, Choice) and len(_sizes(value)) > 1:
            return frame.each(value, partial(_spread_one, frame, parts[at + 1 :], items, made))
        else:
            items = [*items, *unpacked(frame, value)]
    return made(items)


def _spread_one(
    frame: Frame,
    rest: list[tuple[bool, Any]],
    items: list[Any],
    made: Callable[[list[Any]], Any],
    one: Any,
) -> Any:
    return _spread(frame, [(True, one), *rest], items, made)


def _sizes(choice: Choice) -> set[int]:
    """Return the lengths that one of several lists may have; -1 stands for what is no list."""
    opened_ = [opened(each) for each in choice.alternatives]
    return {len(parts_of(each)) if _is_list(each) else -1 for each in opened_}


def unpacked(frame: Frame, value: Any) -> list[Any]:
    """Return the items of what is iterated over."""
    if isinstance(value, Choice):
        sizes = _sizes(value)
        if len(sizes) == 1 and sizes != {-1}:
            places = range(sizes.pop())
            return [frame.each(value, lambda v, i=i: parts_of(v)[i]) for i in places]  # type: ignore[misc]
    value = opened(value)
    if isinstance(value, Table):
        return [Known(key) for key in value.items]
    if isinstance(value, Queue) or not _is_list(value):
        raise frame.mismatched(f"iteration over {described(value)}")
    return list(parts_of(value))


def _is_list(value: Any) -> bool:
    return isinstance(value, Seq) or (hasattr(value, "cls") and hasattr(value.cls, "_fields"))


@expression(ast.Dict)
def _dict(frame: Frame, node: ast.Dict) -> Any:
    items: dict[Any, Any] = {}
    for key, each in zip(node.keys, node.values, strict=True):
        own = frame.evaluate(each)
        if key is None:
            items |= opened(own).items
        else:
            items[_key(frame, frame.evaluate(key))] = own
    return Table(items)


def _key(frame: Frame, value: Any) -> Any:
    if not is_known(value):
        raise frame.refused("a dict with keys of the run")
    return python_of(value)


@expression(ast.Subscript)
def _subscript(frame: Frame, node: ast.Subscript) -> Any:
    return item(frame, frame.evaluate(node.value), frame.evaluate(node.slice))


@expression(ast.Slice)
def _slice(frame: Frame, node: ast.Slice) -> Any:
    ends = [frame.evaluate(e) if e else Known(None) for e in (node.lower, node.upper, node.step)]
    if not all(isinstance(end, Known) for end in ends):
        raise frame.refused("a slice with limits of the run", node)
    return Known(slice(*(end.value for end in ends)))


@expression(ast.ListComp, ast.GeneratorExp, ast.SetComp)
def _comprehension(frame: Frame, node: ast.ListComp | ast.GeneratorExp) -> Any:
    found: list[Any] = []
    comprehended(frame, node.generators, lambda: found.append(frame.evaluate(node.elt)))
    return Seq(list, found)


@expression(ast.DictComp)
def _table(frame: Frame, node: ast.DictComp) -> Any:
    found: dict[Any, Any] = {}

    def add() -> None:
        found[_key(frame, frame.evaluate(node.key))] = frame.evaluate(node.value)

    comprehended(frame, node.generators, add)
    return Table(found)


def comprehended(
    frame: Frame, generators: list[ast.comprehension], act: Callable[[], None]
) -> None:
    """Do something for each turn of a comprehension, with its names."""
    outer = dict(frame.names or {})
    _turns(frame, generators, act)
    frame.names = outer


def _turns(frame: Frame, generators: list[ast.comprehension], act: Callable[[], None]) -> None:
    if not generators:
        act()
        return
    first, *others = generators
    for value in unpacked(frame, frame.evaluate(first.iter)):
        frame.unit.assign(frame, first.target, value)
        flags = [truth(frame, frame.evaluate(test)) for test in first.ifs]
        if not all(isinstance(flag, Known) for flag in flags):
            raise frame.refused("a list whose length the run decides")
        if all(flag.value for flag in flags):
            _turns(frame, others, act)


@expression(ast.NamedExpr)
def _named(frame: Frame, node: ast.NamedExpr) -> Any:
    value = frame.evaluate(node.value)
    frame.unit.assign(frame, node.target, value)
    return value


@expression(ast.Lambda)
def _lambda(frame: Frame, node: ast.Lambda) -> Any:
    return Closure(node, frame)


@expression(ast.JoinedStr)
def _text(frame: Frame, node: ast.JoinedStr) -> Any:
    found = ""
    for part in node.values:
        if isinstance(part, ast.Constant):
            found += str(part.value)
            continue
        assert isinstance(part, ast.FormattedValue)
        value = frame.evaluate(part.value)
        if not is_known(value) or part.format_spec:
            raise frame.refused("a text made of numbers of the run", node)
        own = python_of(value)
        found += repr(own) if part.conversion == ord("r") else str(own)
    return Known(found)


@expression(ast.Call)
def _call(frame: Frame, node: ast.Call) -> Any:
    function = frame.evaluate(node.func)
    lazy = isinstance(function, Known) and function.value in (any, all)
    if lazy and len(node.args) == 1 and isinstance(node.args[0], ast.GeneratorExp):
        return _first_true(frame, node.args[0], function.value is any)
    named: dict[str, Any] = {}
    for keyword in node.keywords:
        value = frame.evaluate(keyword.value)
        if keyword.arg is None:
            named |= opened(value).items
        else:
            named[keyword.arg] = value
    return _displayed(
        frame, node.args, lambda arguments: frame.unit.call(frame, function, arguments, named)
    )


def _first_true(frame: Frame, node: ast.GeneratorExp, wanted: bool) -> Any:
    """Return any (``wanted``) or all of a generator, which asks no further than it has to."""
    join, outer = Join(frame, frame.label()), dict(frame.names or {})
    ended: list[bool] = []

    def found() -> None:
        join.come({"": Known(wanted)})
        frame.names = None

    def turn() -> None:
        if ended:
            return
        flag = truth(frame, frame.evaluate(node.elt))
        if isinstance(flag, Known) and flag.value is wanted:
            ended.append(True)
            join.come({"": flag})
            return
        frame.branch(flag, *((found, _pass) if wanted else (_pass, found)))

    comprehended(frame, node.generators, turn)
    if not ended:
        join.come({"": Known(not wanted)})
    names = join.names()
    frame.names = outer
    assert names is not None
    return names[""]


def _pass() -> None:
    """Do nothing."""
