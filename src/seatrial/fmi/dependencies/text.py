"""The text of functions, as trees."""

from __future__ import annotations

import ast
import types
from functools import lru_cache
from pathlib import Path

from .values import UndecidedError


def tree_of(function: types.FunctionType) -> ast.FunctionDef | ast.Lambda:
    """Return the tree of a function. Raises UndecidedError where its text is not to be had."""
    code = function.__code__
    file = Path(code.co_filename)
    try:
        stamp = file.stat()
        found = _functions(str(file), stamp.st_mtime_ns, stamp.st_size)
    except (OSError, SyntaxError, ValueError):
        raise UndecidedError(f"the text of {function.__qualname__} is not to be had") from None
    name = None if code.co_name == "<lambda>" else code.co_name
    nodes = found.get((code.co_firstlineno, name), [])
    if len(nodes) != 1:
        raise UndecidedError(f"the text of {function.__qualname__} is not to be had")
    return nodes[0]


@lru_cache(maxsize=256)
def _functions(
    file: str, _mtime_ns: int, _size: int
) -> dict[tuple[int, str | None], list[ast.FunctionDef | ast.Lambda]]:
    """Return the functions of a file by first line and name, which is None for a lambda."""
    found: dict[tuple[int, str | None], list[ast.FunctionDef | ast.Lambda]] = {}
    for node in ast.walk(ast.parse(Path(file).read_bytes())):
        if isinstance(node, ast.FunctionDef):
            first = min([node.lineno, *(one.lineno for one in node.decorator_list)])
            found.setdefault((first, node.name), []).append(node)
        elif isinstance(node, ast.Lambda):
            found.setdefault((node.lineno, None), []).append(node)
    return found


def self_names(cls: type) -> dict[str, list[tuple[ast.Attribute, str, bool]]]:
    """Return every ``self.NAME`` in the methods of a class and its bases, by name.

    Each with the file's name and whether it reads. Raises UndecidedError for a method without text.
    """
    found: dict[str, list[tuple[ast.Attribute, str, bool]]] = {}
    for function in methods(cls):
        node = tree_of(function)
        first = first_argument(node)
        for one in ast.walk(node):
            if isinstance(one, ast.Attribute) and _is_name(one.value, first):
                reads = isinstance(one.ctx, ast.Load)
                place = (one, function.__code__.co_filename, reads)
                found.setdefault(one.attr, []).append(place)
            if isinstance(one, ast.AugAssign) and isinstance(one.target, ast.Attribute):
                target = one.target
                if _is_name(target.value, first):
                    place = (target, function.__code__.co_filename, True)
                    found.setdefault(target.attr, []).append(place)
    return found


def methods(cls: type) -> list[types.FunctionType]:
    """Return the functions that a class and its bases define, those of properties included."""
    found: list[types.FunctionType] = []
    for base in cls.__mro__:
        for value in vars(base).values():
            each = [value]
            if isinstance(value, property):
                each = [value.fget, value.fset]
            elif isinstance(value, (staticmethod, classmethod)):
                each = [value.__func__]
            elif hasattr(value, "func"):  # functools.cached_property
                each = [value.func]
            found += [one for one in each if isinstance(one, types.FunctionType)]
    return found


def first_argument(node: ast.FunctionDef | ast.Lambda) -> str | None:
    """Return the name of the first argument of a function: ``self``, mostly."""
    given = [*node.args.posonlyargs, *node.args.args]
    return given[0].arg if given else None


def _is_name(node: ast.expr, name: str | None) -> bool:
    return isinstance(node, ast.Name) and node.id == name
