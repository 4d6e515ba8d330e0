"""Expressions of Python."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable
from typing import Any

from .constants import why_no_constant
from .domain import Choice, Known, Once, Queue, Seq, Table, described, is_once
from .frame import Frame, Join, expression
from .narrowing import narrowing
from .operations import binary, compared, held, inverted, is_plain, item, negative, truth
from .shapes import opened, parts_of


@expression(ast.Constant)
def _constant(_frame: Frame, node: ast.Constant) -> Any:
    return Known(node.value)


@expression(ast.Name)
def _name(frame: Frame, node: ast.Name) -> Any:
    names = frame.names or {}
    if node.id in names:
        return names[node.id]
    if node.id in frame.locals:
        raise frame.refused(f"{node.id}, which may have no value here,", node)
    if node.id in frame.scope:
        value = frame.scope[node.id]
        why = why_no_constant(frame.scope, node.id, value)
        if why:
            raise frame.refused(f"{node.id}, {why},", node)
        return Known(value)
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
    pairs = list(zip(node.ops, node.comparators, strict=True))
    return _chain(frame, frame.evaluate(node.left), pairs)


def _chain(frame: Frame, left: Any, pairs: list[tuple[ast.cmpop, ast.expr]]) -> Any:
    """Return the truth of comparisons in a chain, of which one that fails is the last."""
    (op, node), *others = pairs
    right = frame.evaluate(node)
    flag = compared(frame, op, left, right)
    if not others:
        return flag
    return frame.branch(flag, lambda: _chain(frame, right, others), lambda: Known(False))


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
    return Seq(kind, held([storable(frame, each) for each in _arguments(frame, node.elts)]))


def _arguments(frame: Frame, nodes: list[ast.expr]) -> list[Any]:
    """Return the values of the items of a display or call."""
    found: list[Any] = []
    for node in nodes:
        if isinstance(node, ast.Starred):
            found += unpacked(frame, frame.evaluate(node.value))
        else:
            found.append(frame.evaluate(node))
    return found


def storable(frame: Frame, value: Any) -> Any:
    """Return a value that may stand in another, or go elsewhere: none that is gone through once."""
    if is_once(value):
        raise frame.refused("what can be gone through once, as an item or argument,")
    return value


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
        raise frame.mismatched(f"iteration over {described(value)}", value)
    if is_once(value):
        if value.spent:
            raise frame.refused("going again through what can be gone through once")
        value.spent = True
    return held(list(parts_of(value)))


def _is_list(value: Any) -> bool:
    return isinstance(value, Seq) or (hasattr(value, "cls") and hasattr(value.cls, "_fields"))


@expression(ast.Dict)
def _dict(frame: Frame, node: ast.Dict) -> Any:
    items: dict[Any, Any] = {}
    for key, each in zip(node.keys, node.values, strict=True):
        if key is None:
            raise frame.refused("** in a dict", node)
        own = _key(frame, frame.evaluate(key))
        items[own] = storable(frame, frame.evaluate(each))
    held(list(items.values()))
    return Table(items)


def _key(frame: Frame, value: Any) -> Any:
    if not is_plain(value):
        raise frame.refused(f"a dict with {described(value)} as a key")
    return value.value


@expression(ast.Subscript)
def _subscript(frame: Frame, node: ast.Subscript) -> Any:
    return item(frame, frame.evaluate(node.value), frame.evaluate(node.slice))


@expression(ast.Slice)
def _slice(frame: Frame, node: ast.Slice) -> Any:
    ends = [frame.evaluate(e) if e else Known(None) for e in (node.lower, node.upper, node.step)]
    if not all(isinstance(end, Known) for end in ends):
        raise frame.refused("a slice with limits of the run", node)
    return Known(slice(*(end.value for end in ends)))


@expression(ast.ListComp)
def _comprehension(frame: Frame, node: ast.ListComp) -> Any:
    return Seq(list, _turns_of(frame, node))


def _turns_of(frame: Frame, node: ast.ListComp | ast.GeneratorExp) -> list[Any]:
    """Return what a comprehension, or a generator that is used up at once, consists of."""
    found: list[Any] = []
    comprehended(
        frame, node.generators, lambda: found.append(storable(frame, frame.evaluate(node.elt)))
    )
    return held(found)


@expression(ast.GeneratorExp)
def _generator(frame: Frame, node: ast.GeneratorExp) -> Any:
    """Return what a generator yields, now: whoever goes through it does so right away."""
    before, frame.stored = frame.stored, set()
    found = Seq(Once, _turns_of(frame, node))
    if frame.stored:
        raise frame.refused("a generator that changes something", node)
    frame.stored = before
    return found


@expression(ast.DictComp)
def _table(frame: Frame, node: ast.DictComp) -> Any:
    found: dict[Any, Any] = {}

    def add() -> None:
        key = _key(frame, frame.evaluate(node.key))
        found[key] = storable(frame, frame.evaluate(node.value))

    comprehended(frame, node.generators, add)
    held(list(found.values()))
    return Table(found)


def comprehended(
    frame: Frame, generators: list[ast.comprehension], act: Callable[[], None]
) -> None:
    """Do something for each turn of a comprehension, with its names."""
    outer = dict(frame.names or {})
    _turns(frame, generators, act)
    inner = frame.names or {}
    # What was known of an attribute may have changed on the way.
    frame.names = {n: v for n, v in outer.items() if not n.startswith("self.") or n in inner}


def _turns(frame: Frame, generators: list[ast.comprehension], act: Callable[[], None]) -> None:
    if not generators:
        act()
        return
    first, *others = generators
    for value in unpacked(frame, frame.evaluate(first.iter)):
        frame.unit.assign(frame, first.target, value)
        if all(_holds(frame, test) for test in first.ifs):
            _turns(frame, others, act)


def _holds(frame: Frame, test: ast.expr) -> bool:
    flag = truth(frame, frame.evaluate(test))
    if not isinstance(flag, Known):
        raise frame.refused("a list whose length the run decides")
    return bool(flag.value)


@expression(ast.JoinedStr)
def _text(frame: Frame, node: ast.JoinedStr) -> Any:
    found = ""
    for part in node.values:
        if isinstance(part, ast.Constant):
            found += str(part.value)
            continue
        assert isinstance(part, ast.FormattedValue)
        value = frame.evaluate(part.value)
        if not is_plain(value) or part.format_spec or part.conversion == ord("a"):
            raise frame.refused("a text made of what the run knows", node)
        found += repr(value.value) if part.conversion == ord("r") else str(value.value)
    return Known(found)


@expression(ast.Call)
def _call(frame: Frame, node: ast.Call) -> Any:
    function = frame.evaluate(node.func)
    own = function.value if isinstance(function, Known) else None
    if len(node.args) == 1 and isinstance(node.args[0], ast.GeneratorExp) and not node.keywords:
        if own is any or own is all:
            return _first_true(frame, node.args[0], own is any)
        if own in (sum, min, max, list, tuple):
            items = Seq(Once, _turns_of(frame, node.args[0]))
            return frame.unit.call(frame, function, [items], {})
    arguments = _arguments(frame, node.args)
    named: dict[str, Any] = {}
    for keyword in node.keywords:
        if keyword.arg is None:
            raise frame.refused("** in a call", node)
        named[keyword.arg] = frame.evaluate(keyword.value)
    return frame.unit.call(frame, function, arguments, named)


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
