"""Messages of errors: a text of Python with numbers in it as a format of C."""

from __future__ import annotations

import ast
import re
from typing import Any

from .domain import Known, Num, OwnName, Seq, TranslationError
from .frame import Frame
from .operations import is_known, python_of


def failure(frame: Frame, node: ast.Raise) -> str:
    """Return the arguments of C with the message of a raised error."""
    call = node.exc
    message = call.args[0] if isinstance(call, ast.Call) and call.args else None
    parts: list[Any] = message.values if isinstance(message, ast.JoinedStr) else [message]
    text, arguments = "", []
    for part in parts:
        if isinstance(part, ast.Constant):
            text += str(part.value).replace("%", "%%")
            continue
        is_value = isinstance(part, ast.FormattedValue)
        form, more = _shown(frame, part) if is_value else ("...", [])
        text += form
        arguments += more
    return ", ".join([quoted(text), *arguments])


def _shown(frame: Frame, part: ast.FormattedValue) -> tuple[str, list[str]]:
    """Return the format of a value in a message, and its arguments."""
    before = len(frame.code)
    try:
        value: Any = frame.evaluate(part.value)
    except TranslationError:
        del frame.code[before:]
        return "...", []
    if isinstance(value, OwnName):
        return "%s", ["self->name"]
    if is_known(value):
        own = python_of(value)
        return (repr(own) if part.conversion == ord("r") else str(own)).replace("%", "%%"), []
    if isinstance(value, Seq):
        parts = [_number(each, "") for each in value.items]
        form = ", ".join(form for form, _ in parts)
        return f"({form})", [text for _, more in parts for text in more]
    wanted = ast.unparse(part.format_spec)[2:-1] if part.format_spec is not None else ""
    return _number(value, wanted)


def _number(value: Any, wanted: str) -> tuple[str, list[str]]:
    if isinstance(value, Known):
        return repr(value.value), []
    if not isinstance(value, Num):
        return "...", []
    if value.kind == "d" and re.fullmatch(r"\.\d+[gf]", wanted):
        return f"%{wanted}", [value.text]
    if value.kind == "d":
        return "%s", [f"shown(self, {value.text})"]
    return "%lld", [f"(long long){value.text}"]


def quoted(text: str) -> str:
    """Return a text as C: what is not ASCII as bytes in octal."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return (
        '"'
        + "".join(
            c if " " <= c < "\x7f" else "".join(f"\\{byte:03o}" for byte in c.encode())
            for c in escaped
        )
        + '"'
    )
