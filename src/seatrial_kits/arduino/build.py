"""Building: a sketch to a program that simulates its board, or to firmware."""

from __future__ import annotations

import os
import shlex
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

from seatrial.errors import InputError

from .mcus import Mcu
from .resources import TEXTS, cached, contents, laid_out
from .sources.dialect import narrowed
from .sources.letter_case import with_other_cases
from .sources.libraries import ASSEMBLY, SOURCES, compiled, files_of, read_source, write_source
from .sources.sketch import Sketch
from .sources.target_board import is_foreign, target_text
from .sources.unsupported import advice, missing_headers, unsupported
from .toolchain import need, version

_LINES = 120
"""Of compilers' errors that a message has."""
_MACHINE = ("machine", "uarts", "basics", "texts")
_BASE = ("-std=gnu++17", "-gdwarf-4", "-w", "-fpermissive", "-fno-pie", "-ffp-contract=off")
_SKETCH = ("-O1", "-fsanitize-coverage=trace-pc")


@dataclass(frozen=True)
class Family:
    """How the sketches of a family of boards are compiled: its API is in ``folder``."""

    folder: str
    more: tuple[str, ...]
    """Folders in it with headers that sketches name without it."""
    core: tuple[str, ...]
    """Its sources."""
    base: tuple[str, ...]
    sketch: tuple[str, ...]
    narrows: bool
    """Whether int has 16 bits there: see `dialect`."""
    backend: str
    """Its tools in `toolchain`."""


FAMILIES = {
    "avr": Family(
        "core",
        (),
        ("api", "avr_libc", "devices"),
        (),
        ("-fsingle-precision-constant", "-include", "sketch.h"),
        narrows=True,
        backend="host",
    ),
    # A computer's 32 bits are this board's: int, long, pointers and size_t; char has no sign.
    "esp32": Family(
        "esp32",
        ("web",),
        (
            *("api", "devices", "espnow", "network", "pulses", "queues", "storage", "tasks"),
            *("tcp", "timers", "twai", "watchdog", "driver/ledc"),
            *("web/asynctcp", "web/digests", "web/dnsserver", "web/httpclient", "web/webserver"),
        ),
        ("-m32", "-msse2", "-mfpmath=sse", "-funsigned-char", "-fasynchronous-unwind-tables"),
        ("-malign-double",),
        narrows=False,
        backend="host for ESP32",
    ),
}


def build_host(sketch: Sketch, mcu: Mcu) -> Path:
    """Return the program that runs ``sketch`` on a simulated board with ``mcu``.

    Raises InputError for what is unsupported and for what the compiler finds, with the
    sketch's files and lines.
    """
    family = FAMILIES[mcu.family]
    need(family.backend)
    whole = sketch.merged()
    key = [mcu, family, version("g++"), TEXTS, whole, _BASE, _SKETCH, sketch.flags]
    key.append(contents(sketch.files()))
    return cached(
        f"host-{sketch.name}", key, "", lambda file, scratch: _host(sketch, mcu, file, scratch)
    )


def _host(sketch: Sketch, mcu: Mcu, file: Path, scratch: Path) -> None:
    family = FAMILIES[mcu.family]
    sketch = with_other_cases(sketch, _includer(sketch, mcu), scratch / "cases")
    sketch = with_used_libraries(sketch, _includer(sketch, mcu), scratch / "whole.cpp")
    missing = missing_headers(sketch, _includer(sketch, mcu), scratch / "whole.cpp", mcu.family)
    refuse("host", sketch, [*missing, *(unsupported(sketch) if family.narrows else [])], mcu.family)
    common = _compiler(mcu)
    objects = [_core_object("machine", name, mcu, common) for name in _MACHINE]
    objects += [_core_object(family.folder, name, mcu, common) for name in family.core]
    sources, places = (_narrowed_copy if family.narrows else _as_it_is)(sketch, scratch)
    includes = [f"-I{each}" for each in places]
    command = [*common, *_SKETCH, *family.sketch, *sketch.flags, *includes]
    theirs = {scratch / f"{number}.o": source for number, source in enumerate(sources)}
    run_all([[*command, "-c", str(f), "-o", str(o)] for o, f in theirs.items()], sketch, mcu.family)
    objects += theirs
    link = ["g++", *family.base, "-no-pie", *map(str, objects), "-lpthread", "-o", str(file)]
    run(link, sketch.name, mcu.family)


def _includer(sketch: Sketch, mcu: Mcu) -> list[str]:
    """Return the command that finds what a source of a sketch includes."""
    places = [f"-I{f}" for f in include_folders(sketch)]
    return [*_compiler(mcu), *sketch.flags, *places]


def _compiler(mcu: Mcu) -> list[str]:
    """Return the compiler with what all sources of a board's program have."""
    family, place = FAMILIES[mcu.family], laid_out()
    more = (f"{family.folder}/{each}" for each in family.more)
    places = [f"-I{place / each}" for each in (family.folder, *more, "machine", "shared")]
    return ["g++", *_BASE, *family.base, *mcu.defines, *places]


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
            if library not in used and any(
                library.resolve() in header.parents for header in headers
            ):
                used.append(library)
                waiting += [f for f in compiled(library) if f.suffix in SOURCES]
    return replace(sketch, libraries=tuple(f for f in sketch.libraries if f in used))


def _core_object(folder: str, name: str, mcu: Mcu, common: list[str]) -> Path:
    source = laid_out() / folder / f"{name}.cpp"
    key = [mcu, version("g++"), TEXTS, common]

    def make(file: Path, scratch: Path) -> None:
        run([*common, "-O2", "-c", str(source), "-o", str(file)], name)

    return cached(f"core-{source.stem}", key, ".o", make)


def _as_it_is(sketch: Sketch, scratch: Path) -> tuple[list[Path], list[Path]]:
    """Write the joined tabs; return what to compile, and folders of headers."""
    main = scratch / f"{sketch.name}.ino.cpp"
    write_source(main, sketch.merged())
    return [main, *sketch.others, *sketch.library_sources()], include_folders(sketch)


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


def run(command: list[str], name: str, family: str = "avr") -> None:
    """Run a compiler. Raises InputError with its output, if it refuses."""
    if output := _refusal(command, family):
        raise InputError(f"{name} does not compile:\n{output}")


def run_all(commands: list[list[str]], sketch: Sketch, family: str) -> None:
    """Compile the sources of a sketch. Raises InputError with what is wrong with any of them."""
    outputs = [output for command in commands if (output := _refusal(command, family))]
    if outputs:
        output = "\n".join("\n".join(outputs).splitlines()[:_LINES])
        more = [target_text(sketch, family)] if is_foreign(sketch, family) else []
        raise InputError("\n".join([f"{sketch.name} does not compile:", output, *more]))


def refuse(backend: str, sketch: Sketch, problems: list[str], family: str) -> None:
    """Raise InputError if there are problems, with the board that a sketch is for."""
    if problems:
        target = target_text(sketch, family)
        head = f"{sketch.name} cannot run in the back end {backend!r}:"
        raise InputError("\n".join([head, *problems, *([f"it is {target}"] if target else [])]))


def _refusal(command: list[str], family: str) -> str:
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
    return "\n".join([output, *advice(output, family)])
