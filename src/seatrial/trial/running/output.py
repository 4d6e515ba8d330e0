"""Folders that commands claim for what they write, and JSON files in them."""

from __future__ import annotations

import contextlib
import datetime
import itertools
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import InputError
from ...files.whole_file import write_whole

_RESERVE = 4096
"""Bytes kept for how a run ends."""


def claim_folder(out: Path | None, name: str, index: str, base: Path = Path()) -> Path:
    """Create the folder of a run for this process alone, and return it.

    None makes a new one, ``runs/NAME-DATE-TIME``; else ``out`` must not hold anything yet.
    ``index`` is the file that claims the folder; ``base`` is where relative paths start. Raises
    InputError.
    """
    try:
        if out is None:
            return _new_folder(base, name)
        folder = base / out
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise FileExistsError
        (folder / index).open("x").close()
    except (FileExistsError, NotADirectoryError):
        message = f"{out} exists and is not an empty folder; name another with --out"
        raise InputError(message) from None
    except OSError as error:
        raise InputError(f"cannot create {out or 'runs'}: {error.strerror}") from None
    return folder


def _new_folder(base: Path, name: str) -> Path:
    stamp = datetime.datetime.now().strftime("%Y%m%d-%H%M%S")
    for count in itertools.count(1):
        folder = base / "runs" / (f"{name}-{stamp}" + (f"-{count}" if count > 1 else ""))
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            continue
        return folder
    raise AssertionError("unreachable")


def write_json(path: Path, content: Any, *, synced: bool = False) -> None:
    """Write a JSON file as `write_whole` does. Raises OSError with the file's name."""
    write_whole(path, json_text(content) + "\n", synced=synced)


def write_with_reserve(path: Path, text: str) -> None:
    """Write a JSON text with space for `write_into_reserve`, white space at its end."""
    write_whole(path, text + " " * _RESERVE + "\n")


def write_into_reserve(path: Path, text: str) -> None:
    """Write a JSON text, in the place of the file that is there if the disk cannot hold two.

    Raises OSError with the file's name.
    """
    try:
        write_whole(path, text + "\n")
    except OSError as error:
        data = (text + "\n").encode()
        with contextlib.suppress(OSError), path.open("r+b") as file:
            size = file.seek(0, os.SEEK_END)
            if len(data) <= size:
                file.seek(0)
                file.write(data.ljust(size))
                return
        raise error


def json_text(content: Any) -> str:
    """Return JSON as files have it."""
    return json.dumps(content, indent=1, ensure_ascii=False)


def with_more(text: str, more: Mapping[str, Any]) -> str:
    """Return the `json_text` of an object, which is not empty, with ``more`` behind what it has."""
    return text.removesuffix("\n}") + "," + json_text(more).removeprefix("{")
