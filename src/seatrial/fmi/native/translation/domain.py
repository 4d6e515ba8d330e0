"""Values of the interpreter: what is known when C is written, and what only the run knows."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ....errors import InputError

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


# ------------------------------------------------------------------ shapes


@dataclass(frozen=True)
class Shape:
    """What is known of a value: its ``form`` (Known, Num, ...), detail and parts."""

    form: type
    detail: Any
    parts: tuple[Shape, ...] = ()


class _Same:
    """A known object in a shape: equal if nothing could tell it from the other."""

    def __init__(self, value: Any) -> None:
        self.value = value
        plain = isinstance(value, (int, float, str, bool, type(None)))
        self.key = (type(value), repr(value)) if plain else (type(value), id(value))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


def is_record_class(cls: Any) -> bool:
    """Return whether a class is a named tuple or a data class."""
    if not isinstance(cls, type):
        return False
    return (issubclass(cls, tuple) and hasattr(cls, "_fields")) or dataclasses.is_dataclass(cls)


def field_names(cls: Any) -> list[str]:
    """Return the names of a record's fields."""
    if hasattr(cls, "_fields"):
        return list(cls._fields)
    return [field.name for field in dataclasses.fields(cls)]


def opened(value: Any) -> Any:
    """Return a known list, tuple, dict or record as a `Seq`, `Table` or `Record` of known parts."""
    if not isinstance(value, Known):
        return value
    own = value.value
    if is_record_class(type(own)):
        fields = {name: Known(getattr(own, name)) for name in field_names(type(own))}
        return Record(type(own), fields)
    if type(own) in (list, tuple):
        return Seq(type(own), [Known(each) for each in own], fresh=False)
    if isinstance(own, range):
        return Seq(range, [Known(each) for each in own], fresh=False)
    if isinstance(own, Mapping):
        return Table({key: Known(each) for key, each in own.items()})
    return value


def shape_of(value: Any) -> Shape:
    """Return the shape of a value."""
    match value:
        case Known(value=own) if not isinstance(own, (list, tuple)):
            return Shape(Known, _Same(own))
        case Known():
            return shape_of(opened(value))
        case Num(kind=kind):
            return Shape(Num, kind)
        case Seq(kind=kind, items=items):
            return Shape(Seq, kind, tuple(shape_of(i) for i in items))
        case Record(cls=cls, fields=fields):
            return Shape(Record, cls, tuple(shape_of(v) for v in fields.values()))
        case Table(items=items):
            return Shape(Table, tuple(items), tuple(shape_of(v) for v in items.values()))
        case Draws(text=text) if text:
            return Shape(Draws, "begun")
        case Draws(items=items):
            return Shape(Draws, None, tuple(shape_of(i) for i in items))
        case Choice(alternatives=alternatives):
            return Shape(Choice, None, tuple(shape_of(v) for v in alternatives))
    return Shape(type(value), value)  # the component, queues, methods: equal to themselves only


def number_kind(value: Any) -> str:
    """Return the kind of a number of Python, empty for anything else."""
    return {bool: "b", int: "i", float: "d"}.get(type(value), "")


def _number_kind(shape: Shape) -> str:
    if shape.form is Num:
        return str(shape.detail)
    return number_kind(shape.detail.value) if shape.form is Known else ""


def _one(a: Shape, b: Shape) -> Shape | None:
    """Return the shape of which both are, without a tag; None if there is none.

    A float and a whole number have none, nor have a list and a tuple: Python tells them apart.
    """
    if a == b:
        return a
    kind = _number_kind(a)
    if kind and kind == _number_kind(b):
        return Shape(Num, kind)
    same = a.form is b.form and a.detail == b.detail and len(a.parts) == len(b.parts)
    if same and a.form in (Seq, Record, Table):
        parts = tuple(joined(p, q) for p, q in zip(a.parts, b.parts, strict=True))
        return Shape(a.form, a.detail, parts)
    return None


def joined(a: Shape, b: Shape) -> Shape:
    """Return the shape of what is one or the other."""
    one = _one(a, b)
    if one is not None:
        return one
    found: list[Shape] = []
    for shape in (a, b):
        for each in shape.parts if shape.form is Choice else (shape,):
            for place, other in enumerate(found):
                both = _one(other, each)
                if both is not None and both.form is not Choice:
                    found[place] = both
                    break
            else:
                found.append(each)
    return found[0] if len(found) == 1 else Shape(Choice, None, tuple(found))


def leaves(shape: Shape) -> list[str]:
    """Return the kinds of the numbers that a value of this shape consists of."""
    if shape.form is Num:
        return [shape.detail]
    if shape == Shape(Draws, "begun"):
        return ["g"]
    tag = ["b"] if shape.form is Choice else []
    return tag + [kind for part in shape.parts for kind in leaves(part)]


def built(shape: Shape, texts: Iterator[str]) -> Any:
    """Return the value of a shape whose numbers are those C variables."""
    if shape.form is Known:
        return Known(shape.detail.value)
    if shape.form is Num:
        return Num(shape.detail, next(texts))
    if shape.form is Draws and shape.detail:
        return Draws([], next(texts))
    tag = next(texts) if shape.form is Choice else ""
    parts = [built(part, texts) for part in shape.parts]
    if shape.form is Seq:
        return Seq(shape.detail, parts, fresh=False)
    if shape.form is Record:
        return Record(shape.detail, dict(zip(field_names(shape.detail), parts, strict=True)))
    if shape.form is Table:
        return Table(dict(zip(shape.detail, parts, strict=True)))
    if shape.form is Draws:
        return Draws(parts)
    if shape.form is Choice:
        return Choice(tag, tuple(parts))
    return shape.detail


def fits(value: Any, shape: Shape) -> bool:
    """Return whether a value can be one of this shape without loss."""
    return joined(shape, shape_of(value)) == shape


def flattened(value: Any, shape: Shape) -> list[str | None]:
    """Return the C expressions of a value's numbers, in a shape that it fits; None: any will do."""
    if shape.form is Choice and not isinstance(value, Choice):
        at = _alternative(shape_of(value), shape)
        parts = [
            flattened(value, part) if i == at else [None] * len(leaves(part))
            for i, part in enumerate(shape.parts)
        ]
        return [str(at), *itertools.chain.from_iterable(parts)]
    if shape.form is Choice:
        return _retagged(value, shape)
    if shape.form is Num:
        return [number(value, shape.detail)]
    if shape.form is Draws and shape.detail:
        return [value.text]
    if shape.form in (Seq, Record, Table, Draws):
        pairs = zip(parts_of(value), shape.parts, strict=True)
        return [text for part, own in pairs for text in flattened(part, own)]
    return []


def parts_of(value: Any) -> Sequence[Any]:
    """Return the items of a list, record or dict."""
    value = opened(value)
    if isinstance(value, (Seq, Draws)):
        return value.items
    if isinstance(value, Record):
        return list(value.fields.values())
    return list(value.items.values())


def _alternative(own: Shape, shape: Shape) -> int:
    return next(i for i, part in enumerate(shape.parts) if _one(part, own) == part)


def _retagged(value: Choice, shape: Shape) -> list[str | None]:
    places = [_alternative(shape_of(each), shape) for each in value.alternatives]
    tag = value.tag
    if places != list(range(len(places))):
        tag = "0"
        for i, place in reversed(list(enumerate(places))):
            tag = f"{value.tag} == {i} ? {place} : ({tag})"
    texts: list[str | None] = []
    for at, part in enumerate(shape.parts):
        sources = [e for e, p in zip(value.alternatives, places, strict=True) if p == at]
        own = [flattened(e, part) for e in sources]
        if len(own) > 1:  # two alternatives that have become one
            tags = [i for i, p in enumerate(places) if p == at]
            own = [[_selected(value.tag, tags, column) for column in zip(*own, strict=True)]]
        texts += own[0] if own else [None] * len(leaves(part))
    return [tag, *texts]


def _selected(tag: str, tags: list[int], texts: Sequence[str | None]) -> str:
    found = texts[-1] or "0"
    for i, text in list(zip(tags, texts, strict=True))[-2::-1]:
        found = f"({tag} == {i} ? {text or '0'} : {found})"
    return found


def number(value: Any, kind: str = "") -> str:
    """Return the C expression of a number, as one of a kind if that is given."""
    if isinstance(value, Num):
        same = not kind or kind == value.kind
        return value.text if same else f"({C_TYPES[kind]}){value.text}"
    own = value.value
    kind = kind or number_kind(own)
    return constant(float(own) if kind == "d" else int(own))


def constant(value: float) -> str:
    """Return a number as C. Raises OverflowError for a whole number of more than 64 bits."""
    if isinstance(value, int):
        if abs(value) >= 2**63:
            raise OverflowError(f"{value} has more than 64 bits")
        return f"{value}LL" if abs(value) > 2**31 - 1 else f"({value})" if value < 0 else str(value)
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0.0 else "(-INFINITY)"
    return repr(value) if math.copysign(1.0, value) > 0.0 else f"({value!r})"
