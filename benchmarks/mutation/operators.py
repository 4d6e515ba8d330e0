"""Mutants of a Python file: small changes of its statements, each a replacement of text.

Left out is what holds no equation: docstrings and other texts, annotations, decorators, the
assignments of class bodies (declarations of ports and parameters) and tables of modules, whose
numbers are data, error paths (``raise``, and calls of exceptions), and numbers below 1e-6, which
guard divisions.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

OPERATORS = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"),
    ast.Lt: ("<", ">"), ast.Gt: (">", "<"), ast.LtE: ("<=", ">="), ast.GtE: (">=", "<="),
    ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="),
}  # fmt: skip
FUNCTIONS = {
    "sin": "cos", "cos": "sin", "sinh": "cosh", "cosh": "sinh",
    "min": "max", "max": "min", "fmin": "fmax", "fmax": "fmin",
}  # fmt: skip
AXES = {
    "x": "y", "y": "x", "z": "y", "u": "v", "v": "u", "w": "v", "p": "q", "q": "p", "r": "q",
    "X": "Y", "Y": "X", "Z": "Y", "K": "M", "M": "K", "N": "M", "phi": "theta", "theta": "phi",
    "north": "east", "east": "north", "down": "east", "surge": "sway", "sway": "surge",
    "heave": "sway", "roll": "pitch", "pitch": "roll", "yaw": "pitch",
    "ahead": "aside", "aside": "ahead", "along": "across", "across": "along",
}  # fmt: skip
"""Axis and the one that takes its place, where the same function names both."""
MAGNITUDES = {"abs", "fabs"}
GUARD = 1e-6


@dataclass(frozen=True)
class Mutant:
    """Bytes ``start`` to ``end`` of the file ``path``, on ``line``, become ``text``."""

    path: str
    line: int
    operator: str
    start: int
    end: int
    text: str

    def applied(self, source: bytes) -> bytes:
        """Return the file's text with the change."""
        return source[: self.start] + self.text.encode() + source[self.end :]

    def diff(self, source: bytes) -> str:
        """Return the lines before and after, as a diff shows them."""
        first, last = source.rfind(b"\n", 0, self.start) + 1, source.find(b"\n", self.end)
        versions = (("-", source[first:last]), ("+", self.applied(source[:last])[first:]))
        return "\n".join(
            f"{sign}{line}" for sign, text in versions for line in text.decode().splitlines()
        )


def mutants(source: bytes, path: str) -> Iterator[Mutant]:
    """Yield every mutant of a file's text."""
    begins = [0, *accumulate(len(line) for line in source.splitlines(keepends=True))]

    def place(node: ast.expr | ast.stmt) -> tuple[int, int]:
        return (
            begins[node.lineno - 1] + node.col_offset,
            begins[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0),
        )

    for node, parents, named in _equations(ast.parse(source), (), set()):
        start, end = place(node)
        own = source[start:end].decode()
        for operator, text in _changes(node, parents, named, own):
            yield Mutant(path, node.lineno, operator, start, end, text)
        match node:
            case ast.BinOp(left=left, op=op, right=right):
                pass
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                pass
            case ast.AugAssign(target=left, op=op, value=right):
                pass
            case _:
                continue
        if type(op) in OPERATORS:
            old, new = OPERATORS[type(op)]
            at = source.index(old.encode(), place(left)[1], place(right)[0])
            yield Mutant(path, node.lineno, "operator", at, at + len(old), new)


def _equations(node, parents, named) -> Iterator[tuple[ast.AST, tuple[ast.AST, ...], set[str]]]:
    """Yield nodes that hold equations, each with its parents and the names of its function."""
    if isinstance(node, (ast.Raise, ast.JoinedStr)):
        return
    if isinstance(node, ast.Call) and str(_name(node.func)).endswith("Error"):
        return
    if isinstance(node, (ast.List, ast.Tuple, ast.Dict)) and not named:
        return  # a table of a module
    if isinstance(node, ast.FunctionDef):
        named = {name for each in ast.walk(node) if (name := _name(each))}
    if isinstance(node, (ast.expr, ast.AugAssign)):
        yield node, parents, named
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            declares = isinstance(node, ast.ClassDef) and not isinstance(child, ast.FunctionDef)
            if isinstance(child, ast.AST) and not declares:
                yield from _equations(child, (node, *parents), named)


def _name(node: ast.AST) -> str | None:
    """Return what a node names: a variable, an attribute or a key."""
    key = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else None
    return getattr(node, "id", getattr(node, "attr", key))


def _changes(node, parents, named, own: str) -> Iterator[tuple[str, str]]:
    """Yield names of operators and the texts that they put in the place of a node's ``own``."""
    parent = parents[0]
    match node:
        case ast.UnaryOp(op=ast.USub()):
            yield "sign", f"-{own}" if own[1] == "-" else own[1:]
        case ast.UnaryOp(op=ast.Not()):
            yield "not", own[3:].strip()
        case ast.Call(func=func, args=[_]) if _name(func) in MAGNITUDES:
            yield "abs", own[own.index("(") :]
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            yield from _numbers(value, parents)
        case ast.Name(ctx=ast.Load()) | ast.Attribute(ctx=ast.Load()) | ast.Constant(value=str()):
            yield from _renamed(node, parent, named, own)
    is_sum = isinstance(parent, ast.BinOp) and isinstance(parent.op, (ast.Add, ast.Sub))
    if is_sum and node is parent.left and not isinstance(node, (ast.BinOp, ast.UnaryOp)):
        yield "sign", f"-{own}"
    if _is_returned(node, parents):
        yield "returned", f"-({own})"


def _numbers(value: float, parents) -> Iterator[tuple[str, str]]:
    """Yield a number's changes: the index before, or a factor."""
    holder = next(each for each in parents if not isinstance(each, (ast.Tuple, ast.UnaryOp)))
    if isinstance(holder, (ast.Subscript, ast.Slice)):
        yield "index", "1" if value == 0 else str(value - 1)
    elif abs(value) > GUARD and (isinstance(value, float) or isinstance(parents[0], ast.BinOp)):
        yield "factor", repr(value * 1.1)
        yield "factor", repr(value * 0.9)


def _renamed(node, parent, named, own: str) -> Iterator[tuple[str, str]]:
    """Yield the other function's name, or that of another axis that the same function has."""
    name = _name(node)
    if isinstance(node, ast.Constant) and not isinstance(parent, ast.Subscript):
        return
    if (other := FUNCTIONS.get(name)) and isinstance(parent, ast.Call):
        yield "function", own[: own.rindex(name)] + other
    if (other := AXES.get(name)) in named:
        yield "axis", own[: own.rindex(name)] + other + own[own.rindex(name) + len(name) :]


def _is_returned(node, parents) -> bool:
    """Return whether a function returns this number, alone or as a component of a vector."""
    parent, *outer = parents
    if isinstance(parent, (ast.Tuple, ast.List)) or (
        isinstance(parent, ast.Call) and _name(parent.func) == "vertcat" and node in parent.args
    ):
        parent, *outer = outer
    if not isinstance(parent, ast.Return) or isinstance(
        node,
        (ast.Tuple, ast.List, ast.Dict, ast.Starred, ast.Compare, ast.BoolOp, ast.Constant),
    ):
        return False
    function = next(each for each in outer if isinstance(each, ast.FunctionDef))
    kind = ast.unparse(function.returns) if function.returns else ""
    return kind not in ("bool", "str", "Component")
