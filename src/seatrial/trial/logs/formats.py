"""Formats of logs, which kits bring: by name and by content."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ...errors import InputError
from ...kits import lacking
from ...plugins import Registry

if TYPE_CHECKING:
    from .channels import Log
    from .quantities import Column

_HEAD = 8192
"""Bytes at the beginning of a file by which a format is recognised."""


@dataclass(frozen=True)
class Format:
    """A format of logs.

    ``recognises`` says from path and first bytes (none of a folder) if a log is of this format.
    ``read`` returns the log, and raises InputError for content that is not of the format. The
    column of the time is for tables: others have times of their own, and are not handed one.
    """

    title: str
    recognises: Callable[[Path, bytes], bool]
    read: Callable[[Path, Column | None], Log]
    table: bool = False
    defaults: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """Channels that can serve a quantity, as `Log.defaults`, unless the log itself says them."""


FORMATS = Registry("seatrial.log_formats", "log format", {})
_PACKED = {b"\x1f\x8b": "gzip", b"PK\x03\x04": "zip", b"BZh": "bzip2", b"\xfd7zXZ": "xz",
           b"\x28\xb5\x2f\xfd": "Zstandard", b"7z\xbc\xaf": "7-Zip"}  # fmt: skip
"""First bytes of compressed files."""
_OWN_TIME = "time"
"""What experiments call the time of a log that has times of its own."""
_LAST = "csv"
"""Any text with commas looks like it."""


def read_log(path: Path, format_name: str | None = None, time: Column | None = None) -> Log:
    """Return the log at ``path``, of the format that is named, or that its content has.

    Raises InputError for a path that is not there or empty, a format that is not known, a column
    of the time for a log that is no table, a library that is not installed, and as the format's
    reader does.
    """
    head = _head(path)
    name = format_name or _found(path, head)
    chosen: Format = FORMATS.load(name)
    if time is not None and not chosen.table and time.name != _OWN_TIME:
        raise InputError(f"{path}: time: {chosen.title} has times of its own")
    try:
        log = chosen.read(path, time)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except ImportError as error:
        if said := lacking(error):
            raise InputError(f"{path}: {chosen.title}: {said}") from None
        raise
    if not log.channels:
        there = "".join(f"; {note}" for note in log.notes)
        raise InputError(
            f"{path}: no channel was found in it, read as {chosen.title} ({name}){there}"
        )
    if not any(len(each.values) for each in log.channels.values()):
        raise InputError(f"{path}: no row of values was found in it, read as {chosen.title}")
    return log if log.defaults else replace(log, defaults=chosen.defaults)


def format_of(path: Path) -> str:
    """Return the name of the format that a log's content has; raises InputError for none."""
    return _found(path, _head(path))


def _head(path: Path) -> bytes:
    if path.is_dir():
        return b""
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except FileNotFoundError:
        raise InputError(f"there is no log {path}") from None
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    if not head:
        raise InputError(f"{path}: the file is empty")
    return head


def _found(path: Path, head: bytes) -> str:
    for name in sorted(FORMATS.names(), key=lambda name: name == _LAST):
        if FORMATS.load(name).recognises(path, head):
            return name
    packed = next((name for magic, name in _PACKED.items() if head.startswith(magic)), None)
    if packed is not None:
        raise InputError(f"{path}: is compressed ({packed}); logs are read as they are unpacked")
    if path.is_dir():
        raise InputError(f"{path}: a folder that is neither a run nor a ROS 2 bag; name a file")
    titles = ", ".join(f"{name} ({FORMATS.load(name).title})" for name in FORMATS.names())
    raise InputError(f"{path}: its format is not known; --format can name one of {titles}")
