"""Attributes, and the objects that they are of: the inputs from which their values follow."""

from __future__ import annotations

import ast
import functools
import inspect
import re
import types
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ...model.component import Component
from ...model.ports import Port
from ...model.terms import Terms
from .text import first_argument, methods, self_names, tree_of
from .values import (
    NONE,
    NOTHING,
    SHARED,
    Callee,
    Cell,
    Inputs,
    UndecidedError,
    Value,
    constant,
    joined,
    mixed,
)

_FIXED = (int, float, complex, bool, str, bytes, type(None), tuple, frozenset, range)
_MISSING = object()


class Attributes(ABC):
    """Reads and sets attributes within the frame of one call."""

    def __init__(self, cls: type[Component]) -> None:
        self.cls = cls
        self.frame: Any = None
        self.me = Value(is_self=True)
        self.condition: Inputs = NONE
        """What it follows from that the present statement runs."""
        self.read: set[str] = set()
        self.changed = False
        self.known_calls: dict[Any, Value] = {}
        self._before: dict[Any, Value] = {}
        self._asked: set[Any] = set()
        self.output_cells = {n: Cell() for n, p in cls.ports.items() if p.kind == "output"}
        self._attributes: dict[str, Cell] = {}
        self._elsewhere = Cell()
        """All objects that are there before the component and can change."""
        self._inner: dict[ast.AST, Cell] = {}
        self._carrying = carrying(cls)
        for name in ("__getattr__", "__getattribute__", "__setattr__"):
            if inspect.getattr_static(cls, name, None) is not getattr(object, name, None):
                raise UndecidedError(f"{cls.__name__} has a {name} of its own")
        self._assigned = {
            name for name, places in self_names(cls).items() if not all(p[2] for p in places)
        }

    # ------------------------------------------------------------------ of the other halves

    @abstractmethod
    def call(self, node: ast.Call) -> Value:
        """Return what a call gives."""

    @abstractmethod
    def call_value(self, callee: Value, given: list[Value], named: dict[str, Value]) -> Value:
        """Return what a call of ``callee`` gives."""

    @abstractmethod
    def assign(self, target: ast.expr, value: Value) -> None:
        """Let a target be ``value``."""

    @property
    def globals(self) -> Mapping[str, Any]:
        """The globals of the function that runs."""
        function = self.frame.code.function
        return function.__globals__ if function is not None else {}

    def undecided(self, node: ast.AST, why: str) -> UndecidedError:
        """Return the error for something that is not followed, with its line."""
        function = self.frame.code.function
        file = function.__code__.co_filename.replace("\\", "/").rpartition("/")[2]
        return UndecidedError(f"{file}, line {getattr(node, 'lineno', '?')}: {why}")

    # ------------------------------------------------------------------ cells

    def pour(self, into: Value, inputs: Inputs, *, carries: bool = False) -> None:
        """Let an object change by what follows from ``inputs``."""
        for cell in into.cells - SHARED:
            self.fill(cell, inputs, carries=carries)
            if not cell.changes:
                cell.changes = self.changed = True

    def fill(self, cell: Cell, inputs: Inputs, *, carries: bool = False) -> None:
        """Let what is in a cell follow from ``inputs``, and from the present condition."""
        more = inputs | self.condition
        if not more <= cell.inputs or (carries and not cell.carries):
            cell.inputs |= more
            cell.carries |= carries
            self.changed = True

    def made_at(self, node: ast.AST) -> frozenset[Cell]:
        """Return the cell of the objects that an expression makes."""
        return frozenset({self._inner.setdefault(node, Cell())})

    def object(self, found: Any) -> Value:
        """Return the value of an object that is there before the component."""
        if isinstance(found, types.FunctionType):
            return Value(known=constant(found).known)
        value = constant(found)
        fixed = (*_FIXED, type, Port, types.ModuleType, types.BuiltinFunctionType)
        if isinstance(found, fixed) or callable(found):
            return value
        return value.after(NONE, frozenset({self._elsewhere}))

    # ------------------------------------------------------------------ attributes

    def attribute(self, base: Value, name: str, node: ast.AST) -> Value:
        """Return an attribute of a value."""
        if base.is_self:
            return self.own(name, node)
        if name in base.fields and base.items is not None:
            return base.part(base.items[base.fields.index(name)])
        if base.known is not None:
            static = inspect.getattr_static(base.known.object, name, _MISSING)
            plain = isinstance(base.known.object, (types.ModuleType, type, Port))
            if static is not _MISSING and plain and not isinstance(static, property):
                return self.object(getattr(base.known.object, name)).after(base.inputs)
        return mixed([base]).after(NONE, base.cells)

    def own(self, name: str, node: ast.AST) -> Value:
        """Return an attribute of the component."""
        port = self.cls.ports.get(name)
        if port is not None:
            return self._port(port)
        if name in OPEN:
            raise self.undecided(node, f"self.{name} may be any port")
        static = inspect.getattr_static(self.cls, name, _MISSING)
        if isinstance(static, Terms):
            self.read |= set(static.names)
            every = Value(frozenset(static.names))
            axes = static.inputs[0].axes
            return every if axes is None else Value(items=(every,) * len(axes))
        if isinstance(static, types.FunctionType):
            return Value(callees=frozenset({self.method(static, name)}))
        if isinstance(static, property) and static.fget is not None:
            return self._computed(static.fget)
        if isinstance(static, functools.cached_property):
            return self._computed(static.func)
        if isinstance(static, classmethod):
            function: Any = static.__func__
            return Value(callees=frozenset({self.bound(function)}))
        if isinstance(static, staticmethod):
            return self.object(static.__func__)
        if hasattr(type(static), "__get__") and static is not _MISSING:
            return self._described(static, node)
        cell = self._attributes.setdefault(name, Cell())
        cell.carries |= name in self._carrying
        state = Value(cells=frozenset({cell}))
        if static is _MISSING or name in self._assigned:
            return state
        return joined(self.object(static), state) if cell.inputs else self.object(static)

    def _described(self, static: Any, node: ast.AST) -> Value:
        """Return what a descriptor with a text of its own gives."""
        function = inspect.getattr_static(type(static), "__get__")
        if not isinstance(function, types.FunctionType):
            raise self.undecided(node, f"{type(static).__name__} is not followed")
        callee = Callee(tree_of(function), function, type(static), self.object(static))
        return self.call_value(value_of(callee), [self.me, self.object(self.cls)], {})

    def named(self, pattern: re.Pattern[str], node: ast.AST) -> Value:
        """Return what the component has by any name that fits."""
        names = {*self.cls.ports, *self._assigned, *vars(self.cls)}
        found = [self.own(name, node) for name in sorted(names) if pattern.fullmatch(name)]
        if not found:
            raise self.undecided(node, "getattr of a name that the text does not say")
        return self.element(Value(items=tuple(found)))

    def _port(self, port: Port) -> Value:
        if port.kind == "output":
            one = Value(cells=frozenset({self.output_cells[port.name]}))
        elif port.kind == "input":
            self.read.add(port.name)
            one = Value(frozenset({port.name}))
        else:
            one = NOTHING
        return one if port.axes is None else Value(items=(one,) * port.size)

    def _computed(self, function: Any, *given: Value) -> Value:
        """Return what a property's function gives."""
        if not isinstance(function, types.FunctionType):
            raise UndecidedError(f"{function!r} is not followed")
        return self.call_value(value_of(self.bound(function)), list(given), {})

    def method(self, function: types.FunctionType, name: str) -> Callee:
        """Return a method bound to the component."""
        owner = next(base for base in self.cls.__mro__ if name in vars(base))
        return self.bound(function, owner)

    @abstractmethod
    def bound(self, function: types.FunctionType, owner: type | None = None) -> Callee:
        """Return a function bound to the component. Raises UndecidedError without its text."""

    def set_attribute(self, base: Value, name: str, value: Value, node: ast.AST) -> None:
        """Set an attribute of a value."""
        if not base.is_self:
            self.pour(base, value.depends, carries=value.carries)
            return
        static = inspect.getattr_static(self.cls, name, None)
        if name in self.output_cells:
            self.fill(self.output_cells[name], value.depends)
        elif isinstance(static, property) and static.fset is not None:
            self._computed(static.fset, value)
        elif name in self.cls.ports or name in OPEN:
            raise self.undecided(node, f"self.{name} is set within outputs")
        else:
            cell = self._attributes.setdefault(name, Cell())
            self.fill(cell, value.depends, carries=value.carries)

    def set_outputs(self, pattern: re.Pattern[str], value: Value) -> None:
        """Let any of the outputs be set whose name fits: more is not known of it."""
        for name, cell in self.output_cells.items():
            if pattern.fullmatch(name):
                self.fill(cell, value.depends)

    def element(self, value: Value) -> Value:
        """Return any item of a value."""
        parts = value.parts
        if not parts:
            return mixed([value]).after(NONE, value.cells)
        found = parts[0]
        for part in parts[1:]:
            found = joined(found, part)
        return found


def value_of(callee: Callee) -> Value:
    """Return the value of a function."""
    return Value(callees=frozenset({callee}))


OPEN = ("values", "__dict__")
"""Attributes that hold the ports without their names."""
_ASK = ("super", "isinstance", "type", "getattr", "hasattr", "id", "repr", "str", "vars")
"""Functions that keep nothing of what they are given."""


def carrying(cls: type) -> set[str]:
    """Return the attributes that may hold the component, or a function that reaches it."""
    found = set()
    for function in methods(cls):
        tree = tree_of(function)
        names = _aliases(tree, cls)
        for targets, value in _assignments(tree):
            if _reaches(value, names, cls):
                every = (one for target in targets for one in ast.walk(target))
                found |= {one.attr for one in every if isinstance(one, ast.Attribute)}
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                given = (*node.args, *(keyword.value for keyword in node.keywords))
                if any(_reaches(one, names, cls) for one in given):
                    behind = ast.walk(node.func.value)
                    found |= {one.attr for one in behind if isinstance(one, ast.Attribute)}
    return found


def _aliases(tree: ast.FunctionDef | ast.Lambda, cls: type) -> set[str]:
    """Return the local names that may be the component, or reach it."""
    names = {first_argument(tree) or ""}
    inner = (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))
    names |= {node.name for node in inner if node is not tree}
    while True:
        more = {
            one.id
            for targets, value in _assignments(tree)
            if _reaches(value, names, cls)
            for target in targets
            for one in ast.walk(target)
            if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
        }
        if more <= names:
            return names
        names |= more


def _assignments(tree: ast.AST) -> Iterator[tuple[Sequence[ast.expr], ast.expr]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign):
            yield node.targets, node.value
        elif isinstance(node, (ast.AnnAssign, ast.AugAssign, ast.NamedExpr)) and node.value:
            yield [node.target], node.value


def _reaches(value: ast.expr, names: set[str], cls: type) -> bool:
    """Say if a value may hold the component: one of ``names``, a method, an inner function."""
    passed: set[ast.AST] = set()
    for node in ast.walk(value):
        if isinstance(node, ast.Lambda):
            if any(_reads_class(one, names, cls) for one in ast.walk(node)):
                return True
        elif isinstance(node, ast.Call):
            passed.add(node.func)
            if isinstance(node.func, ast.Name) and node.func.id in _ASK:
                passed |= set(node.args)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            passed.add(node.value)
            static = inspect.getattr_static(cls, node.attr, None)
            is_method = isinstance(static, types.FunctionType) and node.value.id in names
            if is_method and (node not in passed or _makes_functions(static)):
                return True
        elif isinstance(node, ast.Name) and node.id in names and node not in passed:
            return True
    return False


def _reads_class(node: ast.AST, names: set[str], cls: type) -> bool:
    """Say if a part of an inner function reads a port, a method or a property of the component."""
    if not (isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)):
        return False
    static = inspect.getattr_static(cls, node.attr, None)
    return node.value.id in names and (node.attr in OPEN or hasattr(type(static), "__get__"))


def _makes_functions(function: types.FunctionType) -> bool:
    tree = tree_of(function)
    made = (node for node in ast.walk(tree) if isinstance(node, (ast.Lambda, ast.FunctionDef)))
    return any(node is not tree for node in made)
