"""Excerpt of a DBC: the messages that are asked for, and what belongs to them.

Whatever else is in a file cannot matter then: syntax that no reader knows, identifiers that no bus
has, values of signals that are gone. What is left out becomes blanks, so that lines keep their
numbers.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator

from seatrial.errors import InputError, unknown

_STRING = re.compile(r'"(?:[^"\\]|\\.)*"', re.DOTALL)
_STATEMENT = re.compile(r"(?:^|(?<=;))[ \t]*(?!SG_\b)(?P<kind>VERSION|[A-Z][A-Z0-9_]*_)\b", re.M)
_EMPTY_LINE = re.compile(r"\n[ \t\r]*\n")
_MESSAGE = re.compile(r"\s*BO_\s+(?P<id>\S+)\s+(?P<name>[^\s:]+)")
_OF_SIGNAL = re.compile(r"\s*(?:SIG_VALTYPE_|SG_MUL_VAL_)\s+(?P<id>\d+)\s+(?P<signal>\w+)")
_DEFINITION = re.compile(r'\s*BA_DEF(?:_DEF)?_\s+(?:BO_|SG_)?\s*"(?P<name>\w+)"')
_ATTRIBUTE = re.compile(
    r'\s*BA_\s+"(?P<name>\w+)"\s+'
    r"(?:BO_\s+(?P<id>\d+)|SG_\s+(?P<of>\d+)\s+(?P<signal>\w+))?"
)
_IDENTIFIER = re.compile(
    r'\s*(?:BO_|SIG_VALTYPE_|SG_MUL_VAL_|BA_\s+"\w+"\s+(?:BO_|SG_))\s+(?P<id>\d{1,10})\b'
)
_LARGEST_STANDARD, _LARGEST_EXTENDED, _EXTENDED = 0x7FF, 0x1FFFFFFF, 1 << 31
_LONG_NAME = "SystemMessageLongSymbol"
_ATTRIBUTES = {
    "GenMsgCycleTime",
    "GenSigStartValue",
    "VFrameFormat",
    "BusType",
    _LONG_NAME,
    "SystemSignalLongSymbol",
}
"""Attributes that are read here."""


def excerpt(text: str, wanted: Collection[str]) -> str:
    """Return a DBC with the messages of ``wanted`` alone, each line where it was.

    Raises InputError, with near misses, for a message that the file does not have, and with its
    lines for one that it has twice.
    """
    statements = list(_statements(text))
    messages: dict[str, list[tuple[str, int]]] = {}
    for kind, start, end in statements:
        if kind == "BO_" and (found := _MESSAGE.match(text, start, end)):
            messages.setdefault(found["name"], []).append((found["id"], found.start("id")))
    if not messages:
        raise InputError("not a usable DBC: no message (BO_) was found")
    names = _long_names(text, statements, messages)
    for name in wanted:
        if name not in names:
            raise InputError(unknown("message", name, names))
        places = messages[names[name]]
        if len(places) > 1:
            lines = " and ".join(str(text.count("\n", 0, place) + 1) for _, place in places)
            raise InputError(f"message {name} stands twice, in lines {lines}")
    kept = {messages[names[name]][0] for name in wanted}
    identifiers = {identifier for identifier, _ in kept}
    blocks = {
        identifier: text[start:end]
        for kind, start, end in statements
        if kind == "BO_" and (found := _MESSAGE.match(text, start, end))
        for identifier, place in kept
        if found.start("id") == place
    }
    parts, done = [], 0
    for kind, start, end in statements:
        found = _MESSAGE.match(text, start, end) if kind == "BO_" else None
        own = found is not None and (found["id"], found.start("id")) in kept
        if own or _belongs(text, kind, start, end, identifiers, blocks):
            parts += [_blank(text[done:start]), _marked(text[start:end])]
            done = end
    return "".join([*parts, _blank(text[done:])])


def _statements(text: str) -> Iterator[tuple[str, int, int]]:
    """Yield keyword, begin and end of each statement; signals are part of their message's."""
    masked = _STRING.sub(lambda found: _blank(found[0]), text)
    found = list(_STATEMENT.finditer(masked))
    ends = [each.start() for each in found[1:]] + [len(text)]
    for each, end in zip(found, ends, strict=True):
        start = each.start()
        if each["kind"] == "BO_":  # behind its last signal, what stands apart is not its own
            last = masked.rfind("SG_", start, end)
            apart = _EMPTY_LINE.search(masked, max(last, start), end)
            end = end if apart is None else apart.start()
        yield each["kind"], start, end


def _long_names(
    text: str, statements: list[tuple[str, int, int]], messages: dict[str, list[tuple[str, int]]]
) -> dict[str, str]:
    """Return the short name of each message, by the name that it has for a reader."""
    by_identifier = {places[0][0]: name for name, places in messages.items()}
    names = {name: name for name in messages}
    for kind, start, end in statements:
        found = _ATTRIBUTE.match(text, start, end) if kind == "BA_" else None
        if found and found["name"] == _LONG_NAME and found["id"] in by_identifier:
            written = _STRING.search(text, found.end(), end)
            if written is not None:
                short = by_identifier[found["id"]]
                names.pop(short, None)
                names[written[0][1:-1]] = short
    return names


def _belongs(
    text: str, kind: str, start: int, end: int, identifiers: set[str], blocks: dict[str, str]
) -> bool:
    """Return whether a statement belongs to a message that is kept, or to all."""
    if kind in ("BA_DEF_", "BA_DEF_DEF_"):
        found = _DEFINITION.match(text, start, end)
        return found is not None and found["name"] in _ATTRIBUTES
    if kind == "BA_":
        found = _ATTRIBUTE.match(text, start, end)
        if found is None or found["name"] not in _ATTRIBUTES:
            return False
        identifier = found["id"] or found["of"]
        return identifier is None or (
            identifier in identifiers and _has(blocks[identifier], found["signal"])
        )
    if kind in ("SIG_VALTYPE_", "SG_MUL_VAL_"):
        found = _OF_SIGNAL.match(text, start, end)
        return (
            found is not None
            and found["id"] in identifiers
            and _has(blocks[found["id"]], found["signal"])
        )
    return False


def _marked(statement: str) -> str:
    """Return a statement whose identifier is marked as extended if it has more than 11 bits.

    Bit 31 is the mark; files that people write lack it, where 29 bits are meant.
    """
    found = _IDENTIFIER.match(statement)
    if found is None or not _LARGEST_STANDARD < int(found["id"]) <= _LARGEST_EXTENDED:
        return statement
    marked = int(found["id"]) | _EXTENDED
    return f"{statement[: found.start('id')]}{marked}{statement[found.end('id') :]}"


def _has(block: str, signal: str | None) -> bool:
    """Return whether a message has a signal; attributes of ones that are gone are left behind."""
    return signal is None or re.search(rf"\bSG_\s+{re.escape(signal)}\b", block) is not None


def _blank(text: str) -> str:
    """Return as many lines as a text has."""
    return re.sub(r"[^\n]", " ", text)
