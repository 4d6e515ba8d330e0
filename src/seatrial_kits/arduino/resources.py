"""The C and C++ files that boards are built from, and the user's cache of what is built."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import platformdirs

from . import avr, core, esp32, machine, shared
from .core import avr as core_avr
from .core import util as core_util
from .esp32 import driver as esp32_driver
from .esp32 import freertos as esp32_freertos
from .esp32 import libb64 as esp32_libb64
from .esp32 import lwip as esp32_lwip
from .esp32 import rom as esp32_rom
from .esp32 import sha as esp32_sha
from .esp32 import soc as esp32_soc
from .esp32 import web as esp32_web
from .esp32.web import uri as esp32_uri

_FOLDERS = {
    "avr": avr,
    "core": core,
    "core/avr": core_avr,
    "core/util": core_util,
    "esp32": esp32,
    "esp32/driver": esp32_driver,
    "esp32/freertos": esp32_freertos,
    "esp32/sha": esp32_sha,
    "esp32/libb64": esp32_libb64,
    "esp32/lwip": esp32_lwip,
    "esp32/rom": esp32_rom,
    "esp32/soc": esp32_soc,
    "esp32/web": esp32_web,
    "esp32/web/uri": esp32_uri,
    "machine": machine,
    "shared": shared,
}

# Read now: where an FMU was unpacked may be gone when a board is built.
TEXTS = {
    f"{folder}/{name}": (Path(str(module.__file__)).parent / name).read_bytes()
    for folder, module in _FOLDERS.items()
    for name in module.DATA_FILES
}
"""Their content, by place."""


def digest(key: object) -> str:
    """Return a hash of what a value prints as."""
    return hashlib.sha256(repr(key).encode()).hexdigest()[:24]


def contents(files: Sequence[Path]) -> list[tuple[str, str]]:
    """Return names and hashes of files, for a key."""
    return [(str(f), hashlib.sha256(f.read_bytes()).hexdigest()) for f in files]


def laid_out() -> Path:
    """Return a folder with `TEXTS` as files."""

    def make(folder: Path, _: Path) -> None:
        for place, text in TEXTS.items():
            file = folder / place
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(text)

    return cached("board", TEXTS, "", make)


def cached(kind: str, key: object, suffix: str, make: Callable[[Path, Path], None]) -> Path:
    """Return what ``make(place, scratch folder)`` makes, or has made, for this key."""
    named = os.environ.get("SEATRIAL_CACHE")
    base = Path(named) if named else Path(platformdirs.user_cache_dir("seatrial", appauthor=False))
    shelf = base.resolve() / "sketches"
    shelf.mkdir(parents=True, exist_ok=True)
    place = shelf / f"{kind}-{digest(key)}{suffix}"
    if not place.exists():
        with tempfile.TemporaryDirectory(dir=shelf) as scratch:
            made = Path(scratch) / place.name
            make(made, Path(scratch))
            # Whole, or not at all; others may have built the same folder meanwhile.
            with contextlib.suppress(FileExistsError, OSError):
                made.replace(place)
    return place
