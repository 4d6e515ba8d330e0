"""TOML, JSON and YAML that anybody may have written, as content that is safe to walk through."""

from __future__ import annotations

import json
import re
import tomllib
from typing import Any

from ..errors import InputError

DEEPEST = 64
"""Tables and lists inside one another."""
LARGEST_TOML = 4 * 2**20
"""Bytes: files that a person writes, whose parser is slow."""
LARGEST_YAML = 2**19
"""Bytes: some seconds of PyYAML's parser in Python."""
LARGEST_JSON = 256 * 2**20
"""Bytes: files that programs write."""
INTEGERS = (-(2**63), 2**64 - 1)
"""The numbers of the widest signed and unsigned types of FMI."""

# The parser's time and memory grow with the square of the parts of a dotted key.
_LONG_KEY = re.compile(rf"(?:[^\s.,=\[\]{{}}]{{1,200}}[ \t]*\.[ \t]*){{{DEEPEST}}}")


def toml_content(data: bytes, called: str) -> dict[str, Any]:
    """Return what TOML says; ``called`` names it in messages.

    Raises InputError for what is no UTF-8 or no TOML, and for what no honest file has: more than
    `LARGEST_TOML`, deeper than `DEEPEST`, integers beyond `INTEGERS`.
    """
    _refuse_large(data, LARGEST_TOML, called)
    try:
        text = data.decode("utf-8-sig")  # some editors of Windows put a mark
        if any(line.count(".") >= DEEPEST and _LONG_KEY.search(line) for line in text.split("\n")):
            raise RecursionError
        content = tomllib.loads(text)
    except UnicodeDecodeError as error:
        raise InputError(f"{called}: not UTF-8 text at byte {error.start}") from None
    except RecursionError:
        raise _too_deep(called) from None
    except ValueError as error:  # TOMLDecodeError, or a number with thousands of digits
        raise InputError(f"{called}: not TOML: {error}") from None
    _refuse_odd(content, called)
    return content


def json_content(data: bytes, called: str) -> Any:
    """Return what JSON says, as `toml_content` does; NaN and Infinity are numbers here."""
    _refuse_large(data, LARGEST_JSON, called)
    try:
        content = json.loads(data.decode("utf-8"))
    except UnicodeDecodeError as error:
        raise InputError(f"{called}: not UTF-8 text at byte {error.start}") from None
    except RecursionError:
        raise _too_deep(called) from None
    except ValueError as error:
        raise InputError(f"{called}: not JSON: {error}") from None
    _refuse_odd(content, called)
    return content


def yaml_content(data: bytes, called: str) -> Any:
    """Return what one document of YAML says, as `toml_content` does; numbers are texts here.

    Aliases and keys that stand twice are refused.
    """
    import yaml  # few runs need it

    class Loader(yaml.BaseLoader):  # type: ignore[misc]
        """Takes every scalar for a text: versions of YAML differ in what is a number."""

        def compose_node(self, parent: Any, index: Any) -> Any:
            if self.check_event(yaml.AliasEvent):
                mark = self.peek_event().start_mark
                raise InputError(f"{called}: line {mark.line + 1}: aliases are not read")
            return super().compose_node(parent, index)

        def construct_mapping(self, node: Any, deep: bool = False) -> Any:
            keys: set[str] = set()
            for key, _ in node.value:
                text = str(key.value)
                if text in keys:
                    line = key.start_mark.line + 1
                    raise InputError(f"{called}: line {line}: a second key {text!r}")
                keys.add(text)
            return super().construct_mapping(node, deep)

    _refuse_large(data, LARGEST_YAML, called)
    try:
        content = Loader(data).get_single_data()
    except RecursionError:
        raise _too_deep(called) from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"{called}: not YAML: {' '.join(str(error).split())}") from None
    _refuse_odd(content, called)
    return content


def _refuse_large(data: bytes, largest: int, called: str) -> None:
    if len(data) > largest:
        raise InputError(f"{called}: {len(data)} bytes, at most {largest} are read")


def _refuse_odd(content: Any, called: str) -> None:
    """Raise InputError for what a walk through the content could not bear; it walks in levels."""
    level = [content]
    for _ in range(DEEPEST + 1):
        inside: list[Any] = []
        for value in level:
            if isinstance(value, dict):
                inside += value.values()
            elif isinstance(value, list):
                inside += value
            elif type(value) is int and not INTEGERS[0] <= value <= INTEGERS[1]:
                low, high = INTEGERS
                raise InputError(
                    f"{called}: an integer of {value.bit_length()} bits; {low} to {high} are read"
                )
        if not inside:
            return
        level = inside
    raise _too_deep(called)


def _too_deep(called: str) -> InputError:
    return InputError(f"{called}: tables or lists are more than {DEEPEST} deep")
