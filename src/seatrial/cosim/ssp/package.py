"""SSP packages on disk: unpacked into the user's cache."""

from __future__ import annotations

from pathlib import Path

from ...errors import InputError
from ...fmi.archive import unpacked
from ...fmi.load import load_fmu
from .model import FMU, PACKAGE
from .notes import Notes

DEFAULT = "SystemStructure.ssd"
"""The description that every package has."""


def open_package(path: Path, label: str, notes: Notes) -> Path:
    """Return the folder in which the package at ``path`` is unpacked.

    ``label`` names it in messages. Raises InputError for what is no package, or no safe one.
    """
    folder = unpacked(path, "SSP").resolve()
    if not (folder / DEFAULT).is_file():
        raise InputError(f"{label}: not an SSP package: there is no {DEFAULT} in it")
    others = sorted(p.name for p in folder.glob("*.ssd") if p.name != DEFAULT)
    if others:
        notes.add(f"{label}: variants are not read: {', '.join(others)}")
    return folder


def folder_inside(kind: str, source: Path | None, where: str) -> tuple[Path, str]:
    """Return where what a component refers to is unpacked, and its name.

    Raises InputError, with ``where``, if it refers to nothing or to what cannot be read.
    """
    if source is None:
        raise InputError(f"{where}: sourceBase 'component' needs a component with a source")
    if kind == FMU:
        return load_fmu(source).folder.resolve(), source.name
    if kind == PACKAGE:
        return unpacked(source, "SSP").resolve(), source.name
    return source.parent, source.name
