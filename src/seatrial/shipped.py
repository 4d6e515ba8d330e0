"""Folders of content: what the core ships, what kits bring, and the user's own."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

from .errors import InputError
from .files.vehicle_folders import FOLDERS, Place, place_in, places_in
from .kits import OURS, Kit, kits

_PACKAGE = Path(__file__).parent
_CHECKOUT = _PACKAGE.parents[1]
_IN_KITS = {"hil_profiles": "profiles"}
"""Folders at the top that kits call otherwise."""


@cache
def shipped_folder(name: str) -> Path:
    """Return the core's folder ``name``: in the wheel, or at the top of a checkout."""
    installed = _PACKAGE / "_shipped" / name
    if installed.is_dir():
        return installed
    return _CHECKOUT / name


def content_of(kit: Kit) -> Path:
    """Return the folder of a kit's content; of those of this distribution, below ``harness``."""
    if kit.folder.parent.name in OURS:
        return shipped_folder("harness") / "kits" / kit.name
    return kit.content


def provided_folders(kind: str) -> list[Path]:
    """Return the folders with files of ``kind``, such as ``harness/rigs``, of the core and kits."""
    return [folder for folder in _places_of(kind, tuple(sys.path)) if folder.is_dir()]


@cache
def _places_of(kind: str, _path: tuple[str, ...]) -> list[Path]:
    """Return where files of ``kind`` would be, with the kits on ``sys.path``."""
    top, _, below = kind.partition("/")
    shipped = shipped_folder(top) / below if below else shipped_folder(top)
    inside = below or _IN_KITS.get(top, top)
    return [shipped, *(content_of(kit) / inside for kit in kits().found)]


def is_provided(path: Path) -> bool:
    """Return whether a file is of the harness of the core or of a kit, and not a user's."""
    folders = [shipped_folder("harness"), *(content_of(kit) for kit in kits().found)]
    return any(path.resolve().is_relative_to(folder.resolve()) for folder in folders)


def provided_place(kind: str, name: str) -> Place | None:
    """Return where a name stands that the core or a kit brings; None if there is none.

    Raises InputError for a name that two of them have.
    """
    files = [Place(folder / f"{name}.toml") for folder in provided_folders(kind)]
    found = [place for place in files if place.path.is_file()]
    inside = (place_in(folder, kind, name) for folder in provided_folders(FOLDERS))
    found += [place for place in inside if place is not None]
    if len(found) > 1:
        raise InputError(f"{name!r} is ambiguous: {' and '.join(map(str, found))}; give a path")
    return found[0] if found else None


def available(kind: str) -> dict[str, Path]:
    """Return the files of ``kind`` by name, the ones that `find_file` of `system.files` returns."""
    return {name: place.path for name, place in available_places(kind).items()}


def available_places(kind: str) -> dict[str, Place]:
    """Return where the names of ``kind`` stand, in files of their own or in vehicles' folders."""
    found: dict[str, Place] = {}
    here = Path.cwd()
    for files, folders in (
        ([here / kind], [here / FOLDERS]),
        (provided_folders(kind), provided_folders(FOLDERS)),
    ):
        for path in (path for folder in files for path in sorted(folder.glob("*.toml"))):
            found.setdefault(path.stem, Place(path))
        for folder in folders:
            for name, place in places_in(folder, kind).items():
                found.setdefault(name, place)
    return dict(sorted(found.items()))
