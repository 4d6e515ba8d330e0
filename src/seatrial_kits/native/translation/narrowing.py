"""Tests that say which of several things a value is, and what follows from then on."""

from __future__ import annotations

import ast
from collections.abc import Callable
from functools import partial
from typing import Any

from .domain import Choice, Component, Record
from .frame import Frame
from .operations import truth
from .shapes import opened


def narrowing(frame: Frame, test: ast.expr) -> Callable[..., Any]:
    """Return a function that takes what to do if a test holds and if not.

    A test of a name, or an attribute of the component, that is one of several kinds (``x is
    None``, ``x``) says which from then on.
    """
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        act = narrowing(frame, test.operand)
        return lambda yes, no: act(no, yes)
    if isinstance(test, ast.BoolOp) and any(_subject(frame, v)[0] for v in test.values):
        return _chained(frame, test)
    name, value, whole = _subject(frame, test)
    if not name:
        return lambda yes, no: frame.branch(truth(frame, frame.evaluate(test)), yes, no)

    def narrowed(yes: Callable[[], Any], no: Callable[[], Any]) -> Any:
        before, kept = (frame.names or {}).get(name, value), []

        def one(alternative: Any) -> Any:
            own = whole(alternative)
            frame.names = {**(frame.names or {}), name: own}
            result = frame.branch(truth(frame, frame.evaluate(test)), yes, no)
            kept.append(frame.names is not None and frame.names.get(name) is own)
            return result

        result = frame.alternatives(value, one)
        # Where control ends for some, the name is one of the others from here on.
        if kept == [True] * len(value.alternatives) and frame.names is not None:
            frame.names[name] = before
        return result

    return narrowed


def _chained(frame: Frame, test: ast.BoolOp) -> Callable[..., Any]:
    first, *others = test.values
    rest = others[0] if len(others) == 1 else ast.copy_location(ast.BoolOp(test.op, others), test)

    def act(yes: Callable[[], Any], no: Callable[[], Any]) -> Any:
        def further() -> Any:
            return narrowing(frame, rest)(yes, no)

        both_ways = (yes, further) if isinstance(test.op, ast.Or) else (further, no)
        return narrowing(frame, first)(*both_ways)

    return act


def _subject(frame: Frame, test: ast.expr) -> tuple[str, Any, Callable[[Any], Any]]:
    """Return what a test is about, if it is one of several things.

    That is the name that knows it, its value, and what the name is if the value is an alternative.
    """
    subject = test.operand if isinstance(test, ast.UnaryOp) else test
    subject = subject.left if isinstance(subject, ast.Compare) else subject
    names = frame.names or {}
    name, value, whole = "", None, _itself
    if isinstance(subject, ast.Name):
        name, value = subject.id, names.get(subject.id)
    elif isinstance(subject, ast.Attribute) and isinstance(subject.value, ast.Name):
        owner, field = opened(names.get(subject.value.id)), subject.attr
        if isinstance(owner, Record) and field in owner.fields:
            name, value = subject.value.id, owner.fields[field]
            whole = partial(_with_field, owner, field)
        elif isinstance(owner, Component) and frame.unit.remembers(field):
            name, value = f"self.{field}", frame.evaluate(subject)
    return (name, value, whole) if name and isinstance(value, Choice) else ("", None, whole)


def _itself(value: Any) -> Any:
    return value


def _with_field(record: Record, field: str, value: Any) -> Record:
    return Record(record.cls, {**record.fields, field: value})
