"""Long tables of values over time: a file of columns, read where they are played."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...files.whole_file import stamp

SUFFIX = ".table"
_KINDS: dict[str, Callable[[Any], Any]] = {"real": float, "boolean": bool}


def write_stored(
    path: Path,
    title: str,
    times_ns: NDArray[np.int64],
    columns: Sequence[tuple[str, str, str, str, NDArray[np.float64]]],
) -> None:
    """Write a table: times (n,), and name, kind (real, boolean), unit, linear or held, values (n,).

    The first line is a JSON object about the columns, the rest is binary: 8 bytes a value, one
    column after the other. Raises OSError.
    """
    head = {
        "file": title,
        "rows": len(times_ns),
        "columns": [[name, kind, unit, how] for name, kind, unit, how, _ in columns],
    }
    with path.open("wb") as file:
        file.write(json.dumps(head, separators=(",", ":")).encode() + b"\n")
        np.asarray(times_ns, "<i8").tofile(file)
        for *_, values in columns:
            np.asarray(values, "<f8").tofile(file)


def stored_head(path: Path) -> str:
    """Return the head of a stored table with its place, as `table.table_component` takes it.

    Raises InputError for a file that is none.
    """
    with path.open("rb") as file:
        try:
            head = json.loads(file.readline())
        except ValueError:
            raise InputError(f"{path}: no table that seatrial shadow has written") from None
        place = {"stored": str(path), "offset": file.tell(), "stamp": stamp(path)}
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    return json.dumps({**head, **place, "sha256": digest}, separators=(",", ":"))


def content_of(text: str) -> str:
    """Return the text of a table without the place of its file: equal for equal values."""
    if '"stored":' not in text:
        return text
    head = json.loads(text)
    return json.dumps({key: head[key] for key in ("file", "rows", "columns", "sha256")})


def stored_columns(head: dict[str, Any]) -> tuple[Sequence[int], list[list[Any]]]:
    """Return times, ns, and the columns as `table.table_component` has them, left in the file."""
    rows = int(head["rows"])
    data = np.memmap(head["stored"], "<f8", "r", head["offset"], (len(head["columns"]) + 1, rows))
    columns = [
        [name, kind, unit, how, Stored(values, _KINDS[kind])]
        for (name, kind, unit, how), values in zip(head["columns"], data[1:], strict=True)
    ]
    return Stored(data[0].view("<i8"), int), columns


class Stored(Sequence[Any]):
    """Values of one column in a file, as Python has them."""

    def __init__(self, values: NDArray[Any], kind: Callable[[Any], Any]) -> None:
        self._values, self._kind = values, kind

    def __len__(self) -> int:
        return len(self._values)

    def __getitem__(self, place: Any) -> Any:
        return self._kind(self._values[place])
