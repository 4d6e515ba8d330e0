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
import zipfile
import zlib
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import IO

from ...errors import InputError
from ...files.whole_file import unused
from ..cache import cache_folder

Members = dict[PurePosixPath, zipfile.ZipInfo]
"""By their place in the folder."""

MOST_MEMBERS = 20_000
"""Files and folders: an FMU with a whole Python environment inside has some 15,000."""
LARGEST_MEMBER = 2 * 2**30
"""Bytes that one member may have unpacked."""
LARGEST_ARCHIVE = 4 * 2**30
"""Bytes that all members together may have unpacked: binaries for every platform, with data."""
ALWAYS_ALLOWED = 256 * 2**20
"""Bytes that any archive may have unpacked, however small it is."""
MOST_RATIO = 20
"""Of unpacked bytes to those of the archive beyond that: code and tables reach 3 to 10."""

_LONGEST_PART = 255  # bytes of a file's name, in every usual file system
_LONGEST_NAME = 1024
_DEEPEST = 64
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_ENCRYPTED = 0x1
_DOS_FOLDER = 0x10
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

    A file in it that is no longer what the archive has is unpacked again.

    ``kind`` says in messages what it should be: ``FMU``, ``SSP``. Raises InputError for what
    is no zip archive, is damaged, encrypted or too large, or would write elsewhere.
    """
    folder = cache_folder("unpacked") / content_hash(path)[:24]
    try:
        with zipfile.ZipFile(path) as archive:
            members = _checked(path, archive)
            if not folder.is_dir():
                _unpack(archive, members, folder)
            for place in _damaged(folder, members):
                _unpack_again(archive, members[place], folder / place)
    except InputError:
        raise
    except Exception as error:  # zipfile has many ways to say that an archive is damaged
        why = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{path}: not an {kind}: {why or type(error).__name__}") from None
    return folder


def _unpack(archive: zipfile.ZipFile, members: Members, folder: Path) -> None:
    temporary = unused(folder.parent, "unpacking")
    temporary.mkdir()
    try:
        for place, info in members.items():
            target = temporary / place
            if info.is_dir():
                target.mkdir(parents=True, exist_ok=True)
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            with target.open("xb") as file:
                _copy(archive, info, file)
        try:
            os.replace(temporary, folder)
        except OSError:
            if not folder.is_dir():  # or else another process was first
                raise
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _unpack_again(archive: zipfile.ZipFile, info: zipfile.ZipInfo, target: Path) -> None:
    """Replace one file: a process that has the old one open, or loaded, keeps it."""
    if info.is_dir():
        target.mkdir(parents=True, exist_ok=True)
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = unused(target.parent, "unpacking")
    try:
        with temporary.open("xb") as file:
            _copy(archive, info, file)
        os.replace(temporary, target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _copy(archive: zipfile.ZipFile, info: zipfile.ZipInfo, file: IO[bytes]) -> None:
    # No more than the declared size is read, and its checksum must be right then: the sizes that
    # were checked are those that are written.
    with archive.open(info) as source:
        shutil.copyfileobj(source, file, 2**20)


def _damaged(folder: Path, members: Members) -> list[PurePosixPath]:
    """Return the places whose files are not what the archive has: cut, changed or missing."""
    return [place for place, info in members.items() if not _matches(folder / place, info)]


def _matches(path: Path, info: zipfile.ZipInfo) -> bool:
    if info.is_dir():
        return path.is_dir()
    try:
        with path.open("rb") as file:
            if os.fstat(file.fileno()).st_size != info.file_size:
                return False
            checksum = 0
            while block := file.read(2**16):
                checksum = zlib.crc32(block, checksum)
    except OSError:
        return False
    return checksum == info.CRC


def _checked(path: Path, archive: zipfile.ZipFile) -> Members:
    """Return the members. Raises InputError for any that is not to be unpacked."""
    infos = archive.infolist()
    _refuse_many(path, len(infos))
    members: Members = {}
    for info in infos:
        _refuse_odd(path, info)
        place = _place(path, info)
        if not place.parts:  # the archive's own folder, which many tools write
            continue
        if not _are_alike(members.setdefault(place, info), info):
            raise InputError(f"{path}: two members are called {info.filename!r}")
    folders = {parent for place in members for parent in place.parents}
    _refuse_many(path, len(folders | members.keys()))
    for place in folders & members.keys():
        if not members[place].is_dir():
            raise InputError(f"{path}: member {str(place)!r} is a file and a folder")
    _refuse_bomb(path, sum(info.file_size for info in infos))
    return members


def _are_alike(one: zipfile.ZipInfo, other: zipfile.ZipInfo) -> bool:
    """Say that two members of one name are the same: tools write folders, and files, twice."""
    return (one.is_dir(), one.CRC, one.file_size) == (other.is_dir(), other.CRC, other.file_size)


def _refuse_many(path: Path, count: int) -> None:
    if count > MOST_MEMBERS:
        raise InputError(f"{path}: {count} files and folders, more than {MOST_MEMBERS}")


def _refuse_bomb(path: Path, unpacked_bytes: int) -> None:
    """Raise InputError for an archive too large, or that would grow beyond any honest ratio."""
    own = path.stat().st_size
    most = min(LARGEST_ARCHIVE, max(ALWAYS_ALLOWED, MOST_RATIO * own))
    if unpacked_bytes > most:
        raise InputError(
            f"{path}: its {own} bytes would be {unpacked_bytes} unpacked, more than {most}"
        )


def _place(path: Path, info: zipfile.ZipInfo) -> PurePosixPath:
    """Return where a member goes, empty for the archive's own folder; its name is that then.

    ``./``, doubled slashes and ``..`` within the archive are harmless, as nothing in it is a link.
    """
    # zipfile cuts the other one at a NUL. Some tools on Windows write backslashes.
    name = info.orig_filename.replace("\\", "/")
    by_name = name.rpartition("/")[2] in ("", ".", "..")
    is_folder = info.file_size == 0 and (by_name or _is_marked_folder(info))
    parts: list[str] = []
    for part in name.split("/"):
        if part == ".." and parts and parts[-1] != "..":
            parts.pop()
        elif part not in ("", "."):
            parts.append(part)
    rooted = name.startswith("/") and parts
    if ".." in parts or rooted or re.match(r"[A-Za-z]:", "/".join(parts)):
        raise InputError(f"{path}: member {name!r} would be unpacked outside its folder")
    if (
        by_name > is_folder  # with content
        or max((len(part.encode("utf-8", "replace")) for part in parts), default=0) > _LONGEST_PART
        or len(parts) > _DEEPEST
        or len(name) > _LONGEST_NAME
        or _CONTROL.search(name)
        or (os.name == "nt" and PureWindowsPath(*parts).is_reserved())
    ):
        raise InputError(f"{path}: member {name[:80]!r} is no name of a file")
    info.filename = "/".join(parts) + "/" * is_folder
    return PurePosixPath(*parts)


def _is_marked_folder(info: zipfile.ZipInfo) -> bool:
    """Say if a member is a folder by its attributes, of Unix or of MS-DOS."""
    return stat.S_ISDIR(info.external_attr >> 16) or bool(info.external_attr & _DOS_FOLDER)


def _refuse_odd(path: Path, info: zipfile.ZipInfo) -> None:
    """Raise InputError for a member that is no plain file or folder of a reasonable size."""
    kind = stat.S_IFMT(info.external_attr >> 16)
    name = info.orig_filename
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
