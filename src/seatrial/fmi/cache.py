"""Folders for built and unpacked FMUs, and files written whole."""

from __future__ import annotations

import atexit
import errno
import os
import re
import shutil
import tempfile
from functools import cache
from pathlib import Path

import platformdirs

from ..errors import InputError
from ..files.whole_file import write_whole

# pythonfmu's binary decodes only %20 of a resource URI and crashes on the rest.
_SAFE = re.compile(r"[A-Za-z0-9_./\\: -]+")


def is_safe(path: Path) -> bool:
    """Say if FMUs may be unpacked in ``path``: plain ASCII letters, digits, ``_-./`` and space."""
    return _SAFE.fullmatch(str(path)) is not None


def cache_folder(kind: str) -> Path:
    """Return the user's cache folder for ``kind``, created.

    It is ``SEATRIAL_CACHE`` if that is set, else the system's usual place; if that place has
    characters that FMU binaries cannot take, a temporary folder of this process.

    Raises InputError if no folder with a safe name can be had.
    """
    folder = _base() / kind
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _base() -> Path:
    named = os.environ.get("SEATRIAL_CACHE")
    if named:
        folder = Path(named).resolve()
        if not is_safe(folder):
            raise InputError(
                f"SEATRIAL_CACHE is {named!r}: FMUs can only be unpacked in a folder whose path "
                "has plain ASCII letters, digits, '_', '-', '.' and spaces"
            )
        return folder
    usual = Path(platformdirs.user_cache_dir("seatrial", appauthor=False)).resolve()
    return usual if is_safe(usual) and _writable(usual) else _temporary()


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


@cache
def _temporary() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="seatrial-"))
    if not is_safe(folder):
        raise InputError(
            f"FMUs cannot be unpacked in {folder}: set SEATRIAL_CACHE to a folder whose path has "
            "plain ASCII letters, digits, '_', '-', '.' and spaces"
        )
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def write_named(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, on the disk when this returns.

    Raises InputError where no file can be written, and OSError for a full or broken disk.
    """
    try:
        write_whole(path, content, synced=True)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO):
            raise
        raise InputError(f"cannot write {path}: {error.strerror}") from None
