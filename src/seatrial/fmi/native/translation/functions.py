"""Functions of Python as functions of C: one for each structure of arguments."""

from __future__ import annotations

import ast
import contextlib
import inspect
import re
import textwrap
from functools import cache
from typing import Any

from .domain import (
    C_TYPES,
    Closure,
    EndedError,
    Known,
    Record,
    Seq,
    Shape,
    Table,
    built,
    called,
    field_names,
    flattened,
    leaves,
    shape_of,
)
from .frame import FAILED, Frame, lines, merged, pruned


@cache
def syntax(function: Any) -> tuple[ast.FunctionDef, str]:
    """Return the syntax of a function, with the lines of its file, and the file.

    Raises OSError where there is no text.
    """
    source, first = inspect.getsourcelines(function)
    tree = ast.parse(textwrap.dedent("".join(source)))
    ast.increment_lineno(tree, first - 1)
    node = tree.body[0]
    if not isinstance(node, ast.FunctionDef):
        raise OSError(f"{function.__qualname__} is no plain function")
    return node, inspect.getsourcefile(function) or "?"


def bound(
    frame: Frame, function: Any, arguments: list[Any], named: dict[str, Any]
) -> dict[str, Any]:
    """Return the arguments by parameter, defaults included."""
    try:
        signature = inspect.signature(function)
        found = signature.bind(*arguments, **named)
    except (TypeError, ValueError) as error:
        raise frame.refused(f"a call of {called(function)}: {error}") from None
    names: dict[str, Any] = {}
    for name, parameter in signature.parameters.items():
        if parameter.kind is parameter.VAR_POSITIONAL:
            names[name] = Seq(tuple, list(found.arguments.get(name, ())), fresh=False)
        elif parameter.kind is parameter.VAR_KEYWORD:
            names[name] = Table(dict(found.arguments.get(name, {})))
        else:
            names[name] = found.arguments.get(name, Known(parameter.default))
    return names


def record(frame: Frame, cls: type, arguments: list[Any], named: dict[str, Any]) -> Any:
    """Return a new record of a class, as its constructor makes it."""
    if hasattr(cls, "_fields"):
        function = cls.__new__
        names = bound(frame, function, [Known(cls), *arguments], named)
        names.pop("_cls")
    else:
        names = bound(frame, cls, arguments, named)
    return Record(cls, {name: names[name] for name in field_names(cls)})


def invoke(
    frame: Frame, function: Any, owner: type | None, arguments: list[Any], named: dict[str, Any]
) -> Any:
    """Call a function of Python: write its C, unless it is there, and a call of it."""
    unit = frame.unit
    function = inspect.unwrap(function)
    names = bound(frame, function, arguments, named)
    shapes = {name: shape_of(value) for name, value in names.items()}
    key = (function, owner, tuple(shapes.items()))
    if key in unit.open:
        raise frame.refused(f"{function.__qualname__}, which calls itself,")
    if key not in unit.written:
        unit.open.add(key)
        try:
            unit.written[key] = _written(frame, function, owner, shapes)
        finally:
            unit.open.discard(key)
    name, kinds, result, stored, returns = unit.written[key]
    frame.stores(stored)
    texts = [t for n, v in names.items() for t in flattened(v, shapes[n])]
    call = f"{name}({', '.join(['self', *(t or '0' for t in texts)])})"
    if name and not kinds:
        frame.emit(f"{call};")
        if not returns:
            frame.end()
    elif name and len(kinds) == 1:
        return built(result, iter([frame.num(kinds[0], call).text]))
    elif name:
        whole = frame.variable("d").replace("d", "r", 1)
        frame.variables[-1] = (f"struct {name}", whole)
        frame.emit(f"{whole} = {call};")
        return built(result, (f"{whole}.v{i}" for i in range(len(kinds))))
    return built(result, iter(()))


def _written(
    frame: Frame, function: Any, owner: type | None, shapes: dict[str, Shape]
) -> tuple[str, list[str], Shape, set[str], bool]:
    """Write the C of a function.

    Return its name, the kinds of its results, their shape, the attributes that it sets, and
    whether it ever returns.

    Without a name it does nothing and its result is known.
    """
    unit = frame.unit
    try:
        node, file = syntax(function)
    except (OSError, TypeError, SyntaxError):
        raise frame.refused(f"{called(function)}, which has no text of Python,") from None
    title = function.__qualname__
    own = Frame(unit, title, (file, node.lineno), function.__globals__, owner)
    parameters: list[str] = []
    own.names = {}
    for name, shape in shapes.items():
        texts = [f"p{len(parameters) + i}" for i in range(len(leaves(shape)))]
        parameters += [f"{C_TYPES[k]} {t}" for k, t in zip(leaves(shape), texts, strict=True)]
        own.names[name] = built(shape, iter(texts))
    closure = inspect.getclosurevars(function).nonlocals if function.__closure__ else {}
    for name, value in closure.items():
        own.names.setdefault(name, Known(value))
    own.execute(node.body)
    if own.names is not None:
        own.returns.come({"": Known(None)})
    values = [names[""] for names, _ in own.returns.sites] or [Known(None)]
    result = merged(values)
    kinds = leaves(result)
    if "g" in kinds:
        raise frame.refused(f"a generator that {title} has drawn from and returns")
    silent = not any(line and not line.startswith("/*") for line in _flat_lines(own))
    if silent and not kinds:
        return "", [], result, set(), True
    unit.counter += 1
    name = f"f{unit.counter}_{function.__name__.strip('_')}"
    for names, slot in own.returns.sites:
        slot += _return(name, kinds, flattened(names[""], result))
    unit.functions.append((name, _text(own, name, kinds, parameters, node.lineno)))
    return name, kinds, result, own.stored, bool(own.returns.sites)


def _flat_lines(frame: Frame) -> list[str]:
    return [line.strip() for line in lines(frame.code)]


def _return(name: str, kinds: list[str], texts: list[str | None]) -> list[str]:
    if not kinds:
        return ["return;"]
    if len(kinds) == 1:
        return [f"return {texts[0] or '0'};"]
    return [f"return (struct {name}){{{', '.join(text or '0' for text in texts)}}};"]


def _text(frame: Frame, name: str, kinds: list[str], parameters: list[str], line: int) -> str:
    if len(kinds) > 1:
        fields = " ".join(f"{C_TYPES[k]} v{i};" for i, k in enumerate(kinds))
        head, returns = f"struct {name} {{ {fields} }};\n", f"struct {name}"
    else:
        head, returns = "", C_TYPES[kinds[0]] if kinds else "void"
    where = f"/* {frame.title}, {frame.file.rpartition('/')[2]}:{line} */\n"
    arguments = ", ".join(["Instance *self", *parameters])
    code, used = pruned(frame.variables, frame.code)
    body = [f"    {type_} {own}{_zero(type_)};" for type_, own in frame.variables if own in used]
    words = " ".join(code)
    given = ["self", *(p.split()[-1] for p in parameters)]
    unused = [f"    (void){p};" for p in given if not re.search(rf"\b{p}\b", words)]
    ending = []
    if f"goto {FAILED};" in code:
        zero = f"(struct {name}){{0}}" if len(kinds) > 1 else "0" if kinds else ""
        ending = [f"{FAILED}:", f"    return {zero};" if kinds else "    return;"]
    written = [*body, *unused, *lines(code), *ending]
    return f"{where}{head}static {returns} {name}({arguments}) {{\n" + "\n".join(written) + "\n}\n"


def _zero(type_: str) -> str:
    return " = {0}" if type_.startswith(("struct", "Philox")) else " = 0"


def inlined(frame: Frame, closure: Closure, arguments: list[Any], named: dict[str, Any]) -> Any:
    """Write the body of a function inside a function in the place of a call."""
    node, outer = closure.node, closure.frame
    names = dict(outer.names or {})
    given = node.args.args
    defaults = dict(
        zip([a.arg for a in given][-len(node.args.defaults) :], node.args.defaults, strict=False)
    )
    for at, argument in enumerate(given):
        if at < len(arguments):
            names[argument.arg] = arguments[at]
        elif argument.arg in named:
            names[argument.arg] = named[argument.arg]
        else:
            names[argument.arg] = frame.evaluate(defaults[argument.arg])
    inner = frame.inner(names)
    inner.scope = outer.scope
    if isinstance(node, ast.Lambda):
        return inner.evaluate(node.body)
    inner.execute(node.body)
    if inner.names is not None:
        inner.returns.come({"": Known(None)})
    found = inner.returns.names()
    if found is None:
        raise EndedError
    return found[""]


def found_method(cls: type, name: str, after: type | None = None) -> tuple[Any, type | None]:
    """Return what a class has under a name, and where; ``after`` a class of its bases."""
    mro = list(cls.__mro__)
    for base in mro[mro.index(after) + 1 :] if after else mro:
        if name in vars(base):
            return vars(base)[name], base
    return None, None


def appended_attributes(cls: type) -> frozenset[str]:
    """Return the attributes of ``self`` that a class, or a base of it, appends to."""
    found = set()
    functions = [f for base in cls.__mro__ for f in vars(base).values() if inspect.isfunction(f)]
    for function in functions:
        with contextlib.suppress(OSError, SyntaxError):
            for node in ast.walk(syntax(inspect.unwrap(function))[0]):
                if isinstance(node, ast.Attribute) and node.attr == "append":
                    owner = node.value
                    if isinstance(owner, ast.Attribute) and isinstance(owner.value, ast.Name):
                        found |= {owner.attr} if owner.value.id == "self" else set()
    return frozenset(found)
