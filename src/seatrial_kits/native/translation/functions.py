"""Functions of Python as functions of C: one for each structure of arguments."""

from __future__ import annotations

import ast
import contextlib
import inspect
import linecache
import re
from functools import cache
from types import CodeType, FunctionType
from typing import Any

from .constants import why_mutable, why_no_record
from .domain import C_TYPES, Closure, EndedError, Known, Record, Seq, Table, called, is_once
from .expressions import storable
from .frame import FAILED, Frame, lines, merged, pruned
from .operations import held
from .shapes import Shape, built, field_names, flattened, leaves, shape_of


def syntax(function: Any) -> ast.FunctionDef:
    """Return the syntax of a function, with the lines of its file.

    Its text is found by its code, whatever it is wrapped in or called. Raises OSError where there
    is no text, or another one than what was loaded.
    """
    code = getattr(function, "__code__", None)
    if not isinstance(code, CodeType):
        raise OSError
    nodes, codes = _file(code.co_filename)
    place = code.co_firstlineno, code.co_name
    node, own = nodes.get(place), codes.get(place)
    if node is None or own is None or _essence(own) != _essence(code):
        raise OSError
    return node


@cache
def _file(
    name: str,
) -> tuple[dict[tuple[int, str], ast.FunctionDef], dict[tuple[int, str], CodeType]]:
    """Return the functions of a file by first line and name: their syntax and code."""
    text = "".join(linecache.getlines(name))
    nodes: dict[tuple[int, str], ast.FunctionDef] = {}
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef):
            first = min([node.lineno, *(each.lineno for each in node.decorator_list)])
            nodes[first, node.name] = node
    codes = [compile(text, name, "exec", dont_inherit=True)]
    for code in codes:
        codes += [each for each in code.co_consts if isinstance(each, CodeType)]
    return nodes, {(code.co_firstlineno, code.co_name): code for code in codes}


def _essence(code: CodeType) -> tuple[Any, ...]:
    """Return what two functions with the same text have in common."""
    plain = [c for c in code.co_consts if isinstance(c, (int, float, str))]
    return code.co_code, code.co_names, code.co_varnames, repr(plain)


def bound(
    frame: Frame, function: Any, arguments: list[Any], named: dict[str, Any]
) -> dict[str, Any]:
    """Return the arguments by parameter, defaults included."""
    try:
        signature = inspect.signature(function, follow_wrapped=False)
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
            own = found.arguments.get(name)
            names[name] = _default(frame, function, parameter) if own is None else own
    for value in found.arguments.values():
        held([storable(frame, each) for each in (value if type(value) is tuple else [value])])
    return names


def _default(frame: Frame, function: Any, parameter: inspect.Parameter) -> Known:
    why = why_mutable(parameter.default)
    if why:
        raise frame.refused(f"{parameter.name} of {called(function)}, {why},")
    return Known(parameter.default)


def record(frame: Frame, cls: type, arguments: list[Any], named: dict[str, Any]) -> Any:
    """Return a new record of a class, as its constructor makes it."""
    why = why_no_record(cls)
    if why:
        raise frame.refused(why)
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
    if not isinstance(function, FunctionType):
        raise frame.refused(called(function))
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
    name, kinds, result, own = unit.written[key]
    frame.needs(own.needed)
    frame.stores(own.stored)
    frame.has_set(own.given)
    texts = [t for n, v in names.items() for t in flattened(v, shapes[n])]
    call = f"{name}({', '.join(['self', *(t or '0' for t in texts)])})"
    if name and not kinds:
        frame.emit(f"{call};")
        if not own.returns.sites:
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
) -> tuple[str, list[str], Shape, Frame]:
    """Write the C of a function.

    Return its name, the kinds of its results, their shape, and its frame. Without a name it does
    nothing and its result is known.
    """
    unit = frame.unit
    try:
        node = syntax(function)
    except (OSError, SyntaxError, ValueError):
        raise frame.refused(f"{called(function)}, which has no text of Python,") from None
    title, code = function.__qualname__, function.__code__
    place = code.co_filename, node.lineno
    own = Frame(unit, title, place, function.__globals__, owner)
    own.locals = frozenset(code.co_varnames + code.co_cellvars)
    parameters: list[str] = []
    own.names = {}
    for name, shape in shapes.items():
        texts = [f"p{len(parameters) + i}" for i in range(len(leaves(shape)))]
        parameters += [f"{C_TYPES[k]} {t}" for k, t in zip(leaves(shape), texts, strict=True)]
        own.names[name] = built(shape, iter(texts))
    closure = inspect.getclosurevars(function).nonlocals if function.__closure__ else {}
    for name, value in closure.items():
        if not callable(value):
            raise frame.refused(f"{name} of the function around {title}")
        own.names.setdefault(name, Known(value))
    own.execute(node.body)
    if own.names is not None:
        own.returns.come({"": Known(None), **own.sets()})
    sites = [set(names) - {""} for names, _ in own.returns.sites]
    own.given = {name[1:] for name in set.intersection(*sites)} if sites else set()
    values = [names[""] for names, _ in own.returns.sites] or [Known(None)]
    result = merged(values)
    kinds = leaves(result)
    if "g" in kinds:
        raise frame.refused(f"a generator that {title} has drawn from and returns")
    silent = not any(line and not line.startswith("/*") for line in _flat_lines(own))
    if silent and not kinds:
        return "", [], result, own
    unit.counter += 1
    name = f"f{unit.counter}_{function.__name__.strip('_')}"
    for names, slot in own.returns.sites:
        slot += _return(name, kinds, flattened(names[""], result))
    unit.functions.append((name, _text(own, name, kinds, parameters, node.lineno)))
    return name, kinds, result, own


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
    plain = node.args
    if plain.vararg or plain.kwarg or plain.kwonlyargs or plain.posonlyargs or plain.defaults:
        raise frame.refused(f"the parameters of {node.name}, inside a function,")
    if named or len(arguments) != len(plain.args):
        raise frame.refused(f"a call of {node.name} with other arguments than it has")
    if frame.variables is not outer.variables or outer.names is None:
        raise frame.refused(f"a call of {node.name} outside the function that it is in")
    given = dict(zip([a.arg for a in plain.args], arguments, strict=True))
    held([storable(frame, each) for each in arguments])
    assigned = _assigned(node)
    # A list of the function around changes there alone.
    others = {n: value for n, value in outer.names.items() if n not in assigned}
    around = {n: _others(value) for n, value in others.items() if not is_once(value)}
    inner = frame.inner({**around, **given})
    inner.scope, inner.closed, inner.locals = outer.scope, True, outer.locals | assigned
    inner.execute(node.body)
    if inner.names is not None:
        inner.returns.come({"": Known(None)})
    found = inner.returns.names()
    for each in (frame, outer):
        each.stores(inner.stored)
    if found is None:
        raise EndedError
    return found[""]


def _others(value: Any) -> Any:
    return Seq(value.kind, value.items, fresh=False) if isinstance(value, Seq) else value


def _assigned(node: ast.FunctionDef) -> frozenset[str]:
    """Return the names that a function gives values."""
    inside = [own for each in node.body for own in ast.walk(each)]
    found = {n.id for n in inside if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)}
    return frozenset(found | {a.arg for a in node.args.args})


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
        with contextlib.suppress(OSError, SyntaxError, ValueError):
            for node in ast.walk(syntax(function)):
                if isinstance(node, ast.Attribute) and node.attr == "append":
                    owner = node.value
                    if isinstance(owner, ast.Attribute) and isinstance(owner.value, ast.Name):
                        found |= {owner.attr} if owner.value.id == "self" else set()
    return frozenset(found)
