"""Files that a description refers to by URI: always inside the package."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from ...errors import InputError
from .documents import needed, where


@dataclass(frozen=True)
class Source:
    """What a ``source`` names: a file, and what the fragment behind ``#`` says of it."""

    file: Path | None
    """None for a fragment alone, which is in the description itself."""
    fragment: str


@dataclass(frozen=True)
class Sources:
    """Resolves what a description in ``folder`` of the package unpacked at ``root`` names."""

    folder: Path
    root: Path
    label: str
    """The package's, for messages."""

    def source(self, element: Any) -> Source:
        """Return what the attribute ``source`` of ``element`` names. Raises InputError."""
        written = needed(element, "source")
        try:
            uri = urlsplit(written)
        except ValueError as error:
            raise InputError(f"{where(element)}: source {written!r}: {error}") from None
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
        if source.file is None or source.fragment:
            written = element.get("source")
            raise InputError(f"{where(element)}: source {written!r}: a plain path is needed")
        return source.file

    def shown(self, path: Path) -> str:
        """Return a file of the package as messages call it."""
        root = self.root.resolve()
        name = path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name
        return f"{self.label}: {name}"

    def _found(self, element: Any, written: str) -> Path:
        place = f"{where(element)}: source {element.get('source')!r}"
        if "\0" in written:
            raise InputError(f"{place} is no path")
        path = (self.folder / written).resolve()
        if not path.is_relative_to(self.root.resolve()):
            raise InputError(f"{place} is outside the package")
        try:
            found = path.is_file()
        except OSError as error:
            raise InputError(f"{place}: {error.strerror}") from None
        if not found:
            raise InputError(f"{place}: there is no such file")
        return path
