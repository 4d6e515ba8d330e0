"""Ports that a mistyped name leaves out: outputs that nothing sets, attributes nearly called so."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Iterator
from pathlib import Path

from ...errors import InputError
from ...kits import is_ours
from ...model.component import Component
from ...model.plant import Plant
from ...model.ports import Output
from .text import first_argument, methods, self_names, tree_of
from .values import UndecidedError

_NEAR = 0.8
_NAMED = ("getattr", "hasattr", "setattr")
_PLAIN = ("isinstance", "super", "type", "id")
_ZERO = ([0], [0.0], [""], [False])


def refuse_mistyped(cls: type[Component]) -> None:
    """Raise InputError for an output that nothing sets, or an attribute nearly called as a port.

    An attribute is meant that is read and never set, or set and never read; its name has no
    underscore first, and differs little from a port's. Classes whose text hands ``self`` on, or
    sets attributes by computed names, are not checked: there anything may be set. An
    output whose declaration gives a start value other than zero may be a constant, a text may
    have nothing to say, and a class without a method does nothing on purpose.
    """
    try:
        own = [function for function in methods(cls) if not is_ours(function.__module__)]
        if any(_hands_on(tree_of(function)) for function in own):
            return
        named = self_names(cls)
        texts = {text for function in own for text in _texts(tree_of(function))}
    except UndecidedError:
        return
    used = {name: places for name, places in named.items() if name not in dir(cls)}
    unset = [name for name in _set_by_text(cls) if name not in texts and not _is_set(name, named)]
    for name in unset if own else ():
        near = difflib.get_close_matches(name, used, n=1, cutoff=_NEAR)
        if cls.ports[name].type is str and not near:  # it has nothing to say
            continue
        hint = f"; {_place(used[near[0]][0])} has self.{near[0]}" if near else ""
        raise InputError(f"{cls.__name__}: nothing sets the output {name!r}{hint}")
    for name, places in used.items():
        ways = {reads for _, _, reads in places}
        near = difflib.get_close_matches(name, cls.ports, n=1, cutoff=_NEAR)
        if len(ways) == 1 and near and not name.startswith("_") and name not in texts:
            way, other = ("reads", "sets") if ways.pop() else ("sets", "reads")
            raise InputError(
                f"{cls.__name__}: {_place(places[0])} {way} self.{name}, which nothing {other}; "
                f"did you mean the {cls.ports[near[0]].kind} {near[0]!r}?"
            )


def _set_by_text(cls: type[Component]) -> Iterator[str]:
    """Yield the outputs that the methods of a user's class have to set."""
    if issubclass(cls, Plant):  # its equations give every output, or are refused
        return
    for base in cls.__mro__:
        if is_ours(base.__module__):
            continue
        for name in vars(base).get("_declared", ()):
            port = cls.ports[name]
            if type(port) is Output and port.start[:1] in _ZERO and not port.role:
                yield name


def _is_set(name: str, named: dict[str, list[tuple[ast.Attribute, str, bool]]]) -> bool:
    return any(not reads for _, _, reads in named.get(name, ()))


def _texts(tree: ast.AST) -> Iterator[str]:
    """Yield the texts of a function: a name that is set by its text is among them."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def _hands_on(tree: ast.FunctionDef | ast.Lambda) -> bool:
    """Say if a method does with ``self`` what its text does not show."""
    me = first_argument(tree)
    plain: set[ast.AST] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            if node.attr in ("values", "__dict__") and _is(node.value, me):
                return True
            plain.add(node.value)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            by_text = len(node.args) > 1 and isinstance(node.args[1], ast.Constant)
            if node.func.id in _PLAIN or (node.func.id in _NAMED and by_text):
                plain |= set(node.args)
        elif _is(node, me) and node not in plain:
            return True
    return False


def _is(node: ast.AST, me: str | None) -> bool:
    return isinstance(node, ast.Name) and node.id == me


def _place(place: tuple[ast.Attribute, str, bool]) -> str:
    return f"{Path(place[1]).name}, line {place[0].lineno},"
