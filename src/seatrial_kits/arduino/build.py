"""Building: a sketch to a program that simulates its board, or to firmware."""

from __future__ import annotations

import os
import shlex
import subprocess
from dataclasses import replace
from pathlib import Path

from seatrial.errors import InputError

from .dialect import narrowed
from .libraries import ASSEMBLY, SOURCES, compiled, files_of, read_source, write_source
from .mcus import Mcu
from .resources import TEXTS, cached, contents, laid_out
from .sketch import Sketch
from .target_board import is_foreign, target_text
from .toolchain import need, version
from .unsupported import advice, missing_headers, unsupported

_LINES = 120
"""Of compilers' errors that a message has."""
_CORE = ("machine", "uarts", "api", "avr_libc", "texts", "devices")
_BASE = ("-std=gnu++17", "-gdwarf-4", "-w", "-fpermissive", "-fno-pie", "-ffp-contract=off")
_SKETCH = ("-O1", "-fsingle-precision-constant", "-fsanitize-coverage=trace-pc")


def build_host(sketch: Sketch, mcu: Mcu) -> Path:
    """Return the program that runs ``sketch`` on a simulated board with ``mcu``.

    Raises InputError for what is unsupported and for what the compiler finds, with the
    sketch's files and lines.
    """
    need("host")
    whole = narrowed(sketch.merged())
    key = [mcu, version("g++"), TEXTS, whole, _BASE, _SKETCH, sketch.flags]
    key.append(contents(sketch.files()))
    return cached(
        f"host-{sketch.name}", key, "", lambda file, scratch: _host(sketch, mcu, file, scratch)
    )


def _host(sketch: Sketch, mcu: Mcu, file: Path, scratch: Path) -> None:
    place = laid_out()
    sketch = with_used_libraries(sketch, _includer(sketch, mcu), scratch / "whole.cpp")
    missing = missing_headers(sketch, _includer(sketch, mcu), scratch / "whole.cpp")
    refuse("host", sketch, [*missing, *unsupported(sketch)])
    common = ["g++", *_BASE, *mcu.defines, f"-I{place / 'core'}", f"-I{place / 'shared'}"]
    objects = [_core_object(name, mcu, common) for name in _CORE]
    sources, places = _narrowed_copy(sketch, scratch)
    includes = [f"-I{each}" for each in places] + ["-include", str(place / "core" / "sketch.h")]
    command = [*common, *_SKETCH, *sketch.flags, *includes]
    theirs = {scratch / f"{number}.o": source for number, source in enumerate(sources)}
    run_all([[*command, "-c", str(f), "-o", str(o)] for o, f in theirs.items()], sketch)
    objects += theirs
    link = ["g++", "-no-pie", *map(str, objects), "-lpthread", "-o", str(file)]
    run(link, sketch.name)


def _includer(sketch: Sketch, mcu: Mcu) -> list[str]:
    """Return the command that finds what a source of a sketch includes."""
    core = laid_out() / "core"
    places = [f"-I{f}" for f in (core, *include_folders(sketch))]
    return ["g++", *_BASE, *mcu.defines, *sketch.flags, *places]


def include_folders(sketch: Sketch) -> list[Path]:
    """Return where a sketch's headers are: its folder, its libraries, and what these lie in."""
    found = [sketch.folder, *sketch.libraries, *(f / "utility" for f in sketch.libraries)]
    return list(dict.fromkeys([*found, *(f.parent for f in sketch.libraries)]))


def with_used_libraries(sketch: Sketch, command: list[str], main: Path) -> Sketch:
    """Return a sketch with the libraries only that remain when conditions are evaluated.

    ``command`` preprocesses a source; the joined tabs are written to ``main``. If it cannot, for
    lack of a header, all remain: the compiler says more.
    """
    write_source(main, sketch.merged())
    waiting, used = [main, *sketch.others], []
    while waiting:
        source = waiting.pop()
        done = subprocess.run(
            [*command, "-MM", str(source)], capture_output=True, text=True, check=False
        )
        if done.returncode:
            return sketch
        headers = {Path(each).resolve() for each in shlex.split(done.stdout.partition(":")[2])}
        for library in sketch.libraries:
            if library not in used and any(library in header.parents for header in headers):
                used.append(library)
                waiting += [f for f in compiled(library) if f.suffix in SOURCES]
    return replace(sketch, libraries=tuple(f for f in sketch.libraries if f in used))


def _core_object(name: str, mcu: Mcu, common: list[str]) -> Path:
    source = laid_out() / "core" / f"{name}.cpp"
    key = [mcu, version("g++"), TEXTS, _BASE]

    def make(file: Path, scratch: Path) -> None:
        run([*common, "-O2", "-c", str(source), "-o", str(file)], name)

    return cached(f"core-{name}", key, ".o", make)


def _narrowed_copy(sketch: Sketch, scratch: Path) -> tuple[list[Path], list[Path]]:
    """Write a sketch's files in the host's dialect; return what to compile, and folders of headers.

    Compilers still name the files that they are from.
    """
    main = scratch / f"{sketch.name}.ino.cpp"
    write_source(main, narrowed(sketch.merged()))
    sources, places = [main], []
    theirs = {*sketch.others, *sketch.library_sources()}
    for number, folder in enumerate((sketch.folder, *sketch.libraries)):
        places.append(scratch / f"include{number}" / folder.name)
        for file in files_of(folder):
            if file.suffix in ASSEMBLY:
                continue
            copy = places[-1] / file.relative_to(folder)
            copy.parent.mkdir(parents=True, exist_ok=True)
            write_source(copy, f'#line 1 "{file}"\n{narrowed(read_source(file))}')
            if file in theirs:
                theirs.remove(file)  # a library in the sketch's folder is met twice
                sources.append(copy)
    return sources, [*places, *(place.parent for place in places[1:])]


def run(command: list[str], name: str) -> None:
    """Run a compiler. Raises InputError with its output, if it refuses."""
    if output := _refusal(command):
        raise InputError(f"{name} does not compile:\n{output}")


def run_all(commands: list[list[str]], sketch: Sketch) -> None:
    """Compile the sources of a sketch. Raises InputError with what is wrong with any of them."""
    outputs = [output for command in commands if (output := _refusal(command))]
    if outputs:
        output = "\n".join("\n".join(outputs).splitlines()[:_LINES])
        more = [target_text(sketch)] if is_foreign(sketch) else []
        raise InputError("\n".join([f"{sketch.name} does not compile:", output, *more]))


def refuse(backend: str, sketch: Sketch, problems: list[str]) -> None:
    """Raise InputError if there are problems, with the board that a sketch is for."""
    if problems:
        target = target_text(sketch)
        head = f"{sketch.name} cannot run in the back end {backend!r}:"
        raise InputError("\n".join([head, *problems, *([f"it is {target}"] if target else [])]))


def _refusal(command: list[str]) -> str:
    """Run a compiler; return its errors with what to do about them, '' if there are none."""
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
        env={**os.environ, "LC_ALL": "C"},
    )
    if not done.returncode:
        return ""
    output = "\n".join(done.stderr.splitlines()[:30]) or f"{command[0]} ended ({done.returncode})"
    return "\n".join([output, *advice(output)])
