"""Prototypes of a sketch's functions, as the Arduino IDE adds them."""

from __future__ import annotations

import re

from .tokens import Token, tokens

_LINE = re.compile(r"""\s*#\s*line\s+(?P<number>\d+)(?:\s+(?P<name>".*"))?""")


def with_prototypes(source: str) -> str:
    """Return ``source`` with prototypes of its functions before the first of them.

    As the Arduino IDE does it: functions with default arguments, templates, and members get
    none, nor do functions that the sketch declares itself.
    """
    found = [t for t in tokens(source) if t.kind not in ("space", "include")]
    found = _without_directives(found, source)
    prototypes: list[str] = []
    first: Token | None = None
    for begin, end in _definitions(found):
        words = found[begin:end]
        first = first or words[0]
        if not any(t.text in ("=", "template", "operator", "~") for t in words):
            prototypes.append(" ".join(t.text for t in words) + ";")
    if first is None:
        return source
    lines = source.split("\n")
    at = first.line - 1
    name, line = _place(lines, at)
    marked = [*prototypes, f"#line {line} {name}"]
    return "\n".join([*lines[:at], *marked, *lines[at:]])


def _place(lines: list[str], at: int) -> tuple[str, int]:
    """Return the file and line that line ``at`` stands for, by the directives before it.

    A sketch may have directives of its own: without a file's name the one before holds.
    """
    line = None
    for back in range(at - 1, -1, -1):
        if match := _LINE.match(lines[back]):
            line = int(match["number"]) + at - back - 1 if line is None else line
            if match["name"]:
                return match["name"], line
    return '"sketch"', at + 1 if line is None else line


def _without_directives(found: list[Token], source: str) -> list[Token]:
    lines = source.split("\n")
    directives = set()
    for number, line in enumerate(lines, 1):
        continued = number - 1 in directives and lines[number - 2].endswith("\\")
        if line.lstrip().startswith("#") or continued:
            directives.add(number)
    return [t for t in found if t.line not in directives]


def _definitions(found: list[Token]) -> list[tuple[int, int]]:
    """Return where functions at the outermost level begin, and where their bodies do."""
    result, depth, begin = [], 0, 0
    for at, token in enumerate(found):
        if token.text == "{":
            if depth == 0 and _is_function(found[begin:at]):
                result.append((begin, at))
            depth += 1
        elif token.text == "}":
            depth -= 1
            if depth == 0:
                begin = at + 1
        elif token.text == ";" and depth == 0:
            begin = at + 1
    return result


def _is_function(words: list[Token]) -> bool:
    """Return whether tokens before a brace are 'TYPE NAME ( ... )'."""
    texts = [t.text for t in words]
    if "(" not in texts or texts[-1] != ")" or texts[0] in ("namespace", "extern"):
        return False
    name = texts.index("(") - 1
    before = texts[:name]
    types = [t for t in words[:name] if t.kind == "word"]
    return (
        words[name].kind == "word"
        and bool(types)
        and "::" not in before[-1:]
        and "=" not in before
        and texts[0] not in ("class", "enum", "union", "ISR", "else", "if", "while", "for")
    )
