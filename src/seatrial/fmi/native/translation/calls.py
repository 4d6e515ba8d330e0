"""Calls of functions: which of them are C, which are evaluated when C is written."""

from __future__ import annotations

from typing import Any

from .domain import (
    Choice,
    Closure,
    Component,
    Draws,
    Known,
    Method,
    Super,
    TranslationError,
    called,
    described,
    is_record_class,
)
from .frame import Frame
from .functions import inlined, invoke, record
from .intrinsics import INTRINSICS, begun, drawn
from .library import LIBRARY, method
from .operations import is_known, python_of

_LISTS = (list, tuple, dict, zip, enumerate, reversed, iter, next, len, any, all, sum)
_OBJECTS = (type, getattr, setattr, hasattr, isinstance)
_PURE = set(LIBRARY) - {*_LISTS, *_OBJECTS}
"""Functions that are evaluated when all their arguments are known."""


def call(frame: Frame, function: Any, arguments: list[Any], named: dict[str, Any]) -> Any:
    """Return what a function returns. Raises TranslationError for one that has no C."""
    for each in (*arguments, *named.values()):
        if isinstance(each, Draws):
            begun(frame, each)
    if isinstance(function, Choice):
        return frame.each(function, lambda one: call(frame, one, arguments, named))
    if isinstance(function, Closure):
        return inlined(frame, function, arguments, named)
    if isinstance(function, Method):
        return _method(frame, function, arguments, named)
    if not isinstance(function, Known):
        raise frame.refused(f"a call of {described(function)}")
    own = function.value
    if own is super:
        return Super(frame.owner or frame.unit.cls, _receiver(frame))
    handler = LIBRARY.get(own) if callable(own) else None
    known = all(map(is_known, [*arguments, *named.values()]))
    if handler is not None and not (known and own in _PURE):
        return handler(frame, *arguments, **named)
    if known:
        return _evaluated(frame, own, arguments, named)
    if is_record_class(own):
        return record(frame, own, arguments, named)
    if hasattr(own, "__self__") and hasattr(own, "__func__"):
        receiver = Known(own.__self__)
        return invoke(frame, own.__func__, type(own.__self__), [receiver, *arguments], named)
    return invoke(frame, own, None, arguments, named)


def _receiver(frame: Frame) -> Any:
    names = frame.names or {}
    return next(iter(names.values())) if names else frame.unit.own


def _method(frame: Frame, function: Method, arguments: list[Any], named: dict[str, Any]) -> Any:
    own, receiver = function.function, function.receiver
    if isinstance(receiver, Draws):
        return drawn(frame, own, receiver, arguments)
    if isinstance(own, str):
        return method(frame, own, receiver, arguments, named)
    if own in INTRINSICS:
        return INTRINSICS[own](frame, *arguments, **named)
    if isinstance(receiver, Component) and own.__name__ in frame.unit.cls.tabulated:
        return frame.unit.tabulate(own.__name__)
    return invoke(frame, own, function.owner, [receiver, *arguments], named)


def _evaluated(frame: Frame, function: Any, arguments: list[Any], named: dict[str, Any]) -> Known:
    """Call a function of what is known, here and now."""
    try:
        values = [python_of(a) for a in arguments]
        return Known(function(*values, **{n: python_of(v) for n, v in named.items()}))
    except TranslationError:
        raise
    except Exception as error:
        raise frame.refused(f"{called(function)} ({error})") from None
