"""Files that are written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path


def write_whole(path: Path, content: bytes | str, *, synced: bool = False) -> None:
    """Replace the file ``path`` by ``content`` (text as UTF-8); it is never found half written.

    ``synced`` waits until the disk has it: not in a loop that keeps to wall time. Raises OSError
    with the name of the file, as on a full disk: what was there before stays.
    """
    temporary = None
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name[:40]}-")
        with os.fdopen(handle, "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            if synced:
                file.flush()
                os.fsync(file.fileno())
        os.chmod(temporary, 0o644)  # mkstemp's files are private
        os.replace(temporary, path)
    except BaseException as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from None
        raise


def stamp(path: Path) -> tuple[int, int]:
    """Return what changes with the content of a file, for caches; zeros without one."""
    try:
        found = path.stat()
    except OSError:  # whoever reads it says so
        return (0, 0)
    return found.st_mtime_ns, found.st_size
