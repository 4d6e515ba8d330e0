"""Zip archives of other people (``.fmu``, ``.ssp``), unpacked without trust in what they say.

Nothing is written outside the cache folder, a limit bounds what is written inside, and an
archive that cannot be unpacked whole leaves nothing.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import stat
import tempfile
import zipfile
from pathlib import Path, PurePosixPath

from ..errors import InputError
from .cache import cache_folder

Members = dict[PurePosixPath, zipfile.ZipInfo]
"""By their place in the folder."""

MOST_MEMBERS = 100_000
LARGEST_MEMBER = 2 * 2**30
"""Bytes that one member may have unpacked."""
LARGEST_ARCHIVE = 4 * 2**30
"""Bytes that all members together may have unpacked."""

_LONGEST_PART = 255  # bytes of a file's name, in every usual file system
_LONGEST_NAME = 1024
_ENCRYPTED = 0x1
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # FMI and SSP allow no other


def content_hash(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal digits. Raises InputError."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None


def unpacked(path: Path, kind: str) -> Path:
    """Return the folder that the archive ``path`` is unpacked in, once for each content.

    ``kind`` says in messages what it should be: ``FMU``, ``SSP``. Raises InputError for what
    is no zip archive, is damaged, encrypted or too large, or would write elsewhere.
    """
    folder = cache_folder("unpacked") / content_hash(path)[:24]
    try:
        with zipfile.ZipFile(path) as archive:
            members = _checked(path, archive)
            if not _is_whole(folder, members):
                _unpack(archive, members, folder)
    except InputError:
        raise
    except Exception as error:  # zipfile has many ways to say that an archive is damaged
        why = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{path}: not an {kind}: {why or type(error).__name__}") from None
    return folder


def _unpack(
    archive: zipfile.ZipFile, members: dict[PurePosixPath, zipfile.ZipInfo], folder: Path
) -> None:
    temporary = Path(tempfile.mkdtemp(dir=folder.parent, prefix="unpacking-"))
    try:
        for place, info in members.items():
            target = temporary / place
            if info.is_dir():
                target.mkdir(parents=True, exist_ok=True)
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            # No more than the declared size is read, and its checksum must be right then.
            with archive.open(info) as source, target.open("xb") as file:
                shutil.copyfileobj(source, file, 2**20)
        if folder.is_dir() and not _is_whole(folder, members):  # somebody removed a part of it
            shutil.rmtree(folder, ignore_errors=True)
        try:
            os.replace(temporary, folder)
        except OSError:
            if not _is_whole(folder, members):  # or else another process was first
                raise
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _is_whole(folder: Path, members: Members) -> bool:
    """Say if everything in the archive is still there unpacked."""
    return folder.is_dir() and all((folder / place).exists() for place in members)


def _checked(path: Path, archive: zipfile.ZipFile) -> Members:
    """Return the members. Raises InputError for any that is not to be unpacked."""
    infos = archive.infolist()
    if len(infos) > MOST_MEMBERS:
        raise InputError(f"{path}: {len(infos)} members, more than {MOST_MEMBERS}")
    members: Members = {}
    for info in infos:
        place = _place(path, info)
        if place in members:
            raise InputError(f"{path}: two members are called {info.filename!r}")
        _refuse_odd(path, info)
        members[place] = info
    folders = {parent for place in members for parent in place.parents}
    for place in folders & members.keys():
        if not members[place].is_dir():
            raise InputError(f"{path}: member {str(place)!r} is a file and a folder")
    if sum(info.file_size for info in infos) > LARGEST_ARCHIVE:
        raise InputError(f"{path}: its members have more than {LARGEST_ARCHIVE} bytes unpacked")
    return members


def _place(path: Path, info: zipfile.ZipInfo) -> PurePosixPath:
    name = info.orig_filename  # zipfile cuts the other one at a NUL
    place = PurePosixPath(name)
    if ".." in place.parts or name.startswith("/") or re.match(r"[A-Za-z]:", name) or "\\" in name:
        raise InputError(f"{path}: member {name!r} would be unpacked outside its folder")
    parts = [part.encode("utf-8", "replace") for part in place.parts]
    if (
        not parts
        or "\0" in name
        or max(map(len, parts)) > _LONGEST_PART
        or len(name) > _LONGEST_NAME
    ):
        raise InputError(f"{path}: member {name[:80]!r} is no name of a file")
    return place


def _refuse_odd(path: Path, info: zipfile.ZipInfo) -> None:
    """Raise InputError for a member that is no plain file or folder of a reasonable size."""
    kind = stat.S_IFMT(info.external_attr >> 16)
    name = info.filename
    if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
        what = "a symbolic link" if kind == stat.S_IFLNK else "no plain file"
        raise InputError(f"{path}: member {name!r} is {what}")
    if info.flag_bits & _ENCRYPTED:
        raise InputError(f"{path}: member {name!r} is encrypted")
    if info.compress_type not in _METHODS:
        raise InputError(
            f"{path}: member {name!r} is compressed by method {info.compress_type}; "
            "stored (0) and deflated (8) are allowed"
        )
    if info.file_size > LARGEST_MEMBER:
        raise InputError(
            f"{path}: member {name!r} has {info.file_size} bytes unpacked, more than "
            f"{LARGEST_MEMBER}"
        )
