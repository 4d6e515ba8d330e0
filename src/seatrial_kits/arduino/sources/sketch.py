"""Arduino sketches: their files, and the one C++ file that the Arduino IDE would make of them."""

from __future__ import annotations

import json
import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from seatrial.errors import InputError

from .libraries import SOURCES, compiled, files_of, find_libraries, read_source
from .platformio import FILE, Project, project_of, read_project
from .tokens import Token, tokens

_INOS = (".ino", ".pde")
_FLAGS = ("-D", "-U", "-f", "-std=", "-W")


@dataclass(frozen=True)
class Sketch:
    """A folder with ``NAME/NAME.ino``, more tabs, its ``src``, and ``libraries`` beside or in it.

    ``tabs`` begin with the main one, then in alphabetical order, as the IDE joins them.
    """

    name: str
    folder: Path
    tabs: tuple[Path, ...]
    others: tuple[Path, ...]
    """Sources that are compiled by themselves: ``.cpp`` and ``.c``, and those of ``src``."""
    libraries: tuple[Path, ...]
    """Folders with the headers of the libraries that it includes."""
    flags: tuple[str, ...] = ()
    """Options of the compiler, for the sketch, its libraries and the core."""
    project: Project | None = None
    """The environment of PlatformIO that it is one of."""

    def merged(self) -> str:
        """Return the C++ file of all tabs, with prototypes; errors name the tabs' lines."""
        text = "".join(f"#line 1 {json.dumps(str(tab))}\n{read_source(tab)}\n" for tab in self.tabs)
        return f"#include <Arduino.h>\n{with_prototypes(text)}"

    def library_sources(self) -> list[Path]:
        """Return the sources of the libraries."""
        return [file for folder in self.libraries for file in compiled(folder)]

    def own_files(self) -> list[Path]:
        """Return the sources and headers in its folder and its ``src``, besides the tabs."""
        return files_of(self.folder)

    def files(self) -> list[Path]:
        """Return every file that goes into it."""
        theirs = [file for folder in self.libraries for file in files_of(folder)]
        return [*self.tabs, *self.own_files(), *theirs]


def find_sketch(
    place: str | Path, libraries: str = "", flags: str = "", environment: str = ""
) -> Sketch:
    """Return the sketch of a folder, of its ``.ino``, or of the ``.cpp`` with its ``setup()``.

    A folder with a ``platformio.ini``, or that file, is a project: see `read_project`.

    Libraries are searched in the folders of ``libraries`` (see `read_library_folders`), then in
    ``libraries`` in the sketch's folder and beside it. Raises InputError if there is no sketch,
    and for files that cannot be read.
    """
    path = Path(place).expanduser()
    if file := project_of(path):
        return _of_project(read_project(file, environment), libraries, flags)
    if environment:
        raise InputError(f"environment: {place} has no platformio.ini: leave it out")
    folder = (path if path.is_dir() else path.parent).resolve()
    main = path.resolve() if path.is_file() else _main(folder)
    if main is None or main.suffix not in (*_INOS, *SOURCES):
        raise InputError(f"{place}: no sketch there (a folder NAME with NAME.ino is needed)")
    joined = main.suffix in _INOS
    named = folder / f"{folder.name}.ino"
    if joined and main != named and named.is_file():
        raise InputError(f"{path} is a tab of the sketch {named}: give that, or its folder")
    more = sorted(f for f in folder.iterdir() if f.suffix in _INOS and f.stem != main.stem)
    if main.stem != folder.name:  # of a folder of sketches: the others are no tabs of this one
        more = [f for f in more if not _has_setup(f)]
    tabs = (main, *more) if joined else ()
    sources = [f for f in sorted(folder.iterdir()) if f.suffix in SOURCES]
    if (folder / "src").is_dir():
        sources += compiled(folder / "src")
    shelves = [*read_library_folders(libraries, folder)]
    shelves += [folder / "libraries", folder.parent / "libraries"]
    headers = [f for f in files_of(folder) if f.parent == folder or folder / "src" in f.parents]
    try:
        found = find_libraries([*tabs, *headers], shelves)
    except OSError as error:
        raise InputError(f"{place}: cannot be read: {error}") from None
    return Sketch(main.stem, folder, tabs, tuple(sources), found, read_flags(flags))


def _of_project(project: Project, libraries: str, flags: str) -> Sketch:
    """Return the sketch of an environment of a project."""
    folder = project.sources
    if not folder.is_dir():
        raise InputError(f"{project.folder / FILE}: there is no folder of sources {folder}")
    files = files_of(folder)
    tabs = tuple(sorted(f for f in folder.iterdir() if f.suffix in _INOS))
    headers = [file for each in project.headers for file in files_of(each)]
    shelves = [*read_library_folders(libraries, folder), *project.shelves]
    found = find_libraries([*tabs, *files, *headers], [*project.headers, *shelves])
    own = tuple(f for f in project.headers if f != folder)
    more = tuple(f for f in found if f not in own)
    sources = tuple(f for f in files if f.suffix in SOURCES)
    return Sketch(
        project.folder.name,
        folder,
        tabs,
        sources,
        (*own, *more),
        (*project.flags, *read_flags(flags)),
        project,
    )


def read_library_folders(text: str, folder: Path) -> tuple[Path, ...]:
    """Return the folders of libraries that ``text`` names, with ``;`` between them.

    They are relative to ``folder``, the sketch's. Raises InputError for one that is not there.
    """
    found = []
    for part in filter(None, (each.strip() for each in text.split(";"))):
        shelf = folder / Path(part).expanduser()
        if not shelf.is_dir():
            raise InputError(f"libraries: {part!r}: there is no folder {shelf}")
        found.append(shelf.resolve())
    return tuple(found)


def read_flags(text: str) -> tuple[str, ...]:
    """Return the options of ``-DNAME=VALUE -UNAME -fOPTION``. Raises InputError for others."""
    try:
        found = tuple(shlex.split(text))
    except ValueError as error:
        raise InputError(f"flags: {text!r}: {error}") from None
    for flag in found:
        if not flag.startswith(_FLAGS) or flag in ("-D", "-U"):
            raise InputError(
                f"flags: {flag!r} is not allowed: options that begin with {', '.join(_FLAGS)} "
                "are, their values in the same word; folders of headers are for 'libraries'"
            )
    return found


def _main(folder: Path) -> Path | None:
    """Return the ``.ino`` of a folder's own name, or the only one there, or with a ``setup()``.

    A clone has the name of its repository, which is often another than the sketch's.
    """
    found = sorted(f for f in folder.iterdir() if f.suffix in _INOS) if folder.is_dir() else []
    named = [f for f in found if f.stem == folder.name]
    if named:
        return named[0]  # NAME.ino before a NAME.pde, the same for older tools
    begin = found if len(found) == 1 else [f for f in found if _has_setup(f)]
    return begin[0] if len(begin) == 1 else None


def _has_setup(file: Path) -> bool:
    words = [token.text for token in tokens(read_source(file)) if token.kind != "space"]
    return any(words[at : at + 3] == ["void", "setup", "("] for at in range(len(words)))


_LINE = re.compile(r"""\s*#\s*line\s+(?P<number>\d+)(?:\s+(?P<name>".*"))?""")


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
    """Return the file and line that line ``at`` stands for, by the directives before it.

    A sketch may have directives of its own: without a file's name the one before holds.
    """
    line = None
    for back in range(at - 1, -1, -1):
        if match := _LINE.match(lines[back]):
            line = int(match["number"]) + at - back - 1 if line is None else line
            if match["name"]:
                return match["name"], line
    return '"sketch"', at + 1 if line is None else line


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
