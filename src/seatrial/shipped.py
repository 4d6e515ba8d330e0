"""Folders of content: what the core ships, what kits bring, and the user's own."""

from __future__ import annotations

from pathlib import Path

from .errors import InputError
from .kits import OURS, Kit, kits

_PACKAGE = Path(__file__).parent
_CHECKOUT = _PACKAGE.parents[1]
_IN_KITS = {"hil_profiles": "profiles"}
"""Folders at the top that kits call otherwise."""


def shipped_folder(name: str) -> Path:
    """Return the core's folder ``name``: in the wheel, or at the top of a checkout."""
    installed = _PACKAGE / "_shipped" / name
    if installed.is_dir():
        return installed
    if name == "vehicles":
        return _PACKAGE / name
    return _CHECKOUT / name


def content_of(kit: Kit) -> Path:
    """Return the folder of a kit's content; of those of this distribution, below ``harness``."""
    if kit.folder.parent.name in OURS:
        return shipped_folder("harness") / "kits" / kit.name
    return kit.content


def provided_folders(kind: str) -> list[Path]:
    """Return the folders with files of ``kind``, such as ``harness/rigs``, of the core and kits."""
    top, _, below = kind.partition("/")
    shipped = shipped_folder(top) / below if below else shipped_folder(top)
    inside = below or _IN_KITS.get(top, top)
    folders = [shipped, *(content_of(kit) / inside for kit in kits().found)]
    return [folder for folder in folders if folder.is_dir()]


def searched_folders(kind: str) -> list[Path]:
    """Return the folders where files of ``kind`` are looked for, in order."""
    folders = [Path.cwd() / kind, *provided_folders(kind)]
    return [folder for folder in dict.fromkeys(folders) if folder.is_dir()]


def provided_file(kind: str, name: str) -> Path | None:
    """Return the file of a name that the core or a kit brings; None if there is none.

    Raises InputError for a name that two of them have.
    """
    files = [folder / f"{name}.toml" for folder in provided_folders(kind)]
    found = [file for file in files if file.is_file()]
    if len(found) > 1:
        raise InputError(f"{name!r} is ambiguous: {' and '.join(map(str, found))}; give a path")
    return found[0] if found else None


def available(kind: str) -> dict[str, Path]:
    """Return the files of ``kind`` by name, the ones that `find_file` of `system.files` returns."""
    found: dict[str, Path] = {}
    for folder in searched_folders(kind):
        for path in sorted(folder.glob("*.toml")):
            found.setdefault(path.stem, path)
    return dict(sorted(found.items()))
