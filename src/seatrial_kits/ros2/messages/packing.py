"""Messages as bytes, made of plain values: plain CDR, little-endian, as in DDSI-RTPS 2.2, 10.2.

Each primitive is aligned to its own size, counted from behind the four bytes of the encapsulation.
A message's values are gathered flat, by code that is made once for each type, and packed at once
by a format that is known from the lengths of its texts and sequences.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping
from functools import cache, lru_cache
from typing import Any

from .definitions import type_store

Values = list[Any]
Lengths = list[int]
Gather = Callable[[Any, Values, Lengths], None]
Layout = Callable[[Iterator[int], list[tuple[int, str]]], None]

_ENCAPSULATION = b"\x00\x01\x00\x00"
_FORMATS = {
    "bool": "?", "byte": "B", "char": "B", "octet": "B", "float32": "f", "float64": "d",
    "int8": "b", "int16": "h", "int32": "i", "int64": "q",
    "uint8": "B", "uint16": "H", "uint32": "I", "uint64": "Q",
}  # fmt: skip


def packed(kind: str, values: Mapping[str, Any]) -> bytes:
    """Return the message of the type ``kind``; what is not given is 0, empty or False.

    A nested message is a mapping too, or a tuple of its fields in their order; times are whole
    nanoseconds. Raises KeyError for a field that the type has not.
    """
    gathered: Values = []
    lengths: Lengths = []
    _gather(kind)(values, gathered, lengths)
    return _ENCAPSULATION + _format(kind, tuple(lengths)).pack(*gathered)


@lru_cache(maxsize=1024)
def _format(kind: str, lengths: tuple[int, ...]) -> struct.Struct:
    """Return the format of a message whose texts and sequences have these lengths."""
    parts: list[tuple[int, str]] = []
    _layout(kind)(iter(lengths), parts)
    at, text = 0, "<"
    for size, code in parts:
        gap = -at % size
        text += f"{gap}x{code}" if gap else code
        at += gap + struct.calcsize(f"<{code}")
    return struct.Struct(text)


@cache
def _gather(kind: str) -> Gather:
    """Return what appends a message's values, and the lengths of its texts and sequences."""
    if kind == "builtin_interfaces/msg/Time":
        return lambda time, out, _: out.extend(divmod(time or 0, 1_000_000_000))
    fields = [(name, _gather_field(entry)) for name, entry in type_store().fielddefs[kind][1]]
    names = frozenset(name for name, _ in fields)

    def gather(values: Any, out: Values, lengths: Lengths) -> None:
        if isinstance(values, tuple):
            for (_, each), value in zip(fields, values, strict=True):
                each(value, out, lengths)
            return
        given = values or {}
        if not names.issuperset(given):
            raise KeyError(f"{kind} has no {sorted(given.keys() - names)}")
        for name, each in fields:
            each(given.get(name), out, lengths)

    return gather


def _gather_field(entry: Any) -> Gather:
    from rosbags.interfaces import Nodetype

    sort, what = entry
    if sort == Nodetype.NAME:
        return _gather(what)
    if sort == Nodetype.BASE:
        zero = 0.0 if what[0].startswith("float") else 0
        return _text if what[0] == "string" else _number(zero)
    inner, size = what
    fixed = size if sort == Nodetype.ARRAY else None
    if inner[0] == Nodetype.BASE and inner[1][0] != "string":
        return _numbers((0,) * (fixed or 0), fixed)
    return _elements(_gather_field(inner), fixed)


def _text(value: Any, out: Values, lengths: Lengths) -> None:
    encoded = (value or "").encode() + b"\0"
    lengths.append(len(encoded))
    out += (len(encoded), encoded)


def _number(zero: float) -> Gather:
    return lambda value, out, _: out.append(zero if value is None else value)


def _numbers(zeros: tuple[int, ...], fixed: int | None) -> Gather:
    def gather(values: Any, out: Values, lengths: Lengths) -> None:
        given = zeros if values is None else values
        if fixed is None:
            lengths.append(len(given))
            out.append(len(given))
        elif len(given) != fixed:
            raise ValueError(f"{len(given)} numbers are given, {fixed} are needed")
        out.extend(given)

    return gather


def _elements(each: Gather, fixed: int | None) -> Gather:
    def gather(values: Any, out: Values, lengths: Lengths) -> None:
        given = values or (() if fixed is None else (None,) * fixed)
        if fixed is None:
            lengths.append(len(given))
            out.append(len(given))
        for value in given:
            each(value, out, lengths)

    return gather


@cache
def _layout(kind: str) -> Layout:
    """Return what appends the alignments and formats of a message, as `_gather` its values."""
    fields = [_layout_field(entry) for _, entry in type_store().fielddefs[kind][1]]

    def layout(lengths: Iterator[int], out: list[tuple[int, str]]) -> None:
        for each in fields:
            each(lengths, out)

    return layout


def _layout_field(entry: Any) -> Layout:
    from rosbags.interfaces import Nodetype

    sort, what = entry
    if sort == Nodetype.NAME:
        return _layout(what)
    if sort == Nodetype.BASE:
        if what[0] == "string":
            return lambda lengths, out: out.extend([(4, "I"), (1, f"{next(lengths)}s")])
        code = _FORMATS[what[0]]
        return lambda _, out: out.append((struct.calcsize(code), code))
    inner, size = what
    fixed, element = size if sort == Nodetype.ARRAY else None, _layout_field(inner)

    def layout(lengths: Iterator[int], out: list[tuple[int, str]]) -> None:
        count = fixed
        if count is None:
            count = next(lengths)
            out.append((4, "I"))
        for _ in range(count):
            element(lengths, out)

    return layout
