"""Values of the interpreter: what is known when C is written, and what only the run knows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from seatrial.errors import InputError

C_TYPES = {"d": "double", "i": "long long", "b": "int", "g": "Philox *"}
"""Kinds of values of the run: floats, whole numbers, truth values; generators that have begun."""


class TranslationError(InputError):
    """A construct that has no C, with the file and line where it stands."""


class MismatchError(TranslationError):
    """An operation on a value that Python would refuse too: of one alternative, the run's error."""


class EndedError(Exception):
    """Control does not come any further: the call has failed."""


class UnshapedError(Exception):
    """An attribute is read of which nothing has been seen yet."""


class Once:
    """The kind of a `Seq` that is gone through once, where it stands: a generator."""


class Zipped(Once):
    """The same of what ``zip``, ``enumerate`` and so on return: it may have a name until then."""


@dataclass(frozen=True)
class Known:
    """An object of Python, the same in every run."""

    value: Any


@dataclass(frozen=True)
class Num:
    """A number of the run: a kind of `C_TYPES` and the C variable or constant that has it."""

    kind: str
    text: str


@dataclass(eq=False)
class Seq:
    """A list or tuple of known length, or a `Once`.

    ``fresh``: a list that one name has, or none, and nothing else, so that it may change.
    """

    kind: type
    items: list[Any]
    fresh: bool = True
    spent: bool = False
    """Of one that is gone through once: it has been."""


@dataclass(eq=False)
class Record:
    """A named tuple or a data class."""

    cls: type
    fields: dict[str, Any]


@dataclass(eq=False)
class Table:
    """A dict with known keys."""

    items: dict[Any, Any]


@dataclass(eq=False)
class Choice:
    """One of several values that differ in structure; ``tag`` is a C expression of which."""

    tag: str
    alternatives: tuple[Any, ...]


@dataclass(frozen=True)
class Component:
    """The component itself: ``self``."""


@dataclass(frozen=True)
class Queue:
    """A list of records whose length the run knows: an attribute that is appended to."""

    name: str


@dataclass(frozen=True)
class Range:
    """A range whose ends the run knows: C expressions of them, and the step."""

    start: str
    stop: str
    step: int


@dataclass(frozen=True)
class FaultValues:
    """The numbers that the present fault of a sensor has for a setting, by its number."""

    key: int


@dataclass(eq=False)
class Draws:
    """A generator of random numbers, by stream and index; ``text``: where it is, once begun."""

    items: list[Any]
    text: str = ""


@dataclass(frozen=True)
class Unconverted:
    """What NumPy draws, an array or a whole number: to be converted before anything else."""

    value: Any


@dataclass(frozen=True)
class Method:
    """A function with its first argument, and the class that it was found in."""

    function: Any
    owner: type | None
    receiver: Any


@dataclass(frozen=True)
class OtherText:
    """A text that is none of those known."""

    known: tuple[str, ...]


@dataclass(frozen=True)
class OwnName:
    """The name of the instance, which the run gives: for messages alone."""


@dataclass(frozen=True)
class Closure:
    """A function inside a function."""

    node: Any
    frame: Any


@dataclass(frozen=True)
class Super:
    """What ``super()`` returns: attributes of the receiver's bases after ``owner``."""

    owner: type
    receiver: Any


def is_once(value: Any) -> bool:
    """Return whether a value can be gone through once only."""
    return isinstance(value, Seq) and issubclass(value.kind, Once)


def called(own: Any) -> str:
    """Return an object of Python as messages call it."""
    name = getattr(own, "__qualname__", "")
    if name:
        return f"{getattr(own, '__module__', '') or 'builtins'}.{name}".removeprefix("builtins.")
    return repr(own) if isinstance(own, (int, float, str, type(None))) else type(own).__qualname__


def described(value: Any) -> str:
    """Return a value as messages call it."""
    match value:
        case Known(value=own):
            return called(own)
        case Num():
            return "a number"
        case Seq(kind=kind, items=items):
            return f"a {kind.__name__} of {len(items)}"
        case Record(cls=cls):
            return f"a {cls.__name__}"
        case Choice(alternatives=alternatives):
            return " or ".join(dict.fromkeys(described(each) for each in alternatives))
        case Method(function=function):
            return function if isinstance(function, str) else called(function)
        case OwnName():
            return "the name of the component"
        case OtherText():
            return "another text"
        case Unconverted():
            return "what NumPy has drawn"
    names = {Table: "a dict", Queue: "a queue", Range: "a range whose length the run decides"}
    return names.get(type(value), "self")
