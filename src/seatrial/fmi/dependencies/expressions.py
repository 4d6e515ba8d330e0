"""Expressions and names: the inputs from which their values follow."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Sequence
from typing import Any

from .attributes import Attributes
from .values import NONE, NOTHING, Callee, Value, computed, constant, joined, mixed

_FIXED = (int, float, complex, bool, str, bytes, type(None), tuple, frozenset, range)
_MISSING = object()


class Expressions(Attributes):
    """Evaluates expressions within the frame of one call."""

    # ------------------------------------------------------------------ items

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


def _plain(nodes: Sequence[ast.expr]) -> list[ast.expr]:
    return [one.value if isinstance(one, ast.Starred) else one for one in nodes]


def _number(value: Value) -> int | None:
    found = None if value.known is None else value.known.object
    return found if isinstance(found, int) else None
