"""Libraries of a sketch: found by the headers that its files include, as the Arduino IDE does."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from .tokens import tokens

SOURCES = (".c", ".cpp", ".cc", ".cxx")
ASSEMBLY = (".S",)
HEADERS = (".h", ".hh", ".hpp", ".inc")
_ALL = (*SOURCES, *ASSEMBLY, *HEADERS)
_ASIDE = {"examples", "example", "extras", "test", "tests", "docs", "libraries"}


def read_source(file: Path) -> str:
    """Return a source's text; bytes that are not UTF-8 come back by `write_source` as they were."""
    return file.read_text(encoding="utf-8-sig", errors="surrogateescape")


def write_source(file: Path, text: str) -> None:
    """Write a text of `read_source`."""
    file.write_text(text, encoding="utf-8", errors="surrogateescape")


def included(source: str) -> list[tuple[str, int]]:
    """Return the headers that a source includes, with their lines."""
    found = []
    for token in tokens(source):
        if token.kind == "include":
            name = token.text.partition("include")[2].split("//")[0].split("/*")[0].strip()
            found.append((name.strip('<>" \t'), token.line))
    return found


def find_libraries(files: Sequence[Path], shelves: Sequence[Path]) -> tuple[Path, ...]:
    """Return the folders with the headers of what ``files`` include, and of what these include.

    ``shelves`` are folders of libraries, the first found first. A library is its folder's
    ``src``, if that has the header, or the folder. One of the header's name goes before others.
    """
    found: list[Path] = []
    waiting, seen = list(files), set()
    while waiting:
        file = waiting.pop()
        for header, _ in included(read_source(file)):
            if header in seen or (file.parent / header).is_file():
                continue
            seen.add(header)
            if any((f / header).is_file() or header_by_folder(f, header) for f in found):
                continue
            library = _library(header, shelves)
            if library is not None:
                found.append(library)
                sources = set(compiled(library))
                waiting += [f for f in files_of(library) if f in sources or _header(f)]
    return tuple(found)


def compiled(folder: Path) -> list[Path]:
    """Return the sources of a library that are compiled: all of ``src``, or the folder's own."""
    if folder.name == "src":
        return [f for f in files_of(folder) if not _header(f)]
    own = [*folder.glob("*"), *(folder / "utility").glob("*")]
    return sorted(f for f in own if f.suffix in (*SOURCES, *ASSEMBLY))


def files_of(folder: Path) -> list[Path]:
    """Return sources and headers in and under a folder, without its examples and tests."""
    return sorted(_walked(folder))


def _walked(folder: Path) -> Iterable[Path]:
    for each in folder.iterdir():
        if each.is_dir() and each.name.lower() not in _ASIDE and not each.name.startswith("."):
            yield from _walked(each)
        elif each.suffix in _ALL and each.is_file():
            yield each


def header_by_folder(library: Path, header: str) -> bool:
    """Return whether a header is included as FOLDER/NAME, by its library's folder."""
    folder, _, name = header.partition("/")
    return folder == library.name and bool(name) and (library / name).is_file()


def _header(file: Path) -> bool:
    return file.suffix in HEADERS


def _library(header: str, shelves: Sequence[Path]) -> Path | None:
    name = Path(header).stem.lower()
    for shelf in shelves:
        folders = sorted(f for f in shelf.iterdir() if f.is_dir()) if shelf.is_dir() else []
        for library in sorted(folders, key=lambda f: f.name.lower() != name):
            for place in (library / "src", library):
                if (place / header).is_file() or header_by_folder(place, header):
                    return place
    return None
