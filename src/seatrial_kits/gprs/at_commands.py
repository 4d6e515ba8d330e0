"""AT commands: bytes on a line to commands, and results to bytes.

The syntax is that of ITU-T V.250 and 3GPP TS 27.007: a line begins with ``AT``, ends with a
carriage return (line feeds do not matter), and has basic commands (a letter, or ``&`` and a
letter, and a number) one after the other, and extended ones (``+NAME``) with a semicolon between.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

LONGEST = 556
"""Characters of a line, as a SIM900 takes them; what is longer is an error."""

_BASIC = re.compile(r"(&?[A-Z])([0-9]*)", re.IGNORECASE)
_EXTENDED = re.compile(r'(\+[A-Z0-9]+)(=\?|\?|=(?:"[^"]*"|[^";])*)?', re.IGNORECASE)
_FIELD = re.compile(r'\s*("[^"]*"|[^",]*)\s*(,|$)')


class Command(NamedTuple):
    """A command: its name in upper case, ``+CREG``, ``E`` or ``&F``, and what is done with it."""

    name: str
    form: str
    """execute, read (``?``), test (``=?``) or write (``=``)."""
    fields: tuple[str, ...] = ()
    """What is written; texts without their quotation marks."""

    def number(self, place: int, default: int | None = None) -> int:
        """Return a field as a whole number. Raises ValueError for one that is none."""
        text = self.fields[place] if place < len(self.fields) else ""
        if not text and default is not None:
            return default
        if not re.fullmatch(r"[0-9]{1,9}", text):
            raise ValueError(f"{text!r} is no number")
        return int(text)


def read_line(line: str) -> list[Command] | None:
    """Return the commands of a line without its end, [] for ``AT`` alone, None for no command.

    A line that is none, an unknown form in it, or quotation marks that do not close give None.
    """
    text = line.strip()
    if text[:2].upper() != "AT":
        return None
    place, found = 2, []
    while place < len(text):
        if text[place] in " ;":
            place += 1
            continue
        match = (_EXTENDED if text[place] == "+" else _BASIC).match(text, place)
        if match is None:
            return None
        command = _command(match)
        if command is None:
            return None
        found.append(command)
        place = match.end()
        if match[1].startswith("+") and text[place : place + 1] not in ("", ";"):
            return None
    return found


def _command(match: re.Match[str]) -> Command | None:
    name, rest = match[1].upper(), match[2] or ""
    if not name.startswith("+"):
        return Command(name, "write" if rest else "execute", (rest,) if rest else ())
    if rest in ("", "?", "=?"):
        return Command(name, {"": "execute", "?": "read", "=?": "test"}[rest])
    fields = _fields(rest[1:])
    return None if fields is None else Command(name, "write", fields)


def _fields(text: str) -> tuple[str, ...] | None:
    found, place = [], 0
    while True:
        match = _FIELD.match(text, place)
        if match is None:
            return None
        found.append(match[1].strip().strip('"'))
        place = match.end()
        if not match[2]:
            return tuple(found)


class Line:
    """Collects the characters of a line, or a block of data that was announced.

    ``memory`` is a dict that belongs to a component's state, empty at the start.
    """

    def __init__(self, memory: dict[str, Any]) -> None:
        self._memory = memory
        memory.setdefault("line", "")
        memory.setdefault("last", "AT")

    def take(self, byte: int) -> str | None:
        """Take in one byte; return the line, without its end, if it is whole now.

        ``A/`` is the line before again. A backspace takes back a character.
        """
        memory, letter = self._memory, chr(byte)
        if letter == "\r":
            line, memory["line"] = memory["line"], ""
            if line.strip():
                memory["last"] = line
                return str(line)
            return None
        if letter == "\n":
            return None
        if letter == "\b":
            memory["line"] = memory["line"][:-1]
        elif len(memory["line"]) <= LONGEST:
            memory["line"] += letter
        if memory["line"].upper() == "A/":
            memory["line"] = ""
            return str(memory["last"])
        return None


def result(text: str) -> bytes:
    """Return a result or an unsolicited one as it is on the line: between ends of line."""
    return f"\r\n{text}\r\n".encode("latin-1")
