"""Calls of functions: which of them are C, which are evaluated when C is written."""

from __future__ import annotations

import math
from functools import partial
from itertools import pairwise
from types import BuiltinMethodType, MethodType
from typing import Any

import numpy as np

from seatrial.kits import is_ours

from .constants import is_record, why_no_record
from .domain import Choice, Closure, Component, Draws, Known, Method, Super, described
from .frame import Frame
from .functions import inlined, invoke, record
from .intrinsics import INTRINSICS, begun, drawn
from .library import LIBRARY
from .operations import is_known, python_of, split
from .sequences import method
from .shapes import MOST

_OBJECTS = (getattr, setattr, hasattr, isinstance, type)
_NUMBERS = set(LIBRARY) - {list, tuple, dict, zip, enumerate, reversed, pairwise, len, *_OBJECTS}
"""Functions of the library of numbers, each of which may be one of several kinds."""
_PURE = (_NUMBERS - {sum, any, all, min, max, range}) | {
    own for own in vars(math).values() if callable(own)
}
_PURE -= {math.factorial, math.comb, math.perm}  # may take for ever
_PURE |= {sorted, set, frozenset, str, repr, range, np.array, np.linalg.pinv}
_IMMUTABLE = (str, bytes, int, float, np.ndarray)
"""Whose own methods change nothing; an array is in no name, but between two calls."""


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
    if not isinstance(function, Known) or not callable(function.value):
        raise frame.refused(f"a call of {described(function)}")
    own = function.value
    if own is super:
        if arguments or frame.closed:
            raise frame.refused("super but of the method itself")
        return Super(frame.owner or frame.unit.cls, _receiver(frame))
    if all(map(is_known, [*arguments, *named.values()])) and _is_pure(own):
        return _evaluated(frame, own, arguments, named)
    if own in LIBRARY:
        handler = partial(LIBRARY[own], frame)
        if own in _NUMBERS and not named:
            return split(frame, handler, *arguments)
        return handler(*arguments, **named)
    if is_record(own):
        return record(frame, own, arguments, named)
    if isinstance(own, MethodType):
        receiver = Known(own.__self__)
        return invoke(frame, own.__func__, type(own.__self__), [receiver, *arguments], named)
    return invoke(frame, own, None, arguments, named)


def _is_pure(function: Any) -> bool:
    """Return whether a function of what is known may be called when C is written."""
    if isinstance(function, BuiltinMethodType) and isinstance(function.__self__, _IMMUTABLE):
        return True
    if function in _PURE:
        return True
    if is_record(function):
        return not why_no_record(function)
    if isinstance(function, (type, MethodType)):
        return False
    return is_ours(getattr(function, "__module__", "") or "")


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
    values = [python_of(a) for a in arguments]
    on_text = isinstance(function, BuiltinMethodType) and isinstance(function.__self__, str)
    for each in values:
        size = len(each) if isinstance(each, range) else each if on_text else 0
        if isinstance(size, int) and size > MOST:
            raise frame.refused(f"{function.__name__} of {each!r}, known before the run,")
    return Known(function(*values, **{n: python_of(v) for n, v in named.items()}))
