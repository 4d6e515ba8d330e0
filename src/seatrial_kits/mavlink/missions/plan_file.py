"""Files of mission items: "QGC WPL 110", which ground stations write and read."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

from seatrial.errors import InputError
from seatrial.whole_file import write_whole

from .plan_items import Item, as_integer

_HEAD = "QGC WPL 110"
_COLUMNS = 12
_FLOAT32 = struct.Struct("<f")


def read_items(path: Path) -> tuple[Item, ...]:
    """Return the items of a file, none if there is no file.

    After the line ``QGC WPL 110`` there is a line per item, of 12 columns: sequence, whether it
    is the current one, frame, command, parameters 1 to 7 with latitude and longitude in degrees,
    autocontinue. Lines that begin with ``#`` are comments. Items count in the order of their
    lines. Raises InputError, with the line, for anything else, and for a file that cannot be
    read.
    """
    try:
        lines = path.read_text("utf-8").splitlines()
    except FileNotFoundError:
        return ()
    except (OSError, UnicodeDecodeError) as error:
        cause = error.strerror if isinstance(error, OSError) else "not UTF-8"
        raise InputError(f"plan file {path}: {cause}") from None
    if not lines or lines[0].strip() != _HEAD:
        raise InputError(f"plan file {path}: its first line must be {_HEAD!r}")
    items = []
    for number, line in enumerate(lines[1:], 2):
        columns = line.split()
        if columns and not columns[0].startswith("#"):
            try:
                items.append(_item(columns))
            except (ValueError, OverflowError, struct.error):
                found = line.strip()[:60]
                raise InputError(
                    f"plan file {path}, line {number}: {found!r} is no item of {_COLUMNS} columns"
                ) from None
    return tuple(items)


def write_items(path: Path, items: Sequence[Item]) -> None:
    """Write a file whole, or leave it as it was. Raises OSError."""
    lines = [_line(sequence, item) for sequence, item in enumerate(items)]
    write_whole(path, "\n".join([_HEAD, *lines, ""]))


def _item(columns: Sequence[str]) -> Item:
    if len(columns) != _COLUMNS:
        raise ValueError
    frame, command = _whole(columns[2], 0xFF), _whole(columns[3], 0xFFFF)
    p1, p2, p3, p4, _, _, z = (_float32(column) for column in columns[4:11])
    x, y = (as_integer(float(column), frame) for column in columns[8:10])
    return Item(command, frame, (p1, p2, p3, p4), x, y, z, _whole(columns[11], 0xFF))


def _line(sequence: int, item: Item) -> str:
    # Seven decimals of a degree and nine digits of a float are what a message can tell apart.
    x, y = (f"{value:.7f}" for value in item.coordinates())
    parameters = [f"{value:.9g}" for value in item.parameters]
    columns = (*parameters, x, y, f"{item.z:.9g}")
    head = (sequence, int(sequence == 0), item.frame, item.command)
    return "\t".join(map(str, (*head, *columns, item.autocontinue)))


def _whole(text: str, most: int) -> int:
    value = int(text)
    if not 0 <= value <= most:
        raise ValueError
    return value


def _float32(text: str) -> float:
    """Return the number nearest to ``text`` that a message can carry."""
    value: float = _FLOAT32.unpack(_FLOAT32.pack(float(text)))[0]
    return value
