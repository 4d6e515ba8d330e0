"""C++ as tokens: enough of it to find functions, words and numbers outside comments and strings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

_TOKEN = re.compile(
    r"""
    (?P<space>\s+ | \\\n | //(?:[^\n\\]|\\.|\\\n)* | /\*.*?(?:\*/|\Z))
  | (?P<include>\#[ \t]*include\b[^\n]*)
  | (?P<text>(?:u8|[uUL])?R"(?P<mark>[^()\\\s]{0,16})\(.*?\)(?P=mark)"
      | (?:u8|[uUL])?"(?:[^"\\\n]|\\.)*" | (?:u8|[uUL])?'(?:[^'\\\n]|\\.)*')
  | (?P<number>\.?[0-9](?:[eEpP][+-]|'(?=[0-9a-fA-F])|[\w.])*)
  | (?P<word>[A-Za-z_]\w*)
  | (?P<sign>::|->|\#\#|\.\.\.|&&|.)
    """,
    re.VERBOSE | re.DOTALL,
)


class Token(NamedTuple):
    """A piece of source: ``kind`` is space, include, text, number, word or sign."""

    kind: str
    text: str
    line: int


def tokens(source: str) -> Iterator[Token]:
    """Yield all of ``source``, spaces and comments included: joined, they are the source."""
    line = 1
    for match in _TOKEN.finditer(source):
        kind = match.lastgroup or "sign"
        yield Token("text" if kind == "mark" else kind, match[0], line)
        line += match[0].count("\n")
