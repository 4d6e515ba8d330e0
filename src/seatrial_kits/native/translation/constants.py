"""Constants of modules and classes: known when the C of a component is written."""

from __future__ import annotations

import ast
import dataclasses
import enum
import functools
import hashlib
import sys
import types
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np

from seatrial.kits import is_ours
from seatrial.model.ports import Port

_PLAIN = (bool, int, float, str, bytes, range, frozenset, type(None))
_CODE = (
    *(types.FunctionType, types.BuiltinFunctionType, type(functools.cache(int)), type),
    type(np.interp),
)
_STABLE = sys.stdlib_module_names | {"numpy"}
"""Modules whose functions and numbers stay as they are."""
_OF_TUPLES = frozenset(
    {"__new__", "__slots__", "__doc__", "__module__", "__match_args__", "__orig_bases__"}
    | {"__getnewargs__", "__repr__", "__annotations__", "__replace__", "__static_attributes__"}
    | {"__firstlineno__", "__annotate__", "__annotate_func__", "__annotations_cache__"}
)
_OF_DATA = (
    _OF_TUPLES
    | {"__init__", "__eq__", "__hash__", "__dict__", "__weakref__"}
    | {f"__dataclass_{what}__" for what in ("fields", "params")}
)


def scope_of(cls: type) -> Mapping[str, Any]:
    """Return the names of the module that a class is from."""
    own = [f.__globals__ for f in vars(cls).values() if isinstance(f, types.FunctionType)]
    module = sys.modules.get(cls.__module__)
    return vars(module) if module is not None else own[0] if own else {}


def why_no_constant(scope: Mapping[str, Any], name: str, value: Any) -> str:
    """Return why a name of a module or class may mean something else in the run; empty if not.

    ``scope`` has the names of the module.
    """
    module = scope.get("__name__", "")
    if not is_ours(module) and module.partition(".")[0] not in _STABLE:
        others = _reassigned(scope.get("__file__") or "")
        if name in others or "" in others:
            return "which is assigned to elsewhere too"
    return why_mutable(value)


def why_mutable(value: Any) -> str:
    """Return why a value may be another one in the run, empty if it cannot."""
    if isinstance(value, (*_PLAIN, *_CODE, types.ModuleType, enum.Enum)):
        return ""
    if isinstance(value, tuple) and type(value) is tuple:
        return _first(why_mutable(each) for each in value)
    if isinstance(value, types.MappingProxyType):
        return _first(why_mutable(each) for each in value.values())
    if is_record(type(value)):
        params = getattr(type(value), "__dataclass_params__", None)
        if params is None or params.frozen:
            return why_no_record(type(value)) or _first(map(why_mutable, _fields(value)))
    elif is_ours(type(value).__module__):
        return ""
    return f"a {type(value).__name__} that may change"


def is_record(cls: Any) -> bool:
    """Return whether a class is a named tuple or a data class."""
    return isinstance(cls, type) and _has_fields(cls)


def _has_fields(cls: type) -> bool:
    return (issubclass(cls, tuple) and hasattr(cls, "_fields")) or dataclasses.is_dataclass(cls)


def why_no_record(cls: type) -> str:
    """Return what a named tuple or data class does in a way of its own, empty if nothing."""
    if is_ours(cls.__module__):
        return ""
    if dataclasses.is_dataclass(cls):
        params, allowed = cls.__dataclass_params__, _OF_DATA  # type: ignore[attr-defined]
        if not (params.init and params.eq) or params.order:
            return f"{cls.__name__}, which is made or compared in a way of its own"
        if any(
            not f.init or f.default_factory is not dataclasses.MISSING
            for f in dataclasses.fields(cls)
        ):
            return f"{cls.__name__}, which has fields that it makes itself"
    else:
        allowed = _OF_TUPLES
    for base in cls.__mro__[:-1]:
        if base is tuple or base.__module__ in ("typing", "builtins"):
            continue
        for name, own in vars(base).items():
            special = name.startswith("__") and name.endswith("__")
            code = getattr(own, "__code__", None)
            written = code is not None and not code.co_filename.startswith(("<", "namedtuple"))
            if special and (name not in allowed or (written and not _is_library(own))):
                return f"{cls.__name__}.{name}, a method of its own"
    return ""


def _is_library(function: Any) -> bool:
    return getattr(function, "__module__", "") in ("dataclasses", "collections", "typing")


def _fields(value: Any) -> Iterator[Any]:
    names = getattr(value, "_fields", None) or [f.name for f in dataclasses.fields(value)]
    return (getattr(value, name) for name in names)


def _first(reasons: Any) -> str:
    return next(filter(None, reasons), "")


@cache
def _reassigned(file: str) -> frozenset[str]:
    """Return the names that functions of a module give other values; "" stands for any."""
    try:
        with open(file, encoding="utf-8") as text:
            tree = ast.parse(text.read())
    except (OSError, SyntaxError, ValueError):
        return frozenset({""})
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Global):
            found.update(node.names)
        elif isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Load):
            found |= set() if _is_self(node.value) else {node.attr}
        elif isinstance(node, ast.Name) and node.id in ("globals", "vars", "exec", "eval"):
            found.add("")
        elif isinstance(node, ast.Call) and not _is_self(*node.args[:1]):
            setter = isinstance(node.func, ast.Name) and node.func.id in ("setattr", "delattr")
            found |= {""} if setter else set()
    return frozenset(found)


def _is_self(node: ast.expr | None = None) -> bool:
    return isinstance(node, ast.Name) and node.id == "self"


# ------------------------------------------------------------------ what a class is made of


def fingerprint(cls: type) -> str:
    """Return a digest of a class as it is loaded: code and constants, also those of its modules.

    Two processes that get other constants from the same text (from the environment, from a file)
    have another one. What this package consists of is left out.
    """
    digest, seen = hashlib.sha256(), set[int]()

    def add(value: Any, names: tuple[str, ...] = ()) -> None:
        for text in _texts_of(value, names, add, seen):
            digest.update(f"{text}\0".encode("utf-8", "backslashreplace"))

    add(cls)
    return digest.hexdigest()


def _texts_of(value: Any, names: tuple[str, ...], add: Any, seen: set[int]) -> Iterator[str]:
    """Yield the texts that tell a value, and ``add`` what it consists of."""
    if isinstance(value, _PLAIN):
        own = sorted(map(repr, value)) if isinstance(value, frozenset) else value
        yield f"{type(value).__name__} {own!r}"
        return
    yield getattr(value, "__qualname__", type(value).__qualname__)
    if isinstance(value, types.ModuleType):
        if not is_ours(value.__name__) and getattr(value, "__file__", None):
            for name in names:
                own = vars(value).get(name)  # not what a module makes as it is asked
                if not isinstance(own, types.ModuleType):
                    add(own)
        return
    if isinstance(value, Port):
        yield repr([(k, v) for k, v in sorted(vars(value).items()) if not callable(v)])
        return
    module = getattr(value, "__module__", "") or ""
    if id(value) in seen or is_ours(module) or module.partition(".")[0] in _STABLE:
        return
    seen.add(id(value))
    if isinstance(value, types.FunctionType):
        yield from _of_function(value, add)
    elif isinstance(value, type):
        for base in value.__bases__:
            add(base)
        for name, own in sorted(vars(value).items()):
            if not name.startswith("__") or isinstance(own, types.FunctionType):
                yield name  # what Python keeps there itself comes and goes
                add(own)
    elif isinstance(value, (tuple, list, set)):
        for each in value:
            add(each)
    elif isinstance(value, Mapping):
        for key, each in value.items():
            add(key)
            add(each)
    else:
        for part in ("__func__", "fget", "fset", "__wrapped__"):
            if hasattr(value, part):
                add(getattr(value, part))
        for name, own in sorted(getattr(value, "__dict__", {}).items()):
            yield name
            add(own)


def _of_function(function: types.FunctionType, add: Any) -> Iterator[str]:
    codes, names = [function.__code__], list[str]()
    for code in codes:
        codes += [each for each in code.co_consts if isinstance(each, types.CodeType)]
        names += code.co_names
        yield code.co_code.hex()
        for each in code.co_consts:
            if isinstance(each, (*_PLAIN, tuple)):
                add(each)
    add(function.__defaults__)
    add(function.__kwdefaults__)
    for cell in function.__closure__ or ():
        try:
            add(cell.cell_contents)
        except ValueError:
            yield "empty"
    for name in names:
        if name in function.__globals__:
            yield name
            add(function.__globals__[name], tuple(names))
