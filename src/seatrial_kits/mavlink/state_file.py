"""State file: what a vehicle keeps from one run to the next."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.files.reading import json_content
from seatrial.files.whole_file import write_whole


class StateFile:
    """A JSON object on disk, one key per service that remembers something; none for no path.

    Raises InputError for a file that is not such an object or cannot be read, and when it
    cannot be written.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._content: dict[str, Any] = _read(path) if path is not None else {}

    def get(self, key: str, default: Any) -> Any:
        """Return what was put under ``key``, in this run or an earlier one.

        Raises InputError if the file has something of another type than ``default`` there; with
        None as the default anything may be there.
        """
        value = self._content.get(key, default)
        if default is not None and type(value) is not type(default):
            kind = type(default).__name__
            raise InputError(f"state file {self._path}: {key}: {kind} needed, found {value!r}")
        return value

    def put(self, key: str, value: Any) -> None:
        """Remember ``value`` (plain data) under ``key``; on disk when this returns."""
        self._content[key] = value
        if self._path is not None:
            self._write(self._path)

    def _write(self, path: Path) -> None:
        try:
            write_whole(path, json.dumps(self._content, indent=1) + "\n")
        except OSError as error:
            raise InputError(f"state file {path}: {error.strerror}") from None


def _read(path: Path) -> dict[str, Any]:
    try:
        content = json_content(path.read_bytes(), f"state file {path}")
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise InputError(f"state file {path}: {error.strerror}") from None
    if not isinstance(content, dict):
        raise InputError(f"state file {path}: a JSON object is needed")
    return content
