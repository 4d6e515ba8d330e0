"""Imports of a module that travels in an FMU: found in its source, and renamed there."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import lru_cache

from ...errors import InputError

_COOKIE = re.compile(r"^[ \t\f]*#.*?coding[:=]")


@lru_cache(maxsize=1024)
def imports(
    source: bytes, file: str, module: str, is_package: bool, *, everywhere: bool
) -> tuple[tuple[str, bool], ...]:
    """Return (module, may be missing) for every import, and for the names in ``from`` imports.

    At module level only, unless ``everywhere``. Raises InputError for text that is not Python.
    """
    return tuple(_found_imports(source, file, module, is_package, everywhere))


def _found_imports(
    source: bytes, file: str, module: str, is_package: bool, everywhere: bool
) -> Iterator[tuple[str, bool]]:
    for node, optional in _statements(parsed(source, file), everywhere, False):
        if isinstance(node, ast.Import):
            yield from ((alias.name, optional) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = module.split(".") if is_package else module.split(".")[:-1]
                parts = parts[: len(parts) - node.level + 1]
                base = ".".join([*parts, base] if base else parts)
            yield base, optional
            # A name may be a submodule; the closure drops those that are not.
            yield from ((f"{base}.{alias.name}", optional) for alias in node.names)


def _statements(tree: ast.AST, everywhere: bool, optional: bool) -> Iterator[tuple[ast.AST, bool]]:
    """Yield every node, and if it stands where a missing module is caught."""
    for node in ast.iter_child_nodes(tree):
        function = isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
        if function and not everywhere:
            continue
        yield node, optional
        if isinstance(node, ast.If) and _is_type_checking(node.test):
            for branch in node.orelse:
                yield branch, optional
                yield from _statements(branch, everywhere, optional)
        elif isinstance(node, ast.Try) and any(_catches_import(h) for h in node.handlers):
            for part in node.body:
                yield part, True
                yield from _statements(part, everywhere, True)
            for other in (*node.handlers, *node.orelse, *node.finalbody):
                yield from _statements(other, everywhere, optional)
        else:
            yield from _statements(node, everywhere, optional)


def _is_type_checking(test: ast.expr) -> bool:
    return ast.unparse(test) in ("TYPE_CHECKING", "typing.TYPE_CHECKING")


def _catches_import(handler: ast.ExceptHandler) -> bool:
    caught = ast.unparse(handler.type) if handler.type else "Exception"
    return any(name in caught for name in ("ImportError", "ModuleNotFoundError", "Exception"))


def _text(source: bytes, file: str) -> str:
    """Return Python source as text with plain line ends, without mark and encoding comment."""
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(source).readline)
        text = source.decode(encoding)
    except (SyntaxError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: not Python: {error}") from None
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    first, newline, rest = text.partition("\n")
    second, newline2, rest2 = rest.partition("\n")
    if _COOKIE.match(first):
        return "#" + newline + rest
    if _COOKIE.match(second):
        return first + newline + "#" + newline2 + rest2
    return text


def parsed(source: bytes, file: str) -> ast.Module:
    """Return the syntax tree of a module. Raises InputError for text that is not Python."""
    return _tree(_text(source, file), file)


def _tree(source: str, file: str) -> ast.Module:
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError) as error:
        line = getattr(error, "lineno", None)
        raise InputError(f"{file}{f', line {line}' if line else ''}: not Python: {error}") from None


@lru_cache(maxsize=1024)  # most modules travel in many FMUs
def _import_statements(text: str, file: str) -> tuple[ast.Import | ast.ImportFrom, ...]:
    """Return all import statements of a module, the last one first."""
    nodes = ast.walk(_tree(text, file))
    found = (node for node in nodes if isinstance(node, (ast.Import, ast.ImportFrom)))
    return tuple(sorted(found, key=lambda n: (n.lineno, n.col_offset), reverse=True))


def renamed(source: bytes, file: str, own: frozenset[str], root: str) -> bytes:
    """Return ``source`` with absolute imports of ``own`` packages made imports from ``root``.

    Raises InputError for text that is not Python.
    """
    text = _text(source, file)
    lines = [f"{line}\n" for line in text.split("\n")]
    for node in _import_statements(text, file):
        new = _renamed_statement(node, own, root)
        if new is None:
            continue
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        # Columns count bytes; what stands before and after on these lines stays.
        before = lines[first].encode()[: node.col_offset].decode()
        after = lines[last].encode()[node.end_col_offset :].decode()
        filler = ["\n"] * (last - first)  # keep the line numbers of tracebacks
        lines[first : last + 1] = [before + new + after, *filler]
    return "".join(lines)[:-1].encode()


def _renamed_statement(
    node: ast.Import | ast.ImportFrom, own: frozenset[str], root: str
) -> str | None:
    if isinstance(node, ast.ImportFrom):
        if node.level or (node.module or "").partition(".")[0] not in own:
            return None
        return ast.unparse(ast.ImportFrom(f"{root}.{node.module}", node.names, 0))
    if not any(alias.name.partition(".")[0] in own for alias in node.names):
        return None
    parts = []
    for alias in node.names:
        top = alias.name.partition(".")[0]
        if top not in own:
            parts.append(ast.unparse(ast.Import([alias])))
        elif alias.asname:
            parts.append(f"import {root}.{alias.name} as {alias.asname}")
        else:  # 'import a.b' binds 'a'
            parts += [f"import {root}.{alias.name}", f"from {root} import {top}"]
    return "; ".join(parts)
