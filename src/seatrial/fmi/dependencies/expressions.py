"""Expressions, attributes and names: which inputs their values follow from."""

from __future__ import annotations

import ast
import builtins
import functools
import inspect
import re
import types
from collections.abc import Mapping, Sequence
from typing import Any

from ...component import Component
from ...ports import Port
from ...terms import Terms
from .reach import OPEN, carrying
from .text import self_names, tree_of
from .values import (
    NONE,
    NOTHING,
    SHARED,
    Callee,
    Cell,
    Inputs,
    UndecidedError,
    Value,
    computed,
    constant,
    joined,
    mixed,
)

_FIXED = (int, float, complex, bool, str, bytes, type(None), tuple, frozenset, range)
_MISSING = object()


class Expressions:
    """Evaluates expressions within the frame of one call."""

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

    # what the other halves of the interpreter add
    def call(self, node: ast.Call) -> Value:
        """Return what a call gives."""
        raise NotImplementedError

    def call_value(self, callee: Value, given: list[Value], named: dict[str, Value]) -> Value:
        """Return what a call of ``callee`` gives."""
        raise NotImplementedError

    def assign(self, target: ast.expr, value: Value) -> None:
        """Let a target be ``value``."""
        raise NotImplementedError

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
        return self.call_value(_of(callee), [self.me, self.object(self.cls)], {})

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
        return self.call_value(_of(self.bound(function)), list(given), {})

    def method(self, function: types.FunctionType, name: str) -> Callee:
        """Return a method bound to the component."""
        owner = next(base for base in self.cls.__mro__ if name in vars(base))
        return self.bound(function, owner)

    def bound(self, function: types.FunctionType, owner: type | None = None) -> Callee:
        """Return a function bound to the component. Raises UndecidedError without its text."""
        raise NotImplementedError

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

    # ------------------------------------------------------------------ items

    def element(self, value: Value) -> Value:
        """Return any item of a value."""
        parts = value.parts
        if not parts:
            return mixed([value]).after(NONE, value.cells)
        found = parts[0]
        for part in parts[1:]:
            found = joined(found, part)
        return found

    def iterated(self, value: Value, node: ast.AST) -> tuple[Value, ...] | None:
        """Return the items that an iteration visits, None where they are not known."""
        return value.parts

    # ------------------------------------------------------------------ expressions

    def evaluate(self, node: ast.expr) -> Value:
        """Return the value of an expression. Raises UndecidedError."""
        method = getattr(self, f"_value_{type(node).__name__}", None)
        if method is not None:
            found: Value = method(node)
            return found
        if isinstance(node, ast.Await):
            raise self.undecided(node, "await is not followed")
        parts = [one for one in ast.iter_child_nodes(node) if isinstance(one, ast.expr)]
        if isinstance(node, (ast.Compare, ast.UnaryOp, ast.FormattedValue)):
            return computed(map(self.evaluate, parts))
        return mixed(map(self.evaluate, parts)).after(NONE, self.made_at(node))

    def _value_Constant(self, node: ast.Constant) -> Value:
        return constant(node.value)

    def _value_JoinedStr(self, node: ast.JoinedStr) -> Value:
        """Return the text, as a pattern where parts of it are not known."""
        parts, known, pattern = [], "", ""
        for one in node.values:
            value = self.evaluate(one.value if isinstance(one, ast.FormattedValue) else one)
            found = None if value.known is None else value.known.object
            plain = isinstance(found, (str, int)) and not getattr(one, "format_spec", None)
            known, pattern = f"{known}{found}", pattern + (re.escape(str(found)) if plain else ".*")
            parts.append(value if not plain else NOTHING)
        depends = mixed(parts).depends
        whole = pattern == re.escape(known)
        return constant(known if whole else re.compile(pattern)).after(depends)

    def _value_Name(self, node: ast.Name) -> Value:
        around: Any = self.frame
        while around is not None:  # the functions around, with what their names are by now
            if node.id in around.names:
                found: Value = around.names[node.id]
                return found
            code, around = around.code, around.code.closure
        function = code.function
        if function is not None and node.id in function.__code__.co_freevars:
            if node.id == "__class__":
                return self.object(code.owner)
            index = function.__code__.co_freevars.index(node.id)
            try:
                return self.object(function.__closure__[index].cell_contents)
            except ValueError:  # it is not set yet
                return NOTHING
        if node.id in self.globals:
            return self.object(self.globals[node.id])
        if not hasattr(builtins, node.id):
            raise self.undecided(node, f"{node.id} is unknown")
        return self.object(getattr(builtins, node.id))

    def _value_Attribute(self, node: ast.Attribute) -> Value:
        return self.attribute(self.evaluate(node.value), node.attr, node)

    def _value_Tuple(self, node: ast.Tuple) -> Value:
        items: list[Value] = []
        for one in node.elts:
            if isinstance(one, ast.Starred):
                value = self.evaluate(one.value)
                parts = value.parts
                if parts is None:
                    return mixed([*items, value, *map(self.evaluate, _plain(node.elts))])
                items += parts
            else:
                items.append(self.evaluate(one))
        return Value(items=tuple(items))

    def _value_List(self, node: ast.List) -> Value:
        found = self._value_Tuple(ast.copy_location(ast.Tuple(node.elts, ast.Load()), node))
        return found.after(NONE, self.made_at(node))

    def _value_Set(self, node: ast.Set) -> Value:
        return mixed(map(self.evaluate, node.elts)).after(NONE, self.made_at(node))

    def _value_Dict(self, node: ast.Dict) -> Value:
        parts = [self.evaluate(one) for one in (*node.keys, *node.values) if one is not None]
        return mixed(parts).after(NONE, self.made_at(node))

    def _value_Subscript(self, node: ast.Subscript) -> Value:
        base, index = self.evaluate(node.value), self.evaluate(node.slice)
        parts = base.parts
        if parts is not None and isinstance(node.slice, ast.Slice):
            edges = [node.slice.lower, node.slice.upper, node.slice.step]
            numbers = [None if one is None else _number(self.evaluate(one)) for one in edges]
            if all(one is None or n is not None for one, n in zip(edges, numbers, strict=True)):
                return Value(items=parts[slice(*numbers)]).after(NONE, base.cells)
        elif parts is not None:
            place = _number(index)
            if place is not None and -len(parts) <= place < len(parts):
                return parts[place]
        return self.element(base).after(index.depends)

    def _value_IfExp(self, node: ast.IfExp) -> Value:
        test = self.evaluate(node.test)
        with self.under(test.depends):  # type: ignore[attr-defined]
            found = joined(self.evaluate(node.body), self.evaluate(node.orelse))
        return found.after(test.depends)

    def _value_BoolOp(self, node: ast.BoolOp) -> Value:
        found, met = self.evaluate(node.values[0]), NONE
        for one in node.values[1:]:
            met |= found.depends
            with self.under(met):  # type: ignore[attr-defined]
                found = joined(found, self.evaluate(one))
        return found.after(met)

    def _value_NamedExpr(self, node: ast.NamedExpr) -> Value:
        value = self.evaluate(node.value)
        self.assign(node.target, value)
        return value

    def _value_Yield(self, node: ast.Yield | ast.YieldFrom) -> Value:
        value = NOTHING if node.value is None else self.evaluate(node.value)
        self.frame.returned = joined(
            self.frame.returned, mixed([value]).after(self.condition, value.cells)
        )
        return NOTHING

    _value_YieldFrom = _value_Yield

    def _value_Lambda(self, node: ast.Lambda) -> Value:
        return self.inner_function(node)

    def inner_function(self, node: ast.FunctionDef | ast.Lambda) -> Value:
        """Return a function that is defined in the one that runs."""
        code: Any = self.frame.code
        callee = Callee(node, code.function, code.owner, None, self.frame)
        return Value(callees=frozenset({callee}))

    def _value_Call(self, node: ast.Call) -> Value:
        return self.call(node)

    def _value_ListComp(self, node: ast.ListComp) -> Value:
        return self._comprehension(node.generators, [node.elt]).after(NONE, self.made_at(node))

    def _value_SetComp(self, node: ast.SetComp) -> Value:
        return mixed([self._comprehension(node.generators, [node.elt])]).after(
            NONE, self.made_at(node)
        )

    def _value_GeneratorExp(self, node: ast.GeneratorExp) -> Value:
        return self._comprehension(node.generators, [node.elt])

    def _value_DictComp(self, node: ast.DictComp) -> Value:
        found = self._comprehension(node.generators, [node.key, node.value])
        return mixed([found]).after(NONE, self.made_at(node))

    def _comprehension(
        self, generators: Sequence[ast.comprehension], made: Sequence[ast.expr]
    ) -> Value:
        """Return what a comprehension makes, item by item where they are known."""
        outer = dict(self.frame.names)
        try:
            first = generators[0]
            over = self.evaluate(first.iter)
            parts = self.iterated(over, first.iter)
            known = parts is not None and len(generators) == 1 and not first.ifs
            items, met = [], NONE
            for part in parts if parts is not None else (self.element(over),):
                self.assign(first.target, part)
                tests = [self.evaluate(one) for one in first.ifs]
                met |= mixed(tests).depends
                if len(generators) > 1:
                    items.append(self._comprehension(generators[1:], made))
                else:
                    values = [self.evaluate(one) for one in made]
                    items.append(values[0] if len(values) == 1 else mixed(values))
            if known:
                return Value(over.inputs, items=tuple(items))
            return mixed(items, met | over.depends)
        finally:
            self.frame.names = outer


def _of(callee: Callee) -> Value:
    return Value(callees=frozenset({callee}))


def _plain(nodes: Sequence[ast.expr]) -> list[ast.expr]:
    return [one.value if isinstance(one, ast.Starred) else one for one in nodes]


def _number(value: Value) -> int | None:
    found = None if value.known is None else value.known.object
    return found if isinstance(found, int) else None
