"""Arduino sketches: their files, and the one C++ file that the Arduino IDE would make of them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from ...errors import InputError
from .tokens import Token, tokens

SOURCES = (".c", ".cpp", ".cc", ".cxx")
HEADERS = (".h", ".hh", ".hpp", ".inc")


@dataclass(frozen=True)
class Sketch:
    """A folder with ``NAME/NAME.ino``, more tabs, and ``libraries`` beside or in it.

    ``tabs`` begin with the main one, then in alphabetical order, as the IDE joins them.
    """

    name: str
    folder: Path
    tabs: tuple[Path, ...]
    others: tuple[Path, ...]
    """Sources that are compiled by themselves: ``.cpp`` and ``.c`` of the sketch."""
    libraries: tuple[Path, ...]
    """Folders with the headers of the libraries that it includes."""

    def merged(self) -> str:
        """Return the C++ file of all tabs, with prototypes; errors name the tabs' lines."""
        text = "".join(f"#line 1 {json.dumps(str(tab))}\n{read_source(tab)}\n" for tab in self.tabs)
        return f"#include <Arduino.h>\n{with_prototypes(text)}"

    def library_sources(self) -> list[Path]:
        """Return the sources of the libraries."""
        return [file for folder in self.libraries for file in _sources(folder)]

    def files(self) -> list[Path]:
        """Return every file that goes into it."""
        own = [f for f in sorted(self.folder.rglob("*")) if f.suffix in (*SOURCES, *HEADERS)]
        theirs = [
            f
            for folder in self.libraries
            for f in sorted(folder.rglob("*"))
            if f.suffix in (*SOURCES, *HEADERS)
        ]
        return [*self.tabs, *own, *theirs]


def find_sketch(place: str | Path) -> Sketch:
    """Return the sketch of a folder or of its ``.ino``.

    Libraries are folders of ``libraries`` in the sketch's folder or beside it that a file of the
    sketch includes. Raises InputError if there is no sketch.
    """
    path = Path(place).expanduser()
    folder = path.parent if path.suffix in (".ino", ".pde") else path
    folder = folder.resolve()
    main = folder / f"{folder.name}.ino"
    if path.suffix == ".ino" and path.is_file() and path.resolve() != main:
        raise InputError(
            f"{path}: an Arduino sketch lies in a folder of its own name: {path.stem}/{path.name}"
        )
    if not main.is_file():
        raise InputError(f"{place}: no sketch there (a folder NAME with NAME.ino is needed)")
    tabs = (main, *sorted(f for f in folder.glob("*.ino") if f != main))
    others = tuple(f for f in sorted(folder.iterdir()) if f.suffix in SOURCES)
    return Sketch(folder.name, folder, tabs, others, _libraries(folder, [*tabs, *others]))


def read_source(file: Path) -> str:
    """Return a source file's text. Raises InputError if it is not UTF-8."""
    try:
        return file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: cannot be read: {error}") from None


def included(source: str) -> list[tuple[str, int]]:
    """Return the headers that a source includes, with their lines."""
    found = []
    for token in tokens(source):
        if token.kind == "include":
            name = token.text.partition("include")[2].split("//")[0].strip()
            found.append((name.strip('<>" \t'), token.line))
    return found


def _libraries(folder: Path, files: list[Path]) -> tuple[Path, ...]:
    found: list[Path] = []
    waiting = list(files)
    while waiting:
        for header, _ in included(read_source(waiting.pop())):
            library = _library(folder, header)
            if library is not None and library not in found:
                found.append(library)
                waiting += [f for f in library.rglob("*") if f.suffix in (*SOURCES, *HEADERS)]
    return tuple(found)


def _library(folder: Path, header: str) -> Path | None:
    for shelf in (folder / "libraries", folder.parent / "libraries"):
        for library in sorted(shelf.iterdir()) if shelf.is_dir() else ():
            for place in (library / "src", library):
                if (place / header).is_file():
                    return place
    return None


def _sources(folder: Path) -> list[Path]:
    every = folder.rglob("*") if folder.name == "src" else folder.glob("*")
    return sorted(f for f in every if f.suffix in SOURCES)


# ---------------------------------------------------------------------- prototypes


def with_prototypes(source: str) -> str:
    """Return ``source`` with prototypes of its functions before the first of them.

    As the Arduino IDE does it: functions with default arguments, templates, and members get
    none, nor do functions that the sketch declares itself.
    """
    found = [t for t in tokens(source) if t.kind not in ("space", "include")]
    found = _without_directives(found, source)
    prototypes: list[str] = []
    first: Token | None = None
    for begin, end in _definitions(found):
        words = found[begin:end]
        first = first or words[0]
        if not any(t.text in ("=", "template", "operator", "~") for t in words):
            prototypes.append(" ".join(t.text for t in words) + ";")
    if first is None:
        return source
    lines = source.split("\n")
    at = first.line - 1
    name, line = _place(lines, at)
    marked = [*prototypes, f"#line {line} {name}"]
    return "\n".join([*lines[:at], *marked, *lines[at:]])


def _place(lines: list[str], at: int) -> tuple[str, int]:
    """Return the file and line that line ``at`` stands for, by the directive before it."""
    for back in range(at - 1, -1, -1):
        if lines[back].startswith("#line "):
            _, number, name = lines[back].split(" ", 2)
            return name, int(number) + at - back - 1
    return '"sketch"', at + 1


def _without_directives(found: list[Token], source: str) -> list[Token]:
    lines = source.split("\n")
    directives = set()
    for number, line in enumerate(lines, 1):
        continued = number - 1 in directives and lines[number - 2].endswith("\\")
        if line.lstrip().startswith("#") or continued:
            directives.add(number)
    return [t for t in found if t.line not in directives]


def _definitions(found: list[Token]) -> list[tuple[int, int]]:
    """Return where functions at the outermost level begin, and where their bodies do."""
    result, depth, begin = [], 0, 0
    for at, token in enumerate(found):
        if token.text == "{":
            if depth == 0 and _is_function(found[begin:at]):
                result.append((begin, at))
            depth += 1
        elif token.text == "}":
            depth -= 1
            if depth == 0:
                begin = at + 1
        elif token.text == ";" and depth == 0:
            begin = at + 1
    return result


def _is_function(words: list[Token]) -> bool:
    """Return whether tokens before a brace are 'TYPE NAME ( ... )'."""
    texts = [t.text for t in words]
    if "(" not in texts or texts[-1] != ")" or texts[0] in ("namespace", "extern"):
        return False
    name = texts.index("(") - 1
    before = texts[:name]
    types = [t for t in words[:name] if t.kind == "word"]
    return (
        words[name].kind == "word"
        and bool(types)
        and "::" not in before[-1:]
        and "=" not in before
        and texts[0] not in ("class", "enum", "union", "ISR", "else", "if", "while", "for")
    )
