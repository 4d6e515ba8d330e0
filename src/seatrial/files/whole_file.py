"""Files that are written whole or not at all, with the permissions that the umask leaves."""

from __future__ import annotations

import contextlib
import os
import secrets
from pathlib import Path


def write_whole(path: Path, content: bytes | str, *, synced: bool = False) -> None:
    """Replace the file ``path`` by ``content`` (text as UTF-8); it is never found half written.

    ``synced`` waits until the disk has it: not in a loop that keeps to wall time. Raises OSError
    with the name of the file, as on a full disk: what was there before stays.
    """
    temporary = unused(path.parent, f".{path.name[:40]}")
    try:
        with temporary.open("xb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            if synced:
                file.flush()
                os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from None
        raise


def unused(folder: Path, name: str) -> Path:
    """Return a path in a folder that nobody has, for what is then renamed.

    What tempfile makes there would be for its user alone, whatever the umask says.
    """
    return folder / f"{name}-{secrets.token_hex(8)}"


def stamp(path: Path) -> tuple[int, int]:
    """Return what changes with the content of a file, for caches; zeros without one."""
    try:
        found = path.stat()
    except OSError:  # whoever reads it says so
        return (0, 0)
    return found.st_mtime_ns, found.st_size
