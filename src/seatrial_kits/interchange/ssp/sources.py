"""Files that a description refers to by URI: inside its package."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from seatrial.errors import InputError
from seatrial.sim.proxied import proxied_file

from .documents import needed, where
from .model import Source
from .package import Package


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
