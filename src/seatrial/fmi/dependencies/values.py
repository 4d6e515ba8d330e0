"""Abstract values: which inputs a value follows from, and what is known of it besides."""

from __future__ import annotations

import ast
import types
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

Inputs = frozenset[str]
NONE: Inputs = frozenset()
_MOST_ITEMS = 64


class UndecidedError(Exception):
    """The text does something whose dependencies are unknown."""


class Cell:
    """What is behind a reference: an object that can change. It only ever follows from more."""

    def __init__(self) -> None:
        self.inputs: set[str] = set()
        self.carries = False
        """Whether it may hold the component, or a function that reads it."""
        self.changes = False
        """Whether something else than its items may be in it."""


@dataclass(frozen=True)
class Known:
    """An object of the program that is there before the component runs."""

    object: Any = field(hash=False)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Known) and other.object is self.object

    def __hash__(self) -> int:
        return id(self.object)


@dataclass(frozen=True)
class Callee:
    """A function of the component's text: its tree, whose globals it has, what it is bound to."""

    node: ast.FunctionDef | ast.Lambda
    function: types.FunctionType | None = field(compare=False)
    """Holds the globals and the defaults; of an inner function, those of the outer one."""
    owner: type | None
    """The class that defines it, for ``super()``."""
    first: Value | None = None
    closure: Any = field(default=None, compare=False)
    """The `interpreter.Frame` of the function around it."""

    @property
    def carries(self) -> bool:
        """Whether the component can be reached through it."""
        return self.first is not None or self.closure is not None


@dataclass(frozen=True)
class Value:
    """What an expression may be."""

    inputs: Inputs = NONE
    cells: frozenset[Cell] = frozenset()
    known: Known | None = None
    items: tuple[Value, ...] | None = None
    fields: tuple[str, ...] = ()
    """Names of the items, where they are attributes too."""
    callees: frozenset[Callee] = frozenset()
    is_self: bool = False

    @property
    def depends(self) -> Inputs:
        """The inputs that anything of it follows from."""
        found = set(self.inputs)
        for cell in self.cells:
            found |= cell.inputs
        for item in self.items or ():
            found |= item.depends
        return frozenset(found)

    @property
    def carries(self) -> bool:
        """Whether the component can be reached through it."""
        return (
            self.is_self
            or any(cell.carries for cell in self.cells)
            or any(callee.carries for callee in self.callees)
            or any(item.carries for item in self.items or ())
        )

    @property
    def parts(self) -> tuple[Value, ...] | None:
        """Its items, None where they are not known one by one."""
        if self.items is None or any(cell.changes for cell in self.cells):
            return None
        return tuple(self.part(item) for item in self.items)

    def part(self, item: Value) -> Value:
        """Return an item, or a part that is not known, with what the whole follows from."""
        return item.after(self.inputs, self.cells)

    def after(self, inputs: Inputs, cells: frozenset[Cell] = frozenset()) -> Value:
        """Return the same value where it follows from more ``inputs`` and ``cells``."""
        if inputs <= self.inputs and cells <= self.cells:
            return self
        known, items, fields = self.known, self.items, self.fields
        more, behind = self.inputs | inputs, self.cells | cells
        return Value(more, behind, known, items, fields, self.callees, self.is_self)


NOTHING = Value()


def mixed(values: Iterable[Value], inputs: Inputs = NONE) -> Value:
    """Return something made of values, which may hold them: nothing else is known of it."""
    found, behind = set(inputs), set[Cell]()
    waiting = list(values)
    while waiting:
        value = waiting.pop()
        found |= value.inputs
        behind |= value.cells
        waiting += value.items or ()
        if value.is_self or any(callee.carries for callee in value.callees):
            behind.add(_CARRIER)
    return Value(frozenset(found), frozenset(behind))


def computed(values: Iterable[Value]) -> Value:
    """Return a number or a text made of values: what becomes of them later changes it no more."""
    whole = mixed(values)
    return Value(whole.depends)


_CARRIER = Cell()
_CARRIER.carries = True
_LOOSE = Cell()
"""Of a value whose items are not known one by one, for ever: or joining would not come to rest."""
_LOOSE.changes = True
SHARED = frozenset({_CARRIER, _LOOSE})
"""Cells that say something of a value, and hold nothing."""


def joined(a: Value | None, b: Value | None) -> Value:
    """Return what is either value."""
    if a is None or b is None or a == b:
        return a or b or NOTHING
    inputs, cells = a.inputs | b.inputs, a.cells | b.cells
    items: tuple[Value, ...] | None = None
    fields: tuple[str, ...] = ()
    if _LOOSE not in cells and a.items is None and b.items is None:
        pass
    elif _LOOSE not in cells and a.items and b.items and len(a.items) == len(b.items):
        items = tuple(joined(x, y) for x, y in zip(a.items, b.items, strict=True))
        fields = a.fields if a.fields == b.fields else ()
    elif _LOOSE not in cells and _has_any(a):  # each item follows from what is behind the other
        items, fields = b.items, b.fields
    elif _LOOSE not in cells and _has_any(b):
        items, fields = a.items, a.fields
    else:
        inputs, cells = a.depends | b.depends, cells | {_LOOSE}
        cells |= {_CARRIER} if a.carries or b.carries else set()
    known = a.known if a.known == b.known else None
    callees = a.callees | b.callees
    return Value(inputs, cells, known, items, fields, callees, a.is_self or b.is_self)


def _has_any(value: Value) -> bool:
    """Say if the items of a value are not known, and may be as those of another."""
    return value.items is None and (value.known is None or value.known.object is None)


def constant(found: Any) -> Value:
    """Return the value of an object that is there before; sequences with their items."""
    items = None
    if isinstance(found, (tuple, list)) and len(found) <= _MOST_ITEMS:
        items = tuple(constant(one) for one in found)
    fields = tuple(getattr(found, "_fields", ())) if isinstance(found, tuple) else ()
    return Value(known=Known(found), items=items, fields=fields)
