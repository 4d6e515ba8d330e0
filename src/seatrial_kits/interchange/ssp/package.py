"""SSP packages on disk: unpacked into the user's cache, or as folders."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from seatrial.errors import InputError
from seatrial.fmi.files.archive import unpacked
from seatrial.fmi.loading.load import load_fmu
from seatrial.system.packages import SSP_FILE

from ..proxied import proxied_file
from .documents import needed, where
from .model import FMU, PACKAGE, Source
from .notes import Notes


@dataclass(frozen=True)
class Package:
    """Where the files of a package are."""

    folder: Path
    label: str
    """The package's, for messages."""
    description: Path
    loose: bool = False
    """A description with the files around it, which may refer to files anywhere."""

    def contains(self, path: Path) -> bool:
        """Say if what is in the package may refer to ``path``, which is resolved."""
        return self.loose or path.is_relative_to(self.folder.resolve())

    def shown(self, path: Path) -> str:
        """Return a file as messages call it."""
        return f"{self.label}: {self.name_of(path)}"

    def name_of(self, path: Path) -> str:
        """Return the path of a file in the package; its own name if it is elsewhere."""
        root = self.folder.resolve()
        return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name


def open_package(path: Path, label: str, notes: Notes) -> Package:
    """Return the package at ``path``: an archive, a folder or a description.

    ``label`` names it in messages. Raises InputError for what is no package, or no safe one.
    """
    loose = path.is_dir() or path.suffix == ".ssd"
    if path.suffix == ".ssd":
        description = path.resolve()
    else:
        description = (path if loose else unpacked(path, "SSP")).resolve() / SSP_FILE
    if not description.is_file():
        raise InputError(f"{label}: not an SSP package: there is no {description.name} in it")
    folder = description.parent
    others = sorted(p.name for p in folder.glob("*.ssd") if p.name != description.name)
    if others:
        notes.add(f"{label}: variants are not read: {', '.join(others)}")
    return Package(folder, label, description, loose)


def package_inside(kind: str, source: Path | None, label: str, where: str) -> Package:
    """Return where the files are that a component refers to with ``source``.

    Raises InputError, with ``where``, if it refers to nothing or to what cannot be read.
    """
    if source is None:
        raise InputError(f"{where}: sourceBase 'component' needs a component with a source")
    if kind == FMU:
        folder = load_fmu(source).folder.resolve()
    elif kind == PACKAGE:
        folder = unpacked(source, "SSP").resolve()
    else:
        folder = source.parent
    return Package(folder, f"{label}: {source.name}", folder / SSP_FILE)


@dataclass(frozen=True)
class Sources:
    """Resolves what a description in ``folder`` of a package names."""

    folder: Path
    package: Package

    def source(self, element: Any) -> Source:
        """Return what the attribute ``source`` of ``element`` names. Raises InputError."""
        written = needed(element, "source")
        try:
            uri = urlsplit(written)
        except ValueError as error:
            raise InputError(f"{where(element)}: source {written!r}: {error}") from None
        proxied = proxied_file(uri)
        if proxied is not None:
            return Source(self._found(element, proxied), "", isolated=True)
        if uri.scheme or uri.netloc or uri.path.startswith("/"):
            raise InputError(
                f"{where(element)}: source {written!r}: only files in the package are read"
            )
        if uri.query or not (uri.path or uri.fragment):
            raise InputError(f"{where(element)}: source {written!r}: a plain path is needed")
        fragment = unquote(uri.fragment)
        if not uri.path:
            return Source(None, fragment)
        return Source(self._found(element, unquote(uri.path)), fragment)

    def file(self, element: Any) -> Path:
        """Return the file that ``source`` names, without fragment. Raises InputError."""
        source = self.source(element)
        if source.file is None or source.fragment or source.isolated:
            written = element.get("source")
            raise InputError(f"{where(element)}: source {written!r}: a plain path is needed")
        return source.file

    def _found(self, element: Any, written: str) -> Path:
        place = f"{where(element)}: source {element.get('source')!r}"
        if "\0" in written:
            raise InputError(f"{place} is no path")
        path = (self.folder / written).resolve()
        if not self.package.contains(path):
            raise InputError(f"{place} is outside the package")
        try:
            found = path.is_file()
        except OSError as error:
            raise InputError(f"{place}: {error.strerror}") from None
        if not found:
            raise InputError(f"{place}: there is no such file")
        return path
