"""Shapes of values: what is known of them when C is written, and their numbers in C."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .constants import is_record
from .domain import C_TYPES, Choice, Draws, Known, Num, Record, Seq, Table, TranslationError

MOST = 100_000
"""Parts, or bits, of a value that is computed when C is written."""
_KINDS = 32
"""Alternatives of a `Choice`: each takes a branch of C wherever the value is used."""


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
    if is_record(type(own)):
        fields = {name: Known(getattr(own, name)) for name in field_names(type(own))}
        return Record(type(own), fields)
    if type(own) in (list, tuple):
        return Seq(type(own), [Known(each) for each in own], fresh=False)
    if isinstance(own, range):
        if len(own) > MOST:
            raise TranslationError(f"{own}, gone through before the run, has no C")
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
    if len(found) > _KINDS:
        raise TranslationError(f"more than {_KINDS} kinds of values under one name have no C")
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
