"""Sandbox for the process of a foreign FMU, by bubblewrap: no network, no files but its own."""

from __future__ import annotations

import os
import shutil
import site
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from ...errors import InputError
from ...kits import OURS
from ..interfaces.loaded import LoadedFmu

PARENT = 1
"""Process that a sandboxed one ends with, as it sees it: bubblewrap's, which ends with ours."""
MEMORY = "SEATRIAL_MEMORY"
"""Environment variable with the bytes of memory that a worker may have for itself."""
MEMORY_GIB = 4
"""Of a process in a sandbox: its heap, stacks and private mappings."""
_GIB = 1 << 30
_FILES = str(_GIB)
"""Bytes of files in memory, in /tmp and in /dev/shm each."""
_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/etc/ld.so.cache")
_ALTERNATIVES = Path("/etc/alternatives")
"""Links by which Debian's /usr/bin/cc leads to a compiler."""
_ENVIRONMENT = ("LANG", "LC_ALL", "LD_LIBRARY_PATH", "PATH", "PYTHONDONTWRITEBYTECODE", "TZ")
"""What of the environment it gets: others may hold secrets."""
_ISOLATION = (
    "--unshare-all",
    *("--cap-drop", "ALL"),
    "--die-with-parent",
    *("--proc", "/proc"),
    *("--dev", "/dev"),
    *("--size", _FILES, "--tmpfs", "/tmp"),
    *("--size", _FILES, "--tmpfs", "/dev/shm"),
    *("--remount-ro", "/dev"),  # a file system in memory too
)


def sandbox_command(fmu: LoadedFmu) -> list[str]:
    """Return the command that a worker's command is an argument of, to run it in a sandbox.

    The worker sees, read-only, the system's libraries, Python with its packages, seatrial and
    ``fmu`` with its unpacked folder; a /tmp of its own, which goes with it; nothing else. Its
    environment has a limit for its memory, which it sets itself before it loads the FMU.

    Raises InputError if bubblewrap is not there or cannot make a sandbox here.
    """
    built = [] if fmu.built is None else [fmu.built]
    return _sandbox((*_python(), fmu.folder, fmu.path, *built), "/tmp")


def build_sandbox(fmu: LoadedFmu, work: Path, sources: Path) -> list[str]:
    """Return the command for a compiler of a source FMU, started in its ``sources``.

    It sees, read-only, what the FMU's worker sees; it writes in ``work``. Raises InputError as
    `sandbox_command`.
    """
    links = [_ALTERNATIVES] if _ALTERNATIVES.is_dir() else []
    return _sandbox((*_python(), *links, fmu.folder), str(sources), work)


def _sandbox(read: Iterable[Path], start: str, written: Path | None = None) -> list[str]:
    """Return bubblewrap's command, up to the command that it runs in the folder ``start``."""
    bwrap = shutil.which("bwrap")
    if bwrap is None:
        raise InputError(
            'isolated = "sandboxed" needs bubblewrap, which is not here (Debian: apt install '
            "bubblewrap)"
        )
    _refuse_unable(bwrap)
    command = [bwrap, *_ISOLATION, *_system()]
    for path in read:
        command += ["--ro-bind", str(path), str(path)]
    if written is not None:
        command += ["--bind", str(written), str(written)]
    return [*command, "--chdir", start, "--"]


def sandbox_environment(fmu: LoadedFmu) -> dict[str, str]:
    """Return the environment of a sandboxed worker."""
    kept = {name: os.environ[name] for name in _ENVIRONMENT if name in os.environ}
    package = Path(__file__).resolve().parents[3]
    cache_folder = fmu.folder.parent.parent
    own = {"SEATRIAL_CACHE": str(cache_folder), MEMORY: str(MEMORY_GIB * _GIB)}
    return {**kept, "PYTHONPATH": str(package), **own}


@cache
def _refuse_unable(bwrap: str) -> None:
    done = subprocess.run(
        [bwrap, *_ISOLATION, *_system(), "--", "/bin/sh", "-c", ":"], capture_output=True, text=True
    )
    if done.returncode:
        why = done.stderr.strip() or f"it ended with status {done.returncode}"
        raise InputError(f'isolated = "sandboxed": bubblewrap cannot make a sandbox here: {why}')


def _system() -> Iterator[str]:
    for name in _SYSTEM:
        path = Path(name)
        if path.is_symlink():  # /lib is usr/lib
            yield from ("--symlink", os.readlink(path), name)
        elif path.exists():
            yield from ("--ro-bind", name, name)


def _ours() -> list[Path]:
    top = Path(__file__).resolve().parents[3]
    return [top / name for name in OURS]


def _python() -> list[Path]:
    """Return the folders of the interpreter, of installed packages and of seatrial."""
    user = [site.getusersitepackages()] if site.ENABLE_USER_SITE else []
    installed = [Path(folder) for folder in (*site.getsitepackages(), *user)]
    wanted = [Path(sys.prefix), Path(sys.base_prefix), *installed, *_named(installed), *_ours()]
    return [path for path in dict.fromkeys(wanted) if path.is_dir() and path != Path("/usr")]


def _named(folders: Iterable[Path]) -> Iterator[Path]:
    """Yield the folders that path files in these name: more packages are installed there."""
    for folder in folders:
        for file in sorted(folder.glob("*.pth")):
            for line in file.read_text("utf-8", "replace").splitlines():
                if line.strip() and not line.startswith(("#", "import ", "import\t")):
                    yield folder / line.strip()
