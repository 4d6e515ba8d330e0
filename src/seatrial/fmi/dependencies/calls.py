"""Calls: the component's own functions are run, others follow from all that they are given."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import re
import types
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ...model.plant import Plant
from .expressions import Expressions
from .text import tree_of
from .values import NONE, NOTHING, Callee, Inputs, Value, computed, constant, joined, mixed

_DEEPEST = 60
_OPAQUE = (eval, exec, locals, globals, compile, __import__)
_SCALARS = (float, int, bool, str, bytes, complex, len, abs, round, any, all, repr, ord, chr)
_COPIES = (tuple, list, set, frozenset, dict, range)


class Calls(Expressions):
    """Follows calls."""

    depth = 0
    publishes: Callable[[], Mapping[str, Sequence[str]]]
    """The inputs by output of a plant's equations."""

    def call_method(self, name: str, given: list[Value], named: dict[str, Value]) -> Value:
        """Call a method of the component."""
        static = inspect.getattr_static(self.cls, name)
        if not isinstance(static, types.FunctionType):
            return self.call_value(self.own(name, ast.Pass()), given, named)
        return self._run(self.method(static, name), given, named)

    def bound(self, function: types.FunctionType, owner: type | None = None) -> Callee:
        """Return a function bound to the component. Raises UndecidedError without its text."""
        return Callee(tree_of(function), function, owner, self.me)

    def call(self, node: ast.Call) -> Value:
        """Return what a call gives. Raises UndecidedError."""
        if isinstance(node.func, ast.Name) and node.func.id == "super":
            raise self.undecided(node, "super() is followed before a method's name only")
        given, loose = self._given(node)
        named = {k.arg: self.evaluate(k.value) for k in node.keywords if k.arg is not None}
        rest = [self.evaluate(k.value) for k in node.keywords if k.arg is None]
        if isinstance(node.func, ast.Attribute):
            if _is_super(node.func.value):
                return self._call_super(node, given, named)
            answer = self._call_on(node, given, named)
            if answer is not None:
                return answer
        callee = self.evaluate(node.func)
        if loose or rest:
            every = mixed([*given, *named.values(), *rest])
            if callee.callees:
                return self._called_loosely(callee, every)
            given, named = [every], {}
        with_self = [one for one in (*given, *named.values()) if one.carries]
        builtin = self._builtin(node, callee, given) if callee.known is not None else None
        if builtin is not None:
            return builtin
        if callee.known is None and not callee.callees and (callee.carries or with_self):
            raise self.undecided(node, f"{ast.unparse(node.func)} may read any input")
        try:
            found = self.call_value(callee, given, named)
            makes = not callee.callees and not _is_scalar(callee)
            return found.after(NONE, self.made_at(node)) if makes else found
        except RecursionError:
            raise self.undecided(node, "calls are nested too deeply") from None

    def _given(self, node: ast.Call) -> tuple[list[Value], bool]:
        """Return the arguments by position, and whether their number is unknown."""
        given: list[Value] = []
        loose = False
        for one in node.args:
            if isinstance(one, ast.Starred):
                value = self.evaluate(one.value)
                parts = value.parts
                loose = loose or parts is None
                given += [mixed([value])] if parts is None else parts
            else:
                given.append(self.evaluate(one))
        return given, loose

    def _called_loosely(self, callee: Value, every: Value) -> Value:
        """Call functions of the component with arguments whose number is not known."""
        found = NOTHING
        for one in callee.callees:
            arguments = one.node.args
            count = len([*arguments.posonlyargs, *arguments.args]) - (one.first is not None)
            found = joined(found, self._run(one, [every] * count, {}))
        return found.after(every.depends)

    def _call_super(self, node: ast.Call, given: list[Value], named: dict[str, Value]) -> Value:
        """Call a method of the classes behind the one whose text runs."""
        assert isinstance(node.func, ast.Attribute)
        owner = self.frame.code.owner
        if owner is None or owner not in self.cls.__mro__:
            raise self.undecided(node, "the class that super() means is unknown")
        behind = self.cls.__mro__[self.cls.__mro__.index(owner) + 1 :]
        for base in behind:
            static = vars(base).get(node.func.attr)
            if isinstance(static, types.FunctionType):
                return self._run(self.bound(static, base), given, named)
            if static is not None and base is not object:
                raise self.undecided(node, f"{node.func.attr} of {base.__name__} is not followed")
        return NOTHING

    def _call_on(self, node: ast.Call, given: list[Value], named: dict[str, Value]) -> Value | None:
        """Return what the call of a method of an object gives, None where it is none."""
        assert isinstance(node.func, ast.Attribute)
        base = self.evaluate(node.func.value)
        if base.is_self:
            return self._call_own(node, given, named)
        known = None if base.known is None else base.known.object
        if isinstance(known, type) and given and given[0].is_self:  # Base.method(self, ...)
            static = inspect.getattr_static(known, node.func.attr, None)
            if isinstance(static, types.FunctionType):
                return self._run(self.bound(static, known), given[1:], named)
        if isinstance(known, (types.ModuleType, type)) or node.func.attr in base.fields:
            return None
        every = [*given, *named.values()]
        if base.carries or any(one.carries for one in every if not one.callees):
            raise self.undecided(node, f"{ast.unparse(node.func)} may read any input")
        back = self._called_back(every)
        self.pour(base, mixed([*every, back]).depends)
        for one in every:
            self.pour(one, base.depends | mixed(every).depends)
        return mixed([base, back, *every]).after(NONE, base.cells | self.made_at(node))

    def _call_own(
        self, node: ast.Call, given: list[Value], named: dict[str, Value]
    ) -> Value | None:
        """Return what `Component.get` and `set` do where their text does not say it."""
        assert isinstance(node.func, ast.Attribute)
        name = node.func.attr
        if name in ("get", "set", "read", "write", "reader", "writer", "refresh", "advance"):
            static = inspect.getattr_static(self.cls, name, None)
            if getattr(static, "__module__", "") == "seatrial.model.component":
                port = _text(given[0]) if name in ("get", "set") and given else None
                if port is None or port not in self.cls.ports:
                    raise self.undecided(node, f"self.{name} may mean any port")
                if name == "get":
                    return self.own(port, node)
                self.set_attribute(self.me, port, given[1], node)
                return NOTHING
        return None

    # ------------------------------------------------------------------ functions of Python

    def _builtin(self, node: ast.Call, callee: Value, given: list[Value]) -> Value | None:
        """Return what some functions of Python give that take the component, or sequences."""
        function = callee.known.object if callee.known is not None else None
        if function in _OPAQUE:
            raise self.undecided(node, f"{ast.unparse(node.func)} may read any input")
        if function in (getattr, setattr, hasattr) and given and given[0].is_self:
            return self._by_name(node, function, given)
        if function is setattr and given:
            self.pour(given[0], mixed(given).depends, carries=mixed(given).carries)
        if function in (isinstance, type, id, super, hasattr, callable, issubclass):
            return mixed(one for one in given if not one.is_self)
        if function in (zip, enumerate, reversed, tuple, list, len):
            return self._of_sequences(function, given, node)
        return None

    def _by_name(self, node: ast.Call, function: Any, given: list[Value]) -> Value:
        """Return an attribute of the component, or set it, by a name that may not be known."""
        name = _text(given[1]) if len(given) > 1 else None
        if function is hasattr:
            return NOTHING
        if function is setattr:
            if name is None:
                self.set_outputs(_pattern(given[1]) or re.compile(".*"), mixed(given[1:]))
            else:
                self.set_attribute(self.me, name, given[2], node)
            return NOTHING
        if name is None:
            pattern = _pattern(given[1]) or re.compile("(?!)")
            return self.named(pattern, node).after(given[1].depends)
        return joined(self.own(name, node), given[2]) if len(given) > 2 else self.own(name, node)

    def _of_sequences(self, function: Any, given: list[Value], node: ast.Call) -> Value | None:
        parts = [one.parts for one in given]
        sizes = {len(one) for one in parts if one is not None}
        if function is len:
            return constant(sizes.pop()) if sizes else None
        if function is zip and len(sizes) == 1:  # those of unknown length are as long, or longer
            size = sizes.pop()
            rows = [p or (self.element(one),) * size for p, one in zip(parts, given, strict=True)]
            return Value(items=tuple(Value(items=row) for row in zip(*rows, strict=True)))
        if len(given) != 1 or parts[0] is None:
            return None
        items = parts[0]
        if function is enumerate:
            items = tuple(Value(items=(constant(i), one)) for i, one in enumerate(items))
        elif function is reversed:
            items = items[::-1]
        return Value(items=items, cells=self.made_at(node) if function is list else frozenset())

    # ------------------------------------------------------------------ any function

    def call_value(self, callee: Value, given: list[Value], named: dict[str, Value]) -> Value:
        """Return what a call of ``callee`` gives."""
        found: Value | None = None
        for one in sorted(callee.callees, key=lambda c: getattr(c.node, "lineno", 0)):
            found = joined(found, self._run(one, given, named))
        if found is not None:
            return found.after(callee.inputs)
        every = [*given, *named.values()]
        known = None if callee.known is None else callee.known.object
        if isinstance(known, types.FunctionType) and any(one.carries for one in every):
            return self._run(Callee(tree_of(known), known, None), given, named)
        if isinstance(known, type) and (made := self._record(known, given, named)) is not None:
            return made
        if known is not None and any(one.is_self for one in every):
            raise self.undecided(ast.Pass(), f"{known} is given the component")
        back = self._called_back(every)
        met = mixed([callee, back, *every])
        if _is_scalar(callee):
            return computed([met])
        if not (known in _COPIES or getattr(known, "__module__", "") == "builtins"):
            for each in every:
                self.pour(each, met.depends, carries=met.carries)
        return met

    def _called_back(self, every: Sequence[Value]) -> Value:
        """Return what functions give that are arguments: what is called calls them, perhaps."""
        others = mixed(one for one in every if not one.callees)
        found = NOTHING
        for one in every:
            if one.callees:
                found = joined(found, self._called_loosely(one, others))
        return found

    def _record(self, cls: type, given: list[Value], named: dict[str, Value]) -> Value | None:
        """Return a named tuple or a data class, with its fields, None where it is neither."""
        if issubclass(cls, tuple) and hasattr(cls, "_fields") and "__new__" in vars(cls):
            names, fallback = tuple(cls._fields), dict(getattr(cls, "_field_defaults", {}))
        elif dataclasses.is_dataclass(cls) and not hasattr(cls, "__post_init__"):
            names = tuple(one.name for one in dataclasses.fields(cls) if one.init)
            fallback = {}
        else:
            return None
        if len(given) > len(names):
            return None
        values = dict(zip(names, given, strict=False)) | named
        made = [values.get(n) or self.object(fallback.get(n)) for n in names]
        return Value(items=tuple(made), fields=names)

    def _run(self, callee: Callee, given: list[Value], named: dict[str, Value]) -> Value:
        """Run a function of the component's text with arguments."""
        if callee.function in (Plant.outputs, Plant._publish):
            return self._publish()
        if callee.function is Plant._load:  # copies inputs to where the equations take them
            return NOTHING
        positional = [*([callee.first] if callee.first is not None else []), *given]
        key = None
        if callee.closure is None and not any(one.callees for one in (*given, *named.values())):
            key = (callee, (*positional,), (*sorted(named.items()),), self.condition)
            if key in self.known_calls:
                self._asked.add(key)
                return self.known_calls[key]
            self.known_calls[key] = self._before.get(key, NOTHING)
        if self.depth > _DEEPEST:
            raise RecursionError
        names = self._bound_names(callee, positional, named)
        self.depth += 1
        try:
            frame = Frame(names, callee)
            if isinstance(callee.node, ast.Lambda):
                returning = ast.copy_location(ast.Return(callee.node.body), callee.node.body)
                found: Value = self.run_body(frame, [returning])  # type: ignore[attr-defined]
            else:
                found = self.run_body(frame, callee.node.body)  # type: ignore[attr-defined]
        finally:
            self.depth -= 1
        if key is not None:
            if key in self._asked:  # within itself, perhaps
                found = joined(self._before.get(key), found)
                self.changed |= found != self._before.get(key)
                self._before[key] = found
            self.known_calls[key] = found
        return found

    def _bound_names(
        self, callee: Callee, positional: list[Value], named: dict[str, Value]
    ) -> dict[str, Value]:
        """Return the arguments of a call by the names of the parameters."""
        arguments = callee.node.args
        parameters = [one.arg for one in (*arguments.posonlyargs, *arguments.args)]
        function = callee.function if callee.closure is None else None
        defaults = (function.__defaults__ or ()) if function is not None else ()
        names: dict[str, Value] = {}
        last = parameters[len(parameters) - len(defaults) :]
        names |= dict(zip(last, map(self.object, defaults), strict=True))
        if callee.closure is not None:
            first = len(parameters) - len(arguments.defaults)
            for name, node in zip(parameters[first:], arguments.defaults, strict=True):
                names[name] = self.evaluate(node)
        for name, value in ((function and function.__kwdefaults__) or {}).items():
            names[name] = self.object(value)
        names |= dict(zip(parameters, positional, strict=False))
        if arguments.vararg is not None:
            names[arguments.vararg.arg] = Value(items=(*positional[len(parameters) :],))
        own = {*parameters, *(one.arg for one in arguments.kwonlyargs)}
        names |= {name: value for name, value in named.items() if name in own}
        if arguments.kwarg is not None:
            others = [value for name, value in named.items() if name not in own]
            names[arguments.kwarg.arg] = mixed(others)
        return names

    def _publish(self) -> Value:
        """Do what `Plant.outputs` does: the states follow from no input, the rest as it says."""
        for name, inputs in self.publishes().items():
            self.fill(self.output_cells[name], frozenset(inputs))
        return NOTHING


def _is_scalar(callee: Value) -> bool:
    """Say if a function gives a number or a text, and keeps nothing."""
    known = None if callee.known is None else callee.known.object
    return known in _SCALARS or getattr(known, "__module__", "") == "math"


def _is_super(node: ast.expr) -> bool:
    return (
        isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "super"
    )


def _pattern(value: Value) -> re.Pattern[str] | None:
    found = None if value.known is None else value.known.object
    return found if isinstance(found, re.Pattern) else None


def _text(value: Value) -> str | None:
    found = None if value.known is None else value.known.object
    return found if isinstance(found, str) else None


@dataclass
class Frame:
    """One call of a function."""

    names: dict[str, Value]
    code: Callee
    left: Inputs = NONE
    """What it follows from that the rest of the function runs at all."""
    returned: Value | None = None
    broken: list[list[dict[str, Value]]] = field(default_factory=list)
    """Names as they are where the loops around are left early."""
