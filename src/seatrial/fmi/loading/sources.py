"""Builds as source FMUs describe them: files, language, definitions, folders, libraries.

FMI 3.0 has ``sources/buildDescription.xml``; FMI 2.0 lists files in its model description, to which
tools add ``sources/defines.def`` (a definition a line) and ``sources/includes.txt`` (a folder a
line). FMI 1.0 has neither: ``all.c``, else all files.
"""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy

from ...errors import InputError
from ..files.xmlfile import read_xml
from ..interfaces.loaded import LoadedFmu

_LONGEST = 200
_C = (".c",)
_CPP = (".cc", ".cpp", ".cxx", ".c++", ".C")
_HEADERS = (".h", ".hh", ".hpp", ".hxx", ".inc")
_LANGUAGE = re.compile(r"(C|C\+\+)[ :]?(\d\d)?", re.IGNORECASE)
_MACRO = re.compile(r"[A-Za-z_]\w*(\([\w, .]*\))?")
_LIBRARY = re.compile(r"(?:lib)?([\w+-][\w.+-]*?)(?:\.(?:so|a|dll|lib|dylib)[.\d]*)?")
_OPTION = re.compile(
    r"-(?:O\w*|std=[\w+]+|g\w*|w|c|ansi|pipe|pthread|pedantic(?:-errors)?|[DU][A-Za-z_]\w*(?:=.*)?"
    r"|W(?![alp],)[\w=+-]*|m[\w.-]+(?:=[\w.,+-]+)?|l[\w.+-]+"
    r"|f(?!plugin|dump|profile|test-coverage|instrument|sanitize)[a-z][\w-]*(?:=[\w+-]+)?)"
)
"""Options of a compiler that name no file and load nothing into it."""
_COMPILERS = re.compile(r"(?:gcc|g\+\+|gnu|clang|cc|c\+\+|zig)\b", re.IGNORECASE)


@dataclass(frozen=True)
class FileSet:
    """Files that are compiled alike."""

    files: tuple[str, ...]
    """Relative to the folder ``sources``."""
    language: str
    """``c`` or ``c++``."""
    options: tuple[str, ...]
    """For the compiler: standard, definitions, folders of headers, others."""


@dataclass(frozen=True)
class Build:
    """What is to be compiled, and linked with which options."""

    sets: tuple[FileSet, ...]
    libraries: tuple[str, ...]

    @property
    def language(self) -> str:
        """``c++`` if a file is in that language, else ``c``."""
        return max((one.language for one in self.sets), default="c")


def read_build(fmu: LoadedFmu) -> Build | None:
    """Return how the interface of ``fmu`` that is used is built; None if it has no sources.

    Raises InputError for what cannot be built: files that are not there or lie elsewhere, languages
    other than C and C++, options that could name files.
    """
    folder = fmu.folder / "sources"
    file = folder / "buildDescription.xml"
    if file.is_file():
        return _Description(fmu, f"{fmu.path}: sources/buildDescription.xml").build(file)
    where = f"{fmu.path}: modelDescription.xml"
    names = [_place(fmu, one, where) for one in _listed(fmu)] or _found(folder)
    names = [name for name in names if not name.endswith(_HEADERS)]
    if not names:
        return None
    options = tuple(_definitions(fmu)) + tuple(_folders(fmu))
    return Build(tuple(_by_suffix(names, options, where)), ("-lm",))


def _listed(fmu: LoadedFmu) -> list[Any]:
    """Return the elements of the files that FMI 2.0 lists for an interface, or for its twin."""
    identifier = fmu.simulation.modelIdentifier
    tags = {"co-simulation": "CoSimulation", "model exchange": "ModelExchange"}
    own = tags.pop(fmu.interface)
    for tag in (own, *tags.values()):
        one = fmu.model.root.find(tag)
        if one is not None and one.get("modelIdentifier") == identifier:
            found = list(one.iterfind("SourceFiles/File"))
            if found:
                return found
    return []


def _found(folder: Path) -> list[str]:
    """Return the files of sources that nothing lists: ``all.c``, which includes others, or all."""
    if (folder / "all.c").is_file():
        return ["all.c"]
    return sorted(path.name for path in folder.glob("*") if path.suffix in (*_C, *_CPP))


def _definitions(fmu: LoadedFmu) -> Iterator[str]:
    for number, line in _lines(fmu, "defines.def"):
        for word in line.split():
            name, equals, value = word.removeprefix("-D").partition("=")
            if not _MACRO.fullmatch(name):
                raise InputError(
                    f"{fmu.path}: sources/defines.def:{number}: {word!r} is no definition; NAME or "
                    "NAME=VALUE is needed"
                )
            yield f"-D{name}{equals}{value}"


def _folders(fmu: LoadedFmu) -> Iterator[str]:
    for number, line in _lines(fmu, "includes.txt"):
        yield f"-I{_inside(fmu, line, f'{fmu.path}: sources/includes.txt:{number}')}"


def _lines(fmu: LoadedFmu, name: str) -> Iterator[tuple[int, str]]:
    """Yield the lines of a text file in the sources that are not empty, with their numbers."""
    path = fmu.folder / "sources" / name
    if not path.is_file():
        return
    text = path.read_text("utf-8", "replace")
    for number, line in enumerate(text.splitlines(), 1):
        if line := line.strip():
            yield number, line


def _by_suffix(names: list[str], options: tuple[str, ...], where: str) -> Iterator[FileSet]:
    """Yield the files of each language, which their suffixes tell."""
    for name in names:
        if not name.endswith((*_C, *_CPP)):
            raise InputError(f"{where}: {name!r} is in no language that is built here: C and C++")
    for language, suffixes in (("c", _C), ("c++", _CPP)):
        if found := tuple(name for name in names if name.endswith(suffixes)):
            yield FileSet(found, language, options)


def _place(fmu: LoadedFmu, element: Any, where: str) -> str:
    """Return a file that an element names, as `_inside`. Raises InputError if it is not there."""
    where = f"{where}: line {element.sourceline}"
    name = _named(element, where)
    sources = fmu.folder / "sources"
    for one in (name, f"../{name}"):  # some tools count from the FMU's folder
        place = _inside(fmu, one, where)
        if os.path.isfile(sources / place):  # which a name of any length may be asked
            return place
    raise InputError(f"{where}: no file sources/{name[:_LONGEST]} is in the FMU")


def _inside(fmu: LoadedFmu, name: str, where: str) -> str:
    """Return a path relative to ``sources``. Raises InputError for one outside the FMU."""
    sources = fmu.folder / "sources"
    place = os.path.normpath(sources / name.replace("\\", "/"))
    if not Path(place).is_relative_to(fmu.folder):
        raise InputError(f"{where}: {name!r} is outside the FMU")
    return os.path.relpath(place, sources)


def _named(element: Any, where: str) -> str:
    name = element.get("name")
    if not name:
        raise InputError(f"{where}: {element.tag} has no name")
    return str(name)


class _Description:
    """A ``buildDescription.xml``, read for one FMU."""

    def __init__(self, fmu: LoadedFmu, called: str) -> None:
        self._fmu, self._called = fmu, called

    def build(self, file: Path) -> Build:
        """Return the configuration for the model identifier and this machine."""
        root = read_xml(file, self._called)
        chosen = self._configuration(root)
        sets = [one for files in chosen.iterfind("SourceFileSet") for one in self._sets(files)]
        if not sets:
            raise self._refused(chosen, "has no SourceFile")
        linked = [option for one in sets for option in one.options if option.startswith("-l")]
        libraries = [self._library(one) for one in chosen.iterfind("Library")]
        return Build(tuple(sets), (*libraries, *linked, "-lm"))

    def _configuration(self, root: Any) -> Any:
        """Return the configuration of the FMU's model identifier, or the only one there is.

        Some Reference FMUs have that of the model that theirs was copied from.
        """
        identifier, platform = self._fmu.simulation.modelIdentifier, fmpy.platform_tuple
        all_of_them = root.findall("BuildConfiguration")
        own = [one for one in all_of_them if one.get("modelIdentifier") == identifier]
        if not own and len(all_of_them) == 1:
            own = all_of_them
        for wanted in ((platform,), (None, "")):
            for one in own:
                if one.get("platform") in wanted:
                    return one
        found = [f"{one.get('modelIdentifier')} ({one.get('platform')})" for one in all_of_them]
        raise InputError(
            f"{self._called}: no BuildConfiguration is for modelIdentifier {identifier!r} on "
            f"{platform} (found: {', '.join(found) or 'none'})"
        )

    def _sets(self, element: Any) -> Iterator[FileSet]:
        options = tuple(self._options(element))
        files = [_place(self._fmu, one, self._called) for one in element.iterfind("SourceFile")]
        names = [name for name in files if not name.endswith(_HEADERS)]
        written = element.get("language")
        if not written:
            yield from _by_suffix(names, options, self._where(element))
            return
        language = _LANGUAGE.fullmatch(written.strip())
        if language is None:
            raise self._refused(
                element,
                f"language {written!r} is not built here: C and C++, such as C99 and C++11, are",
            )
        kind, year = language[1].lower(), language[2]
        # With GNU's extensions, as CMake does: strict C hides what POSIX has.
        standard = (f"-std=gnu{kind[1:]}{year}",) if year else ()
        yield FileSet(tuple(names), kind, (*standard, *options))

    def _options(self, element: Any) -> Iterator[str]:
        for one in element.iterfind("IncludeDirectory"):
            where = self._where(one)
            yield f"-I{_inside(self._fmu, _named(one, where), where)}"
        for one in element.iterfind("PreprocessorDefinition"):
            name, value = _named(one, self._where(one)), one.get("value")
            if not _MACRO.fullmatch(name):
                raise self._refused(one, f"{name!r} is no name of a definition")
            if one.get("optional") not in ("true", "1"):
                yield f"-D{name}" if value is None else f"-D{name}={value}"
        if _COMPILERS.match(element.get("compiler") or "cc"):
            yield from self._compiler_options(element)

    def _compiler_options(self, element: Any) -> Iterator[str]:
        written = element.get("compilerOptions", "")
        try:
            options = shlex.split(written)
        except ValueError as error:
            raise self._refused(element, f"compilerOptions {written!r}: {error}") from None
        for option in options:
            if not _OPTION.fullmatch(option):
                raise self._refused(element, f"compiler option {option!r} is not taken here")
            yield option

    def _library(self, element: Any) -> str:
        """Return the linker's argument for a library of the system, or the FMU's file of one."""
        name = _named(element, self._where(element))
        plain = _LIBRARY.fullmatch(name)
        if element.get("external") in ("true", "1") and plain:
            return f"-l{plain[1]}"
        folder = f"../binaries/{self._fmu.platform}"
        for one in (name, f"{name}.a", f"lib{name}.a", f"{name}.o"):
            place = _inside(self._fmu, f"{folder}/{one}", self._where(element))
            if os.path.isfile(self._fmu.folder / "sources" / place):
                return place
        raise self._refused(element, f"the FMU has no static library {name!r} in {folder[3:]}")

    def _refused(self, element: Any, why: str) -> InputError:
        return InputError(f"{self._where(element)}: {why}")

    def _where(self, element: Any) -> str:
        return f"{self._called}: {element.tag} (line {element.sourceline})"
