"""Statements of Python."""

from __future__ import annotations

import ast
from typing import Any

from .domain import Choice, Closure, Draws, Known, Queue, Seq, Table, Zipped, described, is_once
from .expressions import storable, unpacked
from .frame import Frame, statement
from .messages import failure
from .narrowing import narrowing
from .operations import binary, compared, either, held, truth
from .shapes import opened


@statement(ast.Pass)
def _pass(_frame: Frame, _node: ast.Pass) -> None:
    """Do nothing."""


@statement(ast.Expr)
def _expression(frame: Frame, node: ast.Expr) -> None:
    if isinstance(node.value, ast.Constant):  # a docstring
        return
    call = node.value
    if (
        isinstance(call, ast.Call)
        and isinstance(call.func, ast.Attribute)
        and call.func.attr == "append"
        and len(call.args) == 1
        and not call.keywords
    ):
        _append(frame, call.func.value, call.args[0])
        return
    frame.evaluate(call)


def _append(frame: Frame, target: ast.expr, node: ast.expr) -> None:
    if isinstance(target, ast.Attribute) and frame.unit.is_own(frame, target):
        frame.unit.enqueue(frame, target.attr, frame.evaluate(node))
        return
    before = _changeable(frame, target)
    value = storable(frame, frame.evaluate(node))
    _rename(frame, target, before, Seq(list, [*before.items, *held([value])]))


def _changeable(frame: Frame, target: ast.expr) -> Seq:
    """Return a list that may change in place: one name of this function has it, nothing else."""
    before = frame.evaluate(target) if isinstance(target, ast.Name) else None
    if not (isinstance(before, Seq) and before.kind is list and before.fresh):
        raise frame.refused("a change of what may have another name too", target)
    return before


def _rename(frame: Frame, target: ast.expr, before: Seq, after: Seq) -> None:
    """Give a list that has changed to its name, which still had it when the change was known."""
    assert isinstance(target, ast.Name)
    names = frame.names or {}
    if names.get(target.id) is not before or not before.fresh:
        raise frame.refused("a change of a list that changes meanwhile", target)
    frame.names = {**names, target.id: after}


@statement(ast.Assign)
def _assign(frame: Frame, node: ast.Assign) -> None:
    value = frame.evaluate(node.value)
    _note(frame, node)
    for target in node.targets:
        assign(frame, target, value)


@statement(ast.AnnAssign)
def _annotated(frame: Frame, node: ast.AnnAssign) -> None:
    if node.value is not None:
        value = frame.evaluate(node.value)
        _note(frame, node)
        assign(frame, node.target, value)


@statement(ast.AugAssign)
def _augmented(frame: Frame, node: ast.AugAssign) -> None:
    target = node.target
    if isinstance(target, ast.Subscript):
        raise frame.refused("a change of an item where it is", node)
    if isinstance(target, ast.Attribute) and not isinstance(target.value, ast.Name):
        raise frame.refused("a change of what an expression finds", node)
    before = frame.evaluate(_read(target))
    whole = before.alternatives if isinstance(before, Choice) else (before,)
    if any(isinstance(opened(each), (Seq, Table, Queue)) for each in whole):
        raise frame.refused(f"a change of {described(before)} where it is", node)
    value = binary(frame, node.op, before, frame.evaluate(node.value))
    _note(frame, node)
    assign(frame, target, value)


def _read(target: Any) -> Any:
    """Return an assignment's target as an expression."""
    copy = type(target)(**{name: getattr(target, name) for name in target._fields})
    copy.ctx = ast.Load()
    return ast.copy_location(copy, target)


def _note(frame: Frame, node: ast.stmt) -> None:
    text = ast.unparse(node).replace("*/", "* /").replace("\n", " ")
    frame.emit(f"/* {text:.100} */")


def assign(frame: Frame, target: ast.expr, value: Any) -> None:
    """Give a target of an assignment its value."""
    if isinstance(target, ast.Name):
        if is_once(value) and value.kind is not Zipped:
            raise frame.refused("a name for a generator", target)
        if isinstance(value, Queue):
            raise frame.refused("a name for what is appended to", target)
        if isinstance(value, Draws):
            frame.unit.begin(frame, value)
        if frame.names is not None:
            previous = [n for n, v in frame.names.items() if v is value and n != target.id]
            if previous and hasattr(value, "fresh"):
                value.fresh = False
            frame.names = {**frame.names, target.id: value}
    elif isinstance(target, (ast.Tuple, ast.List)):
        _unpack(frame, list(target.elts), unpacked(frame, value))
    elif isinstance(target, ast.Attribute):
        frame.unit.store(frame, frame.evaluate(target.value), target.attr, value)
    elif isinstance(target, ast.Subscript):
        before = _changeable(frame, target.value)
        index = frame.evaluate(target.slice)
        at = index.value if isinstance(index, Known) else None
        if type(at) is not int or not -len(before.items) <= at < len(before.items):
            raise frame.refused(f"a new item at {described(index)}", target)
        items = list(before.items)
        items[at] = held([value])[0]
        _rename(frame, target.value, before, Seq(list, items))
    else:
        raise frame.refused(f"an assignment to {type(target).__name__}", target)


def _unpack(frame: Frame, targets: list[ast.expr], values: list[Any]) -> None:
    stars = [i for i, target in enumerate(targets) if isinstance(target, ast.Starred)]
    if stars:
        at, more = stars[0], len(values) - len(targets) + 1
        middle = Seq(list, values[at : at + more])
        values = [*values[:at], middle, *values[at + more :]]
        starred = targets[at]
        assert isinstance(starred, ast.Starred)
        targets = [*targets[:at], starred.value, *targets[at + 1 :]]
    if len(targets) != len(values):
        raise frame.impossible(f"unpacking {len(values)} values to {len(targets)} names")
    for target, value in zip(targets, values, strict=True):
        assign(frame, target, value)


@statement(ast.If)
def _if(frame: Frame, node: ast.If) -> None:
    act = narrowing(frame, node.test)
    act(lambda: frame.execute(node.body), lambda: frame.execute(node.orelse))


@statement(ast.Return)
def _return(frame: Frame, node: ast.Return) -> None:
    value = storable(frame, frame.evaluate(node.value)) if node.value else Known(None)
    held([value])
    frame.returns.come({"": value, **frame.sets()})
    frame.names = None


@statement(ast.Raise)
def _raise(frame: Frame, node: ast.Raise) -> None:
    frame.fail(failure(frame, node))


@statement(ast.FunctionDef)
def _function(frame: Frame, node: ast.FunctionDef) -> None:
    if frame.closed or node.decorator_list or _has_yield(node):
        raise frame.refused(f"the function {node.name} here", node)
    frame.names = {**(frame.names or {}), node.name: Closure(node, frame)}


def _has_yield(node: ast.FunctionDef) -> bool:
    odd = (ast.Yield, ast.YieldFrom, ast.Await, ast.Nonlocal, ast.Global, ast.FunctionDef)
    return any(isinstance(each, odd) for own in node.body for each in ast.walk(own))


# ------------------------------------------------------------------ match


@statement(ast.Match)
def _match(frame: Frame, node: ast.Match) -> None:
    subject = frame.evaluate(node.subject)
    _cases(frame, subject, list(node.cases))


def _cases(frame: Frame, subject: Any, cases: list[ast.match_case]) -> None:
    if not cases:
        return
    case, *others = cases
    flag = _matches(frame, subject, case.pattern)
    guard = case.guard
    if guard is not None and not (isinstance(flag, Known) and not flag.value):
        flag = frame.branch(flag, lambda: truth(frame, frame.evaluate(guard)), lambda: Known(False))
    frame.branch(flag, lambda: frame.execute(case.body), lambda: _cases(frame, subject, others))


def _matches(frame: Frame, subject: Any, pattern: ast.pattern) -> Any:
    if isinstance(pattern, ast.MatchValue):
        return compared(frame, ast.Eq(), subject, frame.evaluate(pattern.value))
    if isinstance(pattern, ast.MatchSingleton):
        return compared(frame, ast.Is(), subject, Known(pattern.value))
    if isinstance(pattern, ast.MatchOr):
        result: Any = Known(False)
        for each in pattern.patterns:
            result = either(frame, result, _matches(frame, subject, each))
        return result
    if isinstance(pattern, ast.MatchAs) and pattern.pattern is None:
        if pattern.name:
            assign(frame, ast.copy_location(ast.Name(pattern.name, ast.Store()), pattern), subject)
        return Known(True)
    raise frame.refused(f"a pattern {type(pattern).__name__}", pattern)
