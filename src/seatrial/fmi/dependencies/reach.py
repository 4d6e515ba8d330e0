"""Attributes through which the component itself can be reached."""

from __future__ import annotations

import ast
import inspect
import types
from collections.abc import Iterator, Sequence

from .text import first_argument, methods, tree_of

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
